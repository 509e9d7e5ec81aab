//! A recording from a CSV file: a header with column names, then one line a sample.
//!
//! Commas, semicolons and tabs separate, whichever the header has most of. Columns are named on the
//! command line or recognised by their names; a unit at the end of a name (`_mm`, `_deg`, `_ms`) is
//! converted.

use std::path::Path;

use csv::{ReaderBuilder, StringRecord, Trim};

use super::column::{Channel, axis_of, unit_factor};
use super::timing::Timing;
use super::{AxisKind, ChannelSource, Column, RecordedStretch, Recording, RecordingError, Sources};

/// Which columns hold what; what is not named is recognised.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Columns {
    /// Time.
    pub time: Option<Column>,
    /// Position.
    pub position: Option<Column>,
    /// Velocity; used in place of the position only where named, or where there is no position.
    pub velocity: Option<Column>,
    /// Force or torque.
    pub force: Option<Column>,
}

/// Reads a CSV file. Time steps may deviate by `tolerance`, a fraction, from the usual one;
/// [`timing`](super::timing) says what becomes of others.
///
/// # Errors
/// [`RecordingError`], naming the file and, where there is one, the line and the column.
pub fn read(path: &Path, columns: &Columns, tolerance: f64) -> Result<Recording, RecordingError> {
    let bytes = files::input::table(path)
        .map_err(|source| RecordingError::Read { path: path.into(), source })?;
    parse(path, &bytes, columns, tolerance)
}

/// Starts reading a table: the reader stands below the header, whose names are returned. `example`
/// is a header that would do.
pub(super) fn open<'a>(
    path: &Path,
    bytes: &'a [u8],
    example: &'static str,
) -> Result<(csv::Reader<&'a [u8]>, Vec<String>), RecordingError> {
    // A byte order mark, as spreadsheets write it, is no part of the first name.
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return Err(RecordingError::Empty { path: path.into() });
    }
    let mut reader = ReaderBuilder::new()
        .delimiter(delimiter(bytes))
        .trim(Trim::All)
        .flexible(true)
        .from_reader(bytes);
    let header: Vec<String> = reader
        .headers()
        .map_err(|error| damaged(path, &error))?
        .iter()
        .map(str::to_owned)
        .collect();
    if header.iter().all(|name| name.parse::<f64>().is_ok()) {
        return Err(RecordingError::NoHeader { path: path.into(), example });
    }
    Ok((reader, header))
}

/// A column that was found: where it stands and how it is scaled.
#[derive(Debug, Clone)]
pub(super) struct Found {
    pub index: usize,
    pub source: ChannelSource,
}

/// The part of [`read`] that does not touch the disk.
fn parse(
    path: &Path,
    bytes: &[u8],
    columns: &Columns,
    tolerance: f64,
) -> Result<Recording, RecordingError> {
    let rows = rows(path, bytes, columns, Motion::One)?;
    let timing = Timing::of(path, &rows.time, tolerance, |index| rows.place(index))?.of_one_rate();
    Ok(Recording {
        path: path.into(),
        time_step: timing.stretches[0].time_step,
        position: rows.position.map(|position| super::position_of(&timing, &position)),
        velocity: rows.velocity.map(|velocity| super::all_stretches(&timing, &velocity, None)),
        force: super::all_stretches(&timing, &rows.force, None),
        stretches: RecordedStretch::of(&timing, 0),
        irregularities: timing.irregularities,
        axis: rows.axis,
        friction_only: false,
        sources: rows.sources,
    })
}

/// Which of position and velocity are read where a table has both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Motion {
    /// The position, unless the velocity was named.
    One,
    /// Both.
    Both,
}

/// The rows of a table, at whatever times.
pub(super) struct Rows {
    pub time: Vec<f64>,
    pub position: Option<Vec<f64>>,
    pub velocity: Option<Vec<f64>>,
    pub force: Vec<f64>,
    pub axis: Option<AxisKind>,
    pub sources: Sources,
    lines: Vec<u64>,
}

impl Rows {
    /// Where row `index` stands.
    pub fn place(&self, index: usize) -> String {
        format!("line {}", self.lines.get(index).copied().unwrap_or(0))
    }
}

/// Reads all rows; one at least.
pub(super) fn rows(
    path: &Path,
    bytes: &[u8],
    columns: &Columns,
    motion: Motion,
) -> Result<Rows, RecordingError> {
    let (mut reader, header) = open(path, bytes, "t_s,position_m,force_N")?;
    let table = Header { path, names: &header };
    let time = table.require(Channel::Time, columns.time.as_ref())?;
    let velocity = table.optional(Channel::Velocity, columns.velocity.as_ref())?;
    let position = table.optional(Channel::Position, columns.position.as_ref())?;
    let (position, velocity) = match (position, velocity) {
        (None, None) => return Err(table.unrecognised(Channel::Position)),
        (Some(position), Some(_)) if motion == Motion::One && columns.velocity.is_none() => {
            (Some(position), None)
        }
        (position, velocity) => (position, velocity),
    };
    let force = table.require(Channel::Force, columns.force.as_ref())?;

    let mut times = Vec::new();
    let mut lines = Vec::new();
    let mut positions = position.as_ref().map(|_| Vec::new());
    let mut velocities = velocity.as_ref().map(|_| Vec::new());
    let mut forces = Vec::new();
    let mut record = StringRecord::new();
    while reader.read_record(&mut record).map_err(|error| damaged(path, &error))? {
        let line = record.position().map_or(0, csv::Position::line);
        let number = |found: &Found| table.number(&record, line, found);
        lines.push(line);
        times.push(number(&time)?);
        forces.push(number(&force)?);
        if let (Some(found), Some(values)) = (&position, &mut positions) {
            values.push(number(found)?);
        }
        if let (Some(found), Some(values)) = (&velocity, &mut velocities) {
            values.push(number(found)?);
        }
    }
    if times.is_empty() {
        return Err(RecordingError::HeaderOnly { path: path.into() });
    }
    let moving = velocity.as_ref().or(position.as_ref());
    let axis = moving
        .and_then(|found| axis_of(&found.source.name))
        .or_else(|| axis_of(&force.source.name));
    Ok(Rows {
        time: times,
        position: positions,
        velocity: velocities,
        force: forces,
        axis,
        sources: Sources {
            time: time.source,
            position: position.map(|found| found.source),
            velocity: velocity.map(|found| found.source),
            force: force.source,
        },
        lines,
    })
}

/// What separates the columns: the candidate that the first line has most of.
fn delimiter(bytes: &[u8]) -> u8 {
    let line = bytes.split(|&byte| byte == b'\n').next().unwrap_or(bytes);
    let count = |candidate: u8| line.iter().filter(|&&byte| byte == candidate).count();
    // Of equals the last wins, so the comma comes last.
    [b'\t', b';', b','].into_iter().max_by_key(|&candidate| count(candidate)).unwrap_or(b',')
}

pub(super) fn damaged(path: &Path, error: &csv::Error) -> RecordingError {
    let line = error.position().map_or(1, csv::Position::line);
    let detail = match error.kind() {
        csv::ErrorKind::Utf8 { .. } => "it is not UTF-8 text".to_owned(),
        _ => error.to_string(),
    };
    RecordingError::Line { path: path.into(), line, detail }
}

/// The header of a file.
pub(super) struct Header<'a> {
    pub path: &'a Path,
    pub names: &'a [String],
}

impl Header<'_> {
    pub(super) fn require(
        &self,
        channel: Channel,
        named: Option<&Column>,
    ) -> Result<Found, RecordingError> {
        self.optional(channel, named)?.ok_or_else(|| self.unrecognised(channel))
    }

    /// The column of a channel; none only where it was not named and is not recognised.
    pub(super) fn optional(
        &self,
        channel: Channel,
        named: Option<&Column>,
    ) -> Result<Option<Found>, RecordingError> {
        let (name, scale) = match named {
            Some(column) => (column.name.as_str(), column.scale),
            None => match channel.recognise(self.names) {
                Some(name) => (name, None),
                None => return Ok(None),
            },
        };
        let count = self.names.iter().filter(|other| *other == name).count();
        if count > 1 {
            return Err(RecordingError::Ambiguous {
                path: self.path.into(),
                name: name.to_owned(),
                count,
            });
        }
        let index = self.names.iter().position(|other| other == name).ok_or_else(|| {
            RecordingError::NoColumn {
                path: self.path.into(),
                name: name.to_owned(),
                present: self.names.join(", "),
                channel,
            }
        })?;
        let scale = scale.unwrap_or_else(|| unit_factor(name));
        Ok(Some(Found { index, source: ChannelSource { name: name.to_owned(), scale } }))
    }

    pub(super) fn unrecognised(&self, channel: Channel) -> RecordingError {
        RecordingError::Unrecognised {
            path: self.path.into(),
            channel,
            present: self.names.join(", "),
        }
    }

    pub(super) fn number(
        &self,
        record: &StringRecord,
        line: u64,
        found: &Found,
    ) -> Result<f64, RecordingError> {
        let Some(cell) = record.get(found.index) else {
            let detail =
                format!("it has {} fields where the header has {}", record.len(), self.names.len());
            return Err(RecordingError::Line { path: self.path.into(), line, detail });
        };
        match cell.parse::<f64>().map(|value| value * found.source.scale) {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(RecordingError::Cell {
                path: self.path.into(),
                line,
                column: found.source.name.clone(),
                found: cell.to_owned(),
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn parsed(text: &str) -> Result<Recording, RecordingError> {
        parse(Path::new("x.csv"), text.as_bytes(), &Columns::default(), 0.05)
    }

    fn message(text: &str) -> String {
        parsed(text).unwrap_err().to_string()
    }

    #[test]
    fn reads_what_the_names_say() {
        let text = "t_s,position_m,force_N\n0,1,2\n0.1,1.5,-3e1\n0.2,2,4\n";
        let recording = parsed(text).unwrap();
        assert!((recording.time_step - 0.1).abs() < 1e-15);
        assert_eq!(recording.position, Some(vec![1.0, 1.5, 2.0]));
        assert_eq!(recording.velocity, None);
        assert_eq!(recording.force, [2.0, -30.0, 4.0]);
        assert_eq!(recording.axis, Some(AxisKind::Linear));
    }

    #[test]
    fn blanks_semicolons_marks_and_units_are_understood() {
        let text =
            "\u{feff}time_ms ; Position_deg ;torque_Nm\r\n0; 180;1\r\n 10;90 ;2\r\n20;0;3\r\n";
        let recording = parsed(text).unwrap();
        assert!((recording.time_step - 0.01).abs() < 1e-15);
        assert!((recording.position.unwrap()[0] - std::f64::consts::PI).abs() < 1e-15);
        assert_eq!(recording.axis, Some(AxisKind::Rotary));
    }

    #[test]
    fn a_velocity_is_used_when_named_or_alone() {
        let both = "t_s,position_m,velocity_m_s,force_N\n0,1,5,2\n1,1,6,2\n2,1,7,2\n";
        assert_eq!(parsed(both).unwrap().velocity, None);
        let named =
            Columns { velocity: Some("velocity_m_s".parse().unwrap()), ..Columns::default() };
        let recording = parse(Path::new("x.csv"), both.as_bytes(), &named, 0.05).unwrap();
        assert_eq!(recording.velocity, Some(vec![5.0, 6.0, 7.0]));
        let alone = "t_s,velocity_m_s,force_N\n0,5,2\n1,6,2\n2,7,2\n";
        assert_eq!(parsed(alone).unwrap().velocity, Some(vec![5.0, 6.0, 7.0]));
    }

    #[test]
    fn says_what_is_wrong_and_where() {
        for (text, parts) in [
            ("", &["x.csv", "empty"][..]),
            ("  \n\n", &["empty"]),
            ("t_s,position_m,force_N\n", &["no samples"]),
            ("0,1,2\n1,2,3\n", &["line 1", "header"]),
            ("t_s,position_m,u\n0,1,2\n", &["t_s, position_m, u", "force or torque", "N or N m"]),
            ("t_s,q,force_N\n0,1,2\n", &["recognised as the position"]),
            ("a,position_m,force_N\n0,1,2\n", &["recognised as the time"]),
            ("t_s,position_m,force_N\n0,1,2\n1,oops,2\n", &["line 3", "position_m", "oops"]),
            ("t_s,position_m,force_N\n0,1,NaN\n", &["line 2", "force_N", "NaN"]),
            ("t_s,position_m,force_N\n0,1,inf\n", &["line 2", "inf"]),
            ("t_s,position_m,force_N\n0,1,\n", &["line 2", "force_N"]),
            ("t_s,position_m,force_N\n0,1,2\n1,2\n", &["line 3", "2 fields", "3"]),
            ("t_s,force_N,force_N,position_m\n0,1,2,3\n", &["2 columns", "force_N"]),
            ("t_s,position_m,force_N\n0,1,2\n2,1,2\n1,1,2\n", &["line 4", "does not increase"]),
            ("t_s,position_m,force_N\n0,1,2\n", &["1 samples"]),
        ] {
            let message = message(text);
            for part in parts {
                assert!(message.contains(part), "{text:?} gave {message:?} without {part:?}");
            }
        }
        let named = Columns { force: Some("farce".parse().unwrap()), ..Columns::default() };
        let error = parse(Path::new("x.csv"), b"t_s,position_m,force_N\n0,1,2\n", &named, 0.05)
            .unwrap_err();
        assert!(error.to_string().contains("no column `farce`"));
        let latin = parse(
            Path::new("x.csv"),
            b"t_s,position_m,force_N\n0,1,\xff\n",
            &Columns::default(),
            0.05,
        );
        assert!(latin.unwrap_err().to_string().contains("line 2"));
    }

    proptest! {
        #[test]
        fn never_panics(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            let _ = parse(Path::new("x.csv"), &bytes, &Columns::default(), 0.05);
        }

        #[test]
        fn never_panics_on_near_tables(rows in "(t_s,position_m,force_N\n)([0-9.,;\n\" a-]{0,80})") {
            let _ = parsed(&rows);
        }
    }
}
