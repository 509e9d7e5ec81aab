//! A motion along which a model is evaluated: a CSV file with time and velocity, at any spacing.

use std::path::Path;

use super::column::Channel;
use super::sheet::{Cells, Found, Missing, Sheet};
use super::{AxisKind, RecordingError};

/// Names of the velocity column. Each says whether the axis turns, which decides the units of the
/// results.
const VELOCITIES: [&str; 6] = [
    "velocity_rad_s",
    "velocity_m_s",
    "velocity_deg_s",
    "velocity_mm_s",
    "speed_rad_s",
    "speed_m_s",
];
/// Names of the column with the transmitted load.
const LOADS: [&str; 3] = ["load_Nm", "load_N_m", "load_N"];

/// A motion: one velocity, and where given one load, for each time.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// Times \[s\], increasing.
    pub time: Vec<f64>,
    /// Velocities \[m/s or rad/s\].
    pub velocity: Vec<f64>,
    /// Transmitted loads \[N or N m\], where the file has them.
    pub load: Option<Vec<f64>>,
    /// Kind of axis, as the name of the velocity column tells it.
    pub axis: AxisKind,
}

impl Trajectory {
    /// Time between the first and the last row \[s\].
    #[must_use]
    pub fn duration(&self) -> f64 {
        match (self.time.first(), self.time.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }
}

/// Reads a CSV file with the columns `t_s`, `velocity_rad_s` or `velocity_m_s`, and if there is one
/// `load_Nm` or `load_N`; other columns are left alone. The rows may be unevenly spaced.
///
/// # Errors
/// [`RecordingError`], naming the file and, where there is one, the line and the column.
pub fn read(path: &Path) -> Result<Trajectory, RecordingError> {
    let bytes = files::input::table(path)
        .map_err(|source| RecordingError::Read { path: path.into(), source })?;
    parse(path, &bytes)
}

fn parse(path: &Path, bytes: &[u8]) -> Result<Trajectory, RecordingError> {
    let mut sheet = Sheet::open(path, bytes, "t_s,velocity_rad_s")?;
    let columns = Columns { path, sheet: &sheet };
    let time = columns.require(Channel::Time, Channel::Time.recognise(&sheet.names), "t_s")?;
    let velocity = columns.one_of("velocity", &VELOCITIES)?;
    let velocity =
        columns.require(Channel::Velocity, velocity, "velocity_rad_s or velocity_m_s")?;
    let load = columns.one_of("load", &LOADS)?;
    let load = load.map(|name| sheet.find(Channel::Force, name, None)).transpose()?;
    let axis = velocity.axis.unwrap_or(AxisKind::Rotary);

    let wanted: Vec<&Found> = [&time, &velocity].into_iter().chain(&load).collect();
    let Cells { values, lines, .. } = sheet.columns(&wanted, Missing::Refused)?;
    let mut values = values.into_iter();
    let mut next = || values.next().unwrap_or_default();
    let (time, velocity) = (next(), next());
    for (pair, line) in time.windows(2).zip(lines.iter().skip(1)) {
        if pair[1] <= pair[0] {
            let (path, place) = (path.into(), format!("line {line}"));
            let (before, time) = (pair[0], pair[1]);
            return Err(RecordingError::TimeOrder { path, place, before, time });
        }
    }
    Ok(Trajectory { time, velocity, load: load.map(|_| next()), axis })
}

/// The columns of a file by name.
struct Columns<'a> {
    path: &'a Path,
    sheet: &'a Sheet<'a>,
}

impl<'a> Columns<'a> {
    /// The only column whose name is one of `known`; none if there is none.
    fn one_of(
        &self,
        channel: &'static str,
        known: &[&str],
    ) -> Result<Option<&'a str>, RecordingError> {
        let is_known = |name: &&String| known.iter().any(|known| known.eq_ignore_ascii_case(name));
        let found: Vec<&str> =
            self.sheet.names.iter().filter(is_known).map(String::as_str).collect();
        match found[..] {
            [] => Ok(None),
            [name] => Ok(Some(name)),
            _ => {
                let present = found.join(", ");
                Err(RecordingError::Several { path: self.path.into(), channel, present })
            }
        }
    }

    fn require(
        &self,
        channel: Channel,
        name: Option<&str>,
        expected: &'static str,
    ) -> Result<Found, RecordingError> {
        match name {
            Some(name) => self.sheet.find(channel, name, None),
            None if self.sheet.dialect.headerless => Err(self.sheet.no_header()),
            None => Err(RecordingError::MissingColumn {
                path: self.path.into(),
                channel: channel.describe(),
                expected,
                present: self.sheet.names.join(", "),
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn parsed(text: &str) -> Result<Trajectory, RecordingError> {
        parse(Path::new("x.csv"), text.as_bytes())
    }

    #[test]
    fn unevenly_spaced_rows_units_and_other_columns_are_accepted() {
        let text = "note,t_ms,velocity_m_s,load_N\na,0,0.1,5\nb,1,0.2,6\nc,1000,-0.3,7\n";
        let found = parsed(text).unwrap();
        assert_eq!(found.time, [0.0, 1e-3, 1.0]);
        assert_eq!(found.velocity, [0.1, 0.2, -0.3]);
        assert_eq!(found.load, Some(vec![5.0, 6.0, 7.0]));
        assert_eq!((found.axis, found.duration()), (AxisKind::Linear, 1.0));
        let found = parsed("T_s;Velocity_deg_s\n0;180\n").unwrap();
        assert!((found.velocity[0] - std::f64::consts::PI).abs() < 1e-15);
        assert_eq!((found.axis, found.load, found.time.len()), (AxisKind::Rotary, None, 1));
    }

    #[test]
    fn says_what_is_wrong_and_where() {
        for (text, parts) in [
            ("", &["x.csv", "empty"][..]),
            ("t_s,velocity_rad_s\n", &["no samples"]),
            ("0,1\n1,2\n", &["line 1", "header", "t_s,velocity_rad_s"]),
            ("velocity_rad_s\n1\n", &["time", "t_s", "columns are: velocity_rad_s"]),
            ("t_s,velocity\n0,1\n", &["velocity_rad_s or velocity_m_s", "t_s, velocity"]),
            ("t_s,velocity_m_s,velocity_rad_s\n0,1,1\n", &["velocity_m_s, velocity_rad_s"]),
            ("t_s,velocity_m_s,velocity_m_s\n0,1,1\n", &["velocity_m_s, velocity_m_s"]),
            ("t_s,t_s,velocity_m_s\n0,1,1\n", &["2 columns named `t_s`"]),
            ("t_s,velocity_m_s\n0,1\n1,NaN\n", &["line 3", "velocity_m_s", "NaN"]),
            ("t_s,velocity_m_s\n0,1\n1\n", &["line 3", "1 fields"]),
            ("t_s,velocity_m_s,load_N\n0,1,x\n", &["line 2", "load_N"]),
            ("t_s,velocity_m_s\n0,1\n2,1\n2,1\n", &["line 4", "does not increase"]),
        ] {
            let message = parsed(text).unwrap_err().to_string();
            for part in parts {
                assert!(message.contains(part), "{text:?} gave {message:?} without {part:?}");
            }
        }
    }

    proptest! {
        #[test]
        fn never_panics_on_near_tables(rows in "(t_s,velocity_m_s\n)([0-9.,;\n\" a-]{0,80})") {
            let _ = parsed(&rows);
        }
    }
}
