//! MATLAB 7.3, which is HDF5, and other HDF5 files of arrays. Groups are flattened by dots.

use hdf5_pure::{
    AttrValue, DType, Dataset, Datatype, DatatypeByteOrder, File, FloatingPointLayout, Group,
};

use super::float16::float16;
use super::{Contents, Variable};
use crate::units;

/// Groups within groups.
const DEEPEST: usize = 16;
/// Arrays of a file.
const MOST_ARRAYS: usize = 10_000;

/// All arrays of a file.
pub(super) fn read(bytes: &[u8]) -> Result<Contents, String> {
    let file = File::from_bytes(bytes.to_vec()).map_err(|error| error.to_string())?;
    let mut found = Contents::default();
    let mut arrays = 0;
    group(&file.root(), "", 0, &mut arrays, &mut found)?;
    Ok(found)
}

fn group(
    group_here: &Group,
    prefix: &str,
    depth: usize,
    arrays: &mut usize,
    found: &mut Contents,
) -> Result<(), String> {
    if depth >= DEEPEST {
        return Err(format!("its groups lie more than {DEEPEST} deep in each other"));
    }
    for name in group_here.datasets().map_err(|error| error.to_string())? {
        *arrays += 1;
        if *arrays > MOST_ARRAYS {
            return Err(format!("it holds more than {MOST_ARRAYS} arrays"));
        }
        let dataset = group_here.dataset(&name).map_err(|error| error.to_string())?;
        array(&dataset, format!("{prefix}{name}"), found)?;
    }
    for name in group_here.groups().map_err(|error| error.to_string())? {
        // What MATLAB keeps for itself.
        if name.starts_with('#') {
            continue;
        }
        *arrays += 1;
        if *arrays > MOST_ARRAYS {
            return Err(format!("it holds more than {MOST_ARRAYS} arrays"));
        }
        let inner = group_here.group(&name).map_err(|error| error.to_string())?;
        group(&inner, &format!("{prefix}{name}."), depth + 1, arrays, found)?;
    }
    Ok(())
}

fn array(dataset: &Dataset, name: String, found: &mut Contents) -> Result<(), String> {
    let said = |error: hdf5_pure::Error| format!("`{name}`: {error}");
    let number = matches!(
        dataset.dtype().map_err(said)?,
        DType::F32
            | DType::F64
            | DType::I8
            | DType::I16
            | DType::I32
            | DType::I64
            | DType::U8
            | DType::U16
            | DType::U32
            | DType::U64
    );
    let half = half(dataset);
    if !number && half.is_none() {
        found.leave_out(&name, "it holds no numbers");
        return Ok(());
    }
    let shape = dataset.shape().map_err(said)?;
    if shape.len() > 2 {
        found.leave_out(&name, &format!("it has {} dimensions", shape.len()));
        return Ok(());
    }
    let length = |k: usize| shape.get(k).map_or(Some(1), |&n| usize::try_from(n).ok());
    // The last index runs fastest, so the rows of a matrix are columns here.
    let (columns, rows) = match shape.len() {
        2 => (length(0), length(1)),
        _ => (Some(1), length(0)),
    };
    let (Some(rows), Some(columns)) = (rows, columns) else {
        return Err(format!("`{name}` is too large"));
    };
    let count = found.expect(rows, columns)?;
    if count == 0 {
        return Ok(());
    }
    let values = match half {
        Some(order) => halves(&dataset.read_raw().map_err(said)?, order),
        None => dataset.read_f64().map_err(said)?,
    };
    if values.len() != count {
        return Err(format!("`{name}` has {} numbers, not {count}", values.len()));
    }
    let unit = unit(dataset).filter(|_| units::parts(&name).unit.is_none());
    found.variables.push(Variable { name, unit, rows, columns, values });
    Ok(())
}

/// The order of the bytes of an array of numbers of two bytes; none for another.
fn half(dataset: &Dataset) -> Option<DatatypeByteOrder> {
    match dataset.datatype().ok()? {
        Datatype::FloatingPoint {
            size: 2,
            byte_order,
            layout: FloatingPointLayout { exponent_size: 5, mantissa_size: 10, .. },
        } => Some(byte_order),
        _ => None,
    }
}

fn halves(bytes: &[u8], order: DatatypeByteOrder) -> Vec<f64> {
    let (pairs, _) = bytes.as_chunks::<2>();
    let bits = |pair: &[u8; 2]| match order {
        DatatypeByteOrder::BigEndian => u16::from_be_bytes(*pair),
        _ => u16::from_le_bytes(*pair),
    };
    pairs.iter().map(|pair| float16(bits(pair))).collect()
}

/// The unit that an attribute says, as NetCDF has it. One in the name comes first.
fn unit(dataset: &Dataset) -> Option<String> {
    let attributes = dataset.attrs().ok()?;
    let said = attributes
        .into_iter()
        .find(|(name, _)| ["units", "unit"].iter().any(|usual| name.eq_ignore_ascii_case(usual)));
    let text = match said?.1 {
        AttrValue::String(text) | AttrValue::AsciiString(text) => text,
        AttrValue::StringSized { value, .. } | AttrValue::AsciiStringSized { value, .. } => value,
        AttrValue::VarLenString(text) | AttrValue::VarLenAsciiString(text) => text,
        _ => return None,
    };
    // A time may say since when.
    let unit = text.split(" since ").next().unwrap_or_default().trim();
    let none = ["", "-", "1", "none"].iter().any(|none| unit.eq_ignore_ascii_case(none));
    (!none).then(|| unit.to_owned())
}
