//! A motion along which a model is evaluated: a CSV file with time and velocity, at any spacing.

use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Read};
use std::path::{Path, PathBuf};

use super::column::Channel;
use super::grid::{self, Form};
use super::layout::Layout;
use super::sheet::{Cells, Flow, Found, Loaded, Missing, Sheet, load};
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
/// As spreadsheets write it; no part of the first name.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// A header that would do.
const EXAMPLE: &str = "t_s,velocity_rad_s";

/// A moment of a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// When \[s\].
    pub time: f64,
    /// How fast \[m/s or rad/s\].
    pub velocity: f64,
    /// The transmitted load \[N or N m\]; 0 where the motion has none.
    pub load: f64,
}

/// A motion that is read as it is needed: one velocity, and where given one load, for each time. As
/// an iterator it gives its moments, times increasing, and ends with the first error.
pub struct Trajectory {
    path: PathBuf,
    /// Kind of axis, as the name of the velocity column tells it.
    pub axis: AxisKind,
    /// Whether there are loads.
    pub loaded: bool,
    rows: Rows,
    before: Option<f64>,
    ended: bool,
}

/// Where its rows come from.
enum Rows {
    /// A text, as it is read.
    Flowing(Box<Flow>),
    /// What is no text is read whole: the columns, and the row that is next.
    Read(Vec<Vec<f64>>, usize),
}

/// Bytes at the beginning of a file from which its columns are told.
const HEAD: u64 = 1 << 16;

/// Opens a CSV file with the columns `t_s`, `velocity_rad_s` or `velocity_m_s`, and if there is one
/// `load_Nm` or `load_N`; other columns are left alone. The rows may be unevenly spaced.
///
/// # Errors
/// [`RecordingError`], naming the file and, where there is one, the line and the column.
pub fn open(path: &Path) -> Result<Trajectory, RecordingError> {
    let read = |source| RecordingError::Read { path: path.into(), source };
    from_text(path, BufReader::new(File::open(path).map_err(read)?))
}

/// The same from a reader, which may have no end.
///
/// # Errors
/// As of [`open`], naming `path`.
pub fn from_text(
    path: &Path,
    mut text: impl BufRead + 'static,
) -> Result<Trajectory, RecordingError> {
    let mut head = Vec::new();
    let begun = text.by_ref().take(HEAD).read_to_end(&mut head);
    begun.map_err(|source| RecordingError::Read { path: path.into(), source })?;
    if grid::form_of(&head) != Form::Text {
        return read_whole(path);
    }
    // Whole lines only, if there are any: half a number is another one.
    let whole = head.iter().rposition(|&byte| byte == b'\n').filter(|_| head.len() as u64 == HEAD);
    let lines = whole.and_then(|last| head.get(..=last)).unwrap_or(&head);
    let lines = Loaded::from(lines);
    let sheet = Sheet::open(path, &lines, &Layout::default(), EXAMPLE)?;
    let (found, axis) = Columns { path, sheet: &sheet }.all()?;
    let (dialect, fields, loaded) = (sheet.dialect, sheet.names.len(), found.len() > 2);
    let head = head.strip_prefix(BYTE_ORDER_MARK).unwrap_or(&head).to_vec();
    let text = Box::new(Cursor::new(head).chain(text));
    let flow = Flow::new(path.into(), text, dialect, fields, found);
    let rows = Rows::Flowing(Box::new(flow));
    Ok(Trajectory { path: path.into(), axis, loaded, rows, before: None, ended: false })
}

fn read_whole(path: &Path) -> Result<Trajectory, RecordingError> {
    let layout = Layout::default();
    let columns = load(path, &layout)?;
    let mut sheet = Sheet::open(path, &columns, &layout, EXAMPLE)?;
    let (found, axis) = Columns { path, sheet: &sheet }.all()?;
    let loaded = found.len() > 2;
    let Cells { values, .. } =
        sheet.columns(&found.iter().collect::<Vec<_>>(), Missing::Refused)?;
    let rows = Rows::Read(values, 0);
    Ok(Trajectory { path: path.into(), axis, loaded, rows, before: None, ended: false })
}

impl Rows {
    /// The place of the next row, whose values go into `row`.
    fn next(&mut self, row: &mut [f64]) -> Result<Option<String>, RecordingError> {
        match self {
            Self::Flowing(flow) => Ok(flow.next(row)?.map(|line| format!("line {line}"))),
            Self::Read(columns, next) => {
                let at = *next;
                *next += 1;
                for (value, column) in row.iter_mut().zip(columns.iter()) {
                    let Some(found) = column.get(at) else { return Ok(None) };
                    *value = *found;
                }
                Ok(Some(format!("row {}", at + 1)))
            }
        }
    }
}

impl Trajectory {
    /// About how much of the file was read \[bytes\].
    #[must_use]
    pub fn bytes(&self) -> u64 {
        match &self.rows {
            Rows::Flowing(flow) => flow.bytes(),
            Rows::Read(_, next) => (*next * size_of::<f64>() * 2) as u64,
        }
    }

    fn point(&mut self) -> Result<Option<Point>, RecordingError> {
        let mut row = [0.0; 3];
        let Some(place) = self.rows.next(&mut row)? else { return Ok(None) };
        let [time, velocity, load] = row;
        if let Some(before) = self.before.filter(|before| time <= *before) {
            let path = self.path.clone();
            return Err(RecordingError::TimeOrder { path, place, before, time });
        }
        self.before = Some(time);
        Ok(Some(Point { time, velocity, load }))
    }
}

impl Iterator for Trajectory {
    type Item = Result<Point, RecordingError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let point = self.point();
        self.ended = !matches!(point, Ok(Some(_)));
        point.transpose()
    }
}

/// The columns of a file by name.
struct Columns<'a> {
    path: &'a Path,
    sheet: &'a Sheet<'a>,
}

impl<'a> Columns<'a> {
    /// Time, velocity and, if there is one, load; and the kind of the axis.
    fn all(&self) -> Result<(Vec<Found>, AxisKind), RecordingError> {
        let names = &self.sheet.names;
        let time = self.require(Channel::Time, Channel::Time.recognise(names), "t_s")?;
        let velocity = self.one_of("velocity", &VELOCITIES)?;
        let expected = "velocity_rad_s or velocity_m_s";
        let velocity = self.require(Channel::Velocity, velocity, expected)?;
        let load = self.one_of("load", &LOADS)?;
        let load = load.map(|name| self.sheet.find(Channel::Force, name, None)).transpose()?;
        let axis = velocity.axis.unwrap_or(AxisKind::Rotary);
        Ok(([time, velocity].into_iter().chain(load).collect(), axis))
    }

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

    fn parsed(text: &str) -> Result<(Trajectory, Vec<Point>), RecordingError> {
        let mut opened = from_text(Path::new("x.csv"), Cursor::new(text.to_owned()))?;
        let points = opened.by_ref().collect::<Result<_, _>>()?;
        Ok((opened, points))
    }

    #[test]
    fn unevenly_spaced_rows_units_and_other_columns_are_accepted() {
        let text = "note,t_ms,velocity_m_s,load_N\na,0,0.1,5\nb,1,0.2,6\nc,1000,-0.3,7\n";
        let (found, points) = parsed(text).unwrap();
        let expected = [[0.0, 0.1, 5.0], [1e-3, 0.2, 6.0], [1.0, -0.3, 7.0]];
        assert_eq!(points, expected.map(|[time, velocity, load]| Point { time, velocity, load }));
        assert_eq!((found.axis, found.loaded), (AxisKind::Linear, true));
        let (found, points) = parsed("T_s;Velocity_deg_s\n0;180\n").unwrap();
        assert!((points[0].velocity - std::f64::consts::PI).abs() < 1e-15);
        assert_eq!((found.axis, found.loaded, points.len()), (AxisKind::Rotary, false, 1));
    }

    /// Remarks, blanks and decimal commas, also far behind what is looked at first.
    #[test]
    fn a_long_file_is_read_as_a_short_one() {
        let rows = |separator: &str| {
            let rows = (0..20_000).map(|k| format!("0{separator}{k},5{separator}7\n# half way\n"));
            rows.collect::<String>()
        };
        for (names, separator) in [("x t_s velocity_m_s", " "), ("x;t_s;velocity_m_s", ";")] {
            let (_, points) = parsed(&format!("# made\n{names}\n{}", rows(separator))).unwrap();
            assert_eq!(points.len(), 20_000);
            assert_eq!(points[19_999].time, 19_999.5);
        }
        let text = format!("t_s,velocity_m_s\n{}", "0.1,1\n".repeat(2));
        assert!(parsed(&text).err().unwrap().to_string().contains("line 3"));
    }

    #[test]
    fn a_line_without_an_end_does_not_fill_the_memory() {
        let text =
            Cursor::new(b"t_s,velocity_m_s\n0,1\n").chain(BufReader::new(std::io::repeat(b'1')));
        let opened = from_text(Path::new("x.csv"), text).unwrap();
        let error = opened.filter_map(Result::err).next().unwrap();
        assert!(error.to_string().contains("x.csv"), "{error}");
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
            let message = parsed(text).err().unwrap().to_string();
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
