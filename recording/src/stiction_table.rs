//! A recording of a stiction limit cycle from a CSV file: time, angle and motor voltage, and a
//! pendulum's angle where there is one.

use std::path::{Path, PathBuf};

use super::column::Channel;
use super::layout::Layout;
use super::sheet::{Cells, Found, Loaded, Missing, Sheet, load};
use super::timing::even_step;
use super::{Column, RecordingError};

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
    parse(path, load(path, &Layout::default())?, columns)
}

fn parse<'a>(
    path: &Path,
    loaded: impl Into<Loaded<'a>>,
    columns: &StictionColumns,
) -> Result<StictionTable, RecordingError> {
    let loaded = loaded.into();
    let mut sheet = Sheet::open(path, &loaded, &Layout::default(), "t,theta,plant_input")?;
    let mut wanted = vec![
        sheet.require(Channel::Time, Some(&columns.time))?,
        sheet.require(Channel::Angle, Some(&columns.angle))?,
        sheet.require(Channel::Voltage, Some(&columns.voltage))?,
    ];
    if let Some(column) = &columns.pendulum {
        wanted.push(sheet.require(Channel::Pendulum, Some(column))?);
    }
    let wanted: Vec<&Found> = wanted.iter().collect();
    let Cells { values, lines, .. } = sheet.columns(&wanted, Missing::Refused)?;
    let mut values = values.into_iter();
    let mut next = || values.next().unwrap_or_default();
    let (time, angle, voltage) = (next(), next(), next());
    let time_step = even_step(path, &time, TOLERANCE, |index| sheet.place(lines[index]))?;
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
