//! Parquet: the columns of numbers and times of a table.

use std::cell::OnceCell;

use bytes::Bytes;
use parquet::basic::{ConvertedType, LogicalType, TimeUnit, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{DataType, Int96};
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

use super::float16::float16;
use super::{Contents, Variable};

/// Values that are read at a time.
const BATCH: usize = 1 << 16;

/// All columns of numbers.
pub(super) fn read(bytes: &[u8]) -> Result<Contents, String> {
    let said = |error: ParquetError| in_words(&error);
    let file = SerializedFileReader::new(Bytes::copy_from_slice(bytes)).map_err(said)?;
    let schema = file.metadata().file_metadata().schema_descr_ptr();
    let mut found = Contents::default();
    for (index, column) in schema.columns().iter().enumerate() {
        let name = column.path().parts().join(".");
        let half = is_half(column);
        let numbers = half
            || matches!(
                column.physical_type(),
                Type::BOOLEAN
                    | Type::INT32
                    | Type::INT64
                    | Type::INT96
                    | Type::FLOAT
                    | Type::DOUBLE
            );
        if !numbers || column.max_rep_level() > 0 {
            found.leave_out(&name, "it is no column of numbers");
            continue;
        }
        let Some(Numbers { scale, time, unsigned }) = Numbers::of(column) else {
            found.leave_out(&name, "its numbers are of a kind that is not read");
            continue;
        };
        // Times since 1970 need more digits than a number has: they count from the first one.
        let start = OnceCell::new();
        let mut values = Vec::new();
        for group in 0..file.num_row_groups() {
            let group = file.get_row_group(group).map_err(said)?;
            let reader = group.get_column_reader(index).map_err(said)?;
            let most = column.max_def_level();
            let first = &mut values;
            match reader {
                ColumnReader::BoolColumnReader(reader) => {
                    cells(reader, most, first, &mut found, |v| f64::from(u8::from(*v)))?;
                }
                ColumnReader::Int32ColumnReader(reader) if unsigned => {
                    cells(reader, most, first, &mut found, |v| f64::from(v.cast_unsigned()))?;
                }
                ColumnReader::Int32ColumnReader(reader) => {
                    cells(reader, most, first, &mut found, |v| f64::from(*v))?;
                }
                ColumnReader::Int64ColumnReader(reader) if unsigned => {
                    cells(reader, most, first, &mut found, |v| v.cast_unsigned() as f64)?;
                }
                ColumnReader::Int64ColumnReader(reader) => {
                    let since = |v: &i64| {
                        let start = if time { *start.get_or_init(|| *v) } else { 0 };
                        v.wrapping_sub(start) as f64
                    };
                    cells(reader, most, first, &mut found, since)?;
                }
                ColumnReader::Int96ColumnReader(reader) => {
                    let since = |v: &Int96| {
                        v.to_nanos().wrapping_sub(*start.get_or_init(|| v.to_nanos())) as f64
                    };
                    cells(reader, most, first, &mut found, since)?;
                }
                ColumnReader::FloatColumnReader(reader) => {
                    cells(reader, most, first, &mut found, |v| f64::from(*v))?;
                }
                ColumnReader::DoubleColumnReader(reader) => {
                    cells(reader, most, first, &mut found, |v| *v)?;
                }
                ColumnReader::FixedLenByteArrayColumnReader(reader) if half => {
                    cells(reader, most, first, &mut found, |v| match v.data() {
                        [low, high] => float16(u16::from_le_bytes([*low, *high])),
                        _ => f64::NAN,
                    })?;
                }
                _ => return Err(format!("`{name}` is not of the type that it says")),
            }
        }
        values.iter_mut().for_each(|value| *value *= scale);
        let unit = time.then(|| "s".to_owned());
        found.variables.push(Variable { name, unit, rows: values.len(), columns: 1, values });
    }
    Ok(found)
}

/// Whether a column has numbers of two bytes.
fn is_half(column: &ColumnDescriptor) -> bool {
    column.physical_type() == Type::FIXED_LEN_BYTE_ARRAY
        && matches!(column.logical_type_ref(), Some(LogicalType::Float16))
}

/// The library names a compression that was left out by the feature that it was built without.
fn in_words(error: &ParquetError) -> String {
    let said = error.to_string();
    match said.split_once("Disabled feature at compile time: ") {
        Some((_, codec)) => format!("its columns are compressed by {codec}, which is not read"),
        None => said,
    }
}

/// Adds the values of one group of rows; those that are not there are NaN.
fn cells<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    most: i16,
    values: &mut Vec<f64>,
    found: &mut Contents,
    number: impl Fn(&T::T) -> f64,
) -> Result<(), String> {
    let (mut levels, mut batch) = (Vec::new(), Vec::new());
    loop {
        levels.clear();
        batch.clear();
        let given = (most > 0).then_some(&mut levels);
        let (records, _, _) = reader
            .read_records(BATCH, given, None, &mut batch)
            .map_err(|error| in_words(&error))?;
        if records == 0 {
            return Ok(());
        }
        found.expect(records, 1)?;
        if most == 0 {
            values.extend(batch.iter().map(&number));
            continue;
        }
        let mut there = batch.iter().map(&number);
        values.extend(
            levels.iter().map(|level| {
                if *level == most { there.next().unwrap_or(f64::NAN) } else { f64::NAN }
            }),
        );
    }
}

/// What the numbers of a column are.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Numbers {
    /// Factor: to seconds for times.
    scale: f64,
    /// They are times.
    time: bool,
    /// They are counted from zero, though the file keeps them as if they had a sign.
    unsigned: bool,
}

impl Numbers {
    /// What a column says of its numbers; none where they are of another kind. Old files say it by
    /// a converted type alone.
    fn of(column: &ColumnDescriptor) -> Option<Self> {
        let number = Self { scale: 1.0, time: false, unsigned: false };
        let time = |scale: f64| Some(Self { scale, time: true, ..number });
        if column.physical_type() == Type::INT96 {
            return time(1e-9);
        }
        match (column.logical_type_ref(), column.converted_type()) {
            (Some(LogicalType::Float16), _) => Some(number),
            (Some(LogicalType::Timestamp(time_of)), _) => time(seconds(&time_of.unit)),
            (Some(LogicalType::Time(time_of)), _) => time(seconds(&time_of.unit)),
            (Some(LogicalType::Integer(int)), _) => {
                Some(Self { unsigned: !int.is_signed, ..number })
            }
            (Some(_), _) => None,
            (None, ConvertedType::TIMESTAMP_MILLIS | ConvertedType::TIME_MILLIS) => time(1e-3),
            (None, ConvertedType::TIMESTAMP_MICROS | ConvertedType::TIME_MICROS) => time(1e-6),
            (
                None,
                ConvertedType::UINT_8
                | ConvertedType::UINT_16
                | ConvertedType::UINT_32
                | ConvertedType::UINT_64,
            ) => Some(Self { unsigned: true, ..number }),
            (
                None,
                ConvertedType::NONE
                | ConvertedType::INT_8
                | ConvertedType::INT_16
                | ConvertedType::INT_32
                | ConvertedType::INT_64,
            ) => Some(number),
            (None, _) => None,
        }
    }
}

const fn seconds(unit: &TimeUnit) -> f64 {
    match unit {
        TimeUnit::MILLIS => 1e-3,
        TimeUnit::MICROS => 1e-6,
        TimeUnit::NANOS => 1e-9,
    }
}
