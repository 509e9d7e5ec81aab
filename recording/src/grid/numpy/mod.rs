//! `.npy`: one array, as NumPy writes it.
//!
//! Source: NumPy Enhancement Proposal 1, "A Simple File Format for NumPy Arrays", versions 1 to 3.
//! The crates that read it bring a grammar of Python along; its header needs three entries.

mod header;

use super::float16::float16;
use super::{Contents, Variable};
use header::{Field, Header, Kind};

/// An array that is a file of its own.
pub(super) fn array(bytes: &[u8], name: String) -> Result<Contents, String> {
    let mut found = Contents::default();
    add(bytes, name, &mut found)?;
    Ok(found)
}

/// Adds an array, or each named field of one. What holds no numbers is left out.
pub(super) fn add(bytes: &[u8], name: String, found: &mut Contents) -> Result<(), String> {
    let (header, data) = Header::of(bytes)?;
    let Header { fields, fortran, shape } = header;
    let fields = match fields {
        Ok(fields) => fields,
        Err(why) => {
            found.leave_out(&name, &why);
            return Ok(());
        }
    };
    let named = fields.len() > 1 || fields.iter().any(|field| !field.name.is_empty());
    if shape.len() > 2 || named && shape.len() > 1 {
        found.leave_out(&name, &format!("it has {} dimensions", shape.len()));
        return Ok(());
    }
    let rows = shape.first().copied().unwrap_or(1);
    let across = shape.get(1).copied().unwrap_or(1);
    let row_bytes = fields
        .iter()
        .try_fold(0usize, |sum, field| {
            sum.checked_add(field.kind.size.checked_mul(field.count)?.checked_mul(across)?)
        })
        .ok_or("its header is damaged")?;
    let needed = rows.checked_mul(row_bytes).ok_or("its header is damaged")?;
    if data.len() < needed {
        return Err(format!(
            "it is cut off: its header speaks of {needed} bytes, but {} are there",
            data.len()
        ));
    }
    let mut offset = 0;
    for Field { name: field, kind, count } in fields {
        let columns = if named { count } else { across };
        if !kind.is_number() {
            offset += kind.size * count;
            if !(named && field.is_empty()) {
                found.leave_out(if named { &field } else { &name }, "it holds no numbers");
            }
            continue;
        }
        let numbers = found.expect(rows, columns)?;
        if row_bytes == 0 || numbers == 0 {
            continue;
        }
        let at = |row: usize, column: usize| {
            let index = match (named, fortran) {
                (true, _) => row * row_bytes + offset + column * kind.size,
                (false, true) => (column * rows + row) * kind.size,
                (false, false) => (row * columns + column) * kind.size,
            };
            data.get(index..index + kind.size)
        };
        // Times count from the first one that is one.
        let mut times = (0..rows).filter_map(|row| at(row, 0)).map(|cell| kind.integer(cell));
        let first = if kind.time.is_some() { times.find(|time| *time != i64::MIN) } else { None };
        let first = first.unwrap_or(0);
        let mut values = Vec::with_capacity(numbers);
        for column in 0..columns {
            values.extend(
                (0..rows).map(|row| at(row, column).map_or(f64::NAN, |c| kind.value(c, first))),
            );
        }
        offset += kind.size * count;
        let name = if named { field } else { name.clone() };
        let unit = kind.time.map(|_| "s".to_owned());
        found.variables.push(Variable { name, unit, rows, columns, values });
    }
    Ok(())
}

impl Kind {
    /// Integer of a cell, for times.
    fn integer(self, cell: &[u8]) -> i64 {
        let mut eight = [0; 8];
        if self.time.is_none() || cell.len() != 8 {
            return 0;
        }
        eight.copy_from_slice(cell);
        if self.big { i64::from_be_bytes(eight) } else { i64::from_le_bytes(eight) }
    }

    fn value(self, cell: &[u8], first: i64) -> f64 {
        let mut bytes = [0u8; 8];
        let size = cell.len().min(8);
        // Little end first.
        for (k, byte) in bytes.iter_mut().take(size).enumerate() {
            *byte = cell[if self.big { size - 1 - k } else { k }];
        }
        let whole = u64::from_le_bytes(bytes);
        if let Some(seconds) = self.time {
            let now = whole as i64;
            // Not a time.
            return if now == i64::MIN {
                f64::NAN
            } else {
                now.wrapping_sub(first) as f64 * seconds
            };
        }
        match (self.letter, size) {
            (b'f', 8) => f64::from_bits(whole),
            (b'f', 2) => float16(whole as u16),
            (b'f', 4) => f64::from(f32::from_bits(whole as u32)),
            (b'i', 1..=8) => {
                let shift = 64 - 8 * size as u32;
                (((whole << shift) as i64) >> shift) as f64
            }
            _ => whole as f64,
        }
    }
}
