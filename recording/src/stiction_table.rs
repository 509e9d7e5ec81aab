//! A recording of a stiction limit cycle from a CSV file: time, angle and motor voltage, and a
//! pendulum's angle where there is one.

use std::path::{Path, PathBuf};

use csv::StringRecord;

use super::column::{Channel, unit_factor};
use super::table::{Found, Header, damaged, open};
use super::timing::even_step;
use super::{ChannelSource, Column, RecordingError};

/// Which columns hold what.
#[derive(Debug, Clone, PartialEq)]
pub struct StictionColumns {
    /// Time \[s\].
    pub time: Column,
    /// Angle of the axis \[rad\].
    pub angle: Column,
    /// Voltage on the motor \[V\].
    pub voltage: Column,
    /// Angle of a pendulum on the axis \[rad\].
    pub pendulum: Option<Column>,
}

/// An evenly sampled recording.
#[derive(Debug, Clone, PartialEq)]
pub struct StictionTable {
    /// The file.
    pub path: PathBuf,
    /// Sampling period \[s\].
    pub time_step: f64,
    /// Angle \[rad\].
    pub angle: Vec<f64>,
    /// Voltage \[V\].
    pub voltage: Vec<f64>,
    /// Angle of the pendulum \[rad\].
    pub pendulum: Option<Vec<f64>>,
}

/// How far a time step may be from the usual one.
const TOLERANCE: f64 = 0.05;

/// Reads a CSV file; blanks around the names in its header do not count.
///
/// # Errors
/// [`RecordingError`], naming the file and, where there is one, the line and the column.
pub fn read(path: &Path, columns: &StictionColumns) -> Result<StictionTable, RecordingError> {
    let bytes = files::input::table(path)
        .map_err(|source| RecordingError::Read { path: path.into(), source })?;
    parse(path, &bytes, columns)
}

fn parse(
    path: &Path,
    bytes: &[u8],
    columns: &StictionColumns,
) -> Result<StictionTable, RecordingError> {
    let (mut reader, names) = open(path, bytes, "t,theta,plant_input")?;
    let find = |column: &Column, channel: Channel| {
        let index = names.iter().position(|name| *name == column.name).ok_or_else(|| {
            RecordingError::NoColumn {
                path: path.into(),
                name: column.name.clone(),
                present: names.join(", "),
                channel,
            }
        })?;
        let scale = column.scale.unwrap_or_else(|| unit_factor(&column.name));
        Ok::<_, RecordingError>(Found {
            index,
            source: ChannelSource { name: column.name.clone(), scale },
        })
    };
    let mut wanted = vec![
        find(&columns.time, Channel::Time)?,
        find(&columns.angle, Channel::Angle)?,
        find(&columns.voltage, Channel::Voltage)?,
    ];
    if let Some(column) = &columns.pendulum {
        wanted.push(find(column, Channel::Pendulum)?);
    }
    let table = Header { path, names: &names };
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); wanted.len()];
    let mut lines = Vec::new();
    let mut record = StringRecord::new();
    while reader.read_record(&mut record).map_err(|error| damaged(path, &error))? {
        let line = record.position().map_or(0, csv::Position::line);
        lines.push(line);
        for (found, column) in wanted.iter().zip(&mut values) {
            column.push(table.number(&record, line, found)?);
        }
    }
    let mut values = values.into_iter();
    let mut next = || values.next().unwrap_or_default();
    let (time, angle, voltage) = (next(), next(), next());
    if time.is_empty() {
        return Err(RecordingError::HeaderOnly { path: path.into() });
    }
    let time_step = even_step(path, &time, TOLERANCE, |index| format!("line {}", lines[index]))?;
    let pendulum = columns.pendulum.is_some().then(next);
    Ok(StictionTable { path: path.into(), time_step, angle, voltage, pendulum })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(pendulum: Option<&str>) -> StictionColumns {
        let column = |name: &str| name.parse::<Column>().unwrap();
        StictionColumns {
            time: column("t"),
            angle: column("theta"),
            voltage: column("u:2"),
            pendulum: pendulum.map(column),
        }
    }

    #[test]
    fn blanks_in_the_header_do_not_count() {
        let text = "t, theta, u, alpha\n0, 1, 5, 7\n0.1, 2, 6, 8\n0.2, 3, 7, 9\n";
        let read = parse(Path::new("a.csv"), text.as_bytes(), &columns(Some("alpha"))).unwrap();
        assert_eq!((read.angle, read.voltage), (vec![1.0, 2.0, 3.0], vec![10.0, 12.0, 14.0]));
        assert_eq!(read.pendulum, Some(vec![7.0, 8.0, 9.0]));
    }

    #[test]
    fn a_missing_column_is_named() {
        let text = "t, theta, u\n0, 1, 5\n";
        let error = parse(Path::new("a.csv"), text.as_bytes(), &columns(Some("alpha")))
            .unwrap_err()
            .to_string();
        assert!(error.contains("alpha") && error.contains("t, theta, u"), "{error}");
    }
}
