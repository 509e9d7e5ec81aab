//! A motion along which a model is evaluated: a CSV file with time and velocity, at any spacing.

use std::path::Path;

use csv::StringRecord;

use super::column::{Channel, axis_of, unit_factor};
use super::table::{Found, Header, damaged, open};
use super::{AxisKind, ChannelSource, RecordingError};

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
    let (mut reader, names) = open(path, bytes, "t_s,velocity_rad_s")?;
    let columns = Columns { path, names: &names };
    let time = columns.require("time", Channel::Time.recognise(&names), "t_s")?;
    let velocity = columns.one_of("velocity", &VELOCITIES)?;
    let velocity = columns.require("velocity", velocity, "velocity_rad_s or velocity_m_s")?;
    let load = columns.one_of("load", &LOADS)?.map(|name| columns.find(name)).transpose()?;
    let axis = axis_of(&velocity.source.name).unwrap_or(AxisKind::Rotary);

    let table = Header { path, names: &names };
    let (mut times, mut velocities) = (Vec::new(), Vec::new());
    let mut loads = load.as_ref().map(|_| Vec::new());
    let mut record = StringRecord::new();
    while reader.read_record(&mut record).map_err(|error| damaged(path, &error))? {
        let line = record.position().map_or(0, csv::Position::line);
        let t = table.number(&record, line, &time)?;
        if let Some(&before) = times.last()
            && t <= before
        {
            let place = format!("line {line}");
            return Err(RecordingError::TimeOrder { path: path.into(), place, before, time: t });
        }
        times.push(t);
        velocities.push(table.number(&record, line, &velocity)?);
        if let (Some(found), Some(values)) = (&load, &mut loads) {
            values.push(table.number(&record, line, found)?);
        }
    }
    if times.is_empty() {
        return Err(RecordingError::HeaderOnly { path: path.into() });
    }
    Ok(Trajectory { time: times, velocity: velocities, load: loads, axis })
}

/// The columns of a file by name.
struct Columns<'a> {
    path: &'a Path,
    names: &'a [String],
}

impl<'a> Columns<'a> {
    /// The only column whose name is one of `known`; none if there is none.
    fn one_of(
        &self,
        channel: &'static str,
        known: &[&str],
    ) -> Result<Option<&'a str>, RecordingError> {
        let is_known = |name: &&String| known.iter().any(|known| known.eq_ignore_ascii_case(name));
        let found: Vec<&str> = self.names.iter().filter(is_known).map(String::as_str).collect();
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
        channel: &'static str,
        name: Option<&str>,
        expected: &'static str,
    ) -> Result<Found, RecordingError> {
        let missing = || RecordingError::MissingColumn {
            path: self.path.into(),
            channel,
            expected,
            present: self.names.join(", "),
        };
        self.find(name.ok_or_else(missing)?)
    }

    fn find(&self, name: &str) -> Result<Found, RecordingError> {
        let mut places = self.names.iter().enumerate().filter(|(_, other)| *other == name);
        let index = places.next().map_or(0, |(index, _)| index);
        match places.count() {
            0 => Ok(Found {
                index,
                source: ChannelSource { name: name.to_owned(), scale: unit_factor(name) },
            }),
            others => Err(RecordingError::Ambiguous {
                path: self.path.into(),
                name: name.to_owned(),
                count: others + 1,
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
