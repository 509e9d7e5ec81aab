//! Parquet: the columns of numbers and times of a table.

use std::cell::OnceCell;

use bytes::Bytes;
use parquet::basic::{LogicalType, TimeUnit, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

use super::{Contents, Variable};

/// Values that are read at a time.
const BATCH: usize = 1 << 16;

/// All columns of numbers.
pub(super) fn read(bytes: &[u8]) -> Result<Contents, String> {
    let said = |error: parquet::errors::ParquetError| error.to_string();
    let file = SerializedFileReader::new(Bytes::copy_from_slice(bytes)).map_err(said)?;
    let schema = file.metadata().file_metadata().schema_descr_ptr();
    let mut found = Contents::default();
    for (index, column) in schema.columns().iter().enumerate() {
        let name = column.path().parts().join(".");
        let numbers = matches!(
            column.physical_type(),
            Type::BOOLEAN | Type::INT32 | Type::INT64 | Type::FLOAT | Type::DOUBLE
        );
        if !numbers || column.max_rep_level() > 0 {
            found.leave_out(&name, "it is no column of numbers");
            continue;
        }
        let Some(scale) = scale(column) else {
            found.leave_out(&name, "its numbers are of a kind that is not read");
            continue;
        };
        // Times since 1970 need more digits than a number has: they count from the first one.
        let (times, start) = (scale != 1.0, OnceCell::new());
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
                ColumnReader::Int32ColumnReader(reader) => {
                    cells(reader, most, first, &mut found, |v| f64::from(*v))?;
                }
                ColumnReader::Int64ColumnReader(reader) => {
                    let since = |v: &i64| {
                        let start = if times { *start.get_or_init(|| *v) } else { 0 };
                        v.wrapping_sub(start) as f64
                    };
                    cells(reader, most, first, &mut found, since)?;
                }
                ColumnReader::FloatColumnReader(reader) => {
                    cells(reader, most, first, &mut found, |v| f64::from(*v))?;
                }
                ColumnReader::DoubleColumnReader(reader) => {
                    cells(reader, most, first, &mut found, |v| *v)?;
                }
                _ => return Err(format!("`{name}` is not of the type that it says")),
            }
        }
        values.iter_mut().for_each(|value| *value *= scale);
        found.variables.push(Variable { name, rows: values.len(), columns: 1, values });
    }
    Ok(found)
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
            .map_err(|error| error.to_string())?;
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

/// Factor of a column's numbers: seconds for times; none where it is of another kind.
fn scale(column: &ColumnDescriptor) -> Option<f64> {
    match column.logical_type_ref() {
        None | Some(LogicalType::Integer(_)) => Some(1.0),
        Some(LogicalType::Timestamp(time)) => Some(seconds(&time.unit)),
        Some(LogicalType::Time(time)) => Some(seconds(&time.unit)),
        _ => None,
    }
}

const fn seconds(unit: &TimeUnit) -> f64 {
    match unit {
        TimeUnit::MILLIS => 1e-3,
        TimeUnit::MICROS => 1e-6,
        TimeUnit::NANOS => 1e-9,
    }
}
