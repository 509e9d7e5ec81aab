//! A motion along which a model is evaluated: a CSV file with time and velocity, at any spacing.

use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Read};
use std::path::{Path, PathBuf};

use super::column::Channel;
use super::grid::{self, Arrays, Form, Input};
use super::layout::Layout;
use super::sheet::{Cells, Decoding, Flow, Found, Loaded, Missing, Sheet, load};
use super::{AxisKind, RecordingError, units};

/// Name of the column with the transmitted load, in front of its unit.
const LOAD: &str = "load";
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
    /// Kind of axis, as the name of the velocity column tells it; one that turns where it does not.
    pub axis: AxisKind,
    /// Whether there are loads.
    pub loaded: bool,
    /// What of its columns is taken for granted, in sentences.
    pub notes: Vec<String>,
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

/// Opens a table with a time, a velocity and if there is one a load, as in `load_Nm`; other columns
/// are left alone. Columns are recognised as for an identification. The rows may be unevenly spaced.
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
pub fn from_text(path: &Path, text: impl BufRead + 'static) -> Result<Trajectory, RecordingError> {
    let read = |source| RecordingError::Read { path: path.into(), source };
    let (head, text) = begun(Box::new(text)).map_err(read)?;
    grid::refuse_foreign(path, &head)?;
    if grid::form_of(&head) != Form::Text {
        return read_whole(path.into());
    }
    let text: Box<dyn BufRead> = match Decoding::of(whole_lines(&head), text) {
        Ok(decoding) => Box::new(BufReader::new(decoding)),
        Err(text) => text,
    };
    let (head, text) = begun(text).map_err(read)?;
    let lines = Loaded::from(whole_lines(&head));
    let sheet = Sheet::open(path, &lines, &Layout::default(), EXAMPLE)?;
    let Chosen { columns, axis, notes } = Columns { path, sheet: &sheet }.all()?;
    let (dialect, fields, loaded) = (sheet.dialect, sheet.names.len(), columns.len() > 2);
    let flow = Flow::new(path.into(), text, dialect, fields, columns);
    let rows = Rows::Flowing(Box::new(flow));
    Ok(Trajectory { path: path.into(), axis, loaded, notes, rows, before: None, ended: false })
}

/// How a text begins, without a byte order mark, and all of it.
fn begun(mut text: Box<dyn BufRead>) -> std::io::Result<(Vec<u8>, Box<dyn BufRead>)> {
    let mut head = Vec::new();
    (&mut text).take(HEAD).read_to_end(&mut head)?;
    let plain = head.strip_prefix(BYTE_ORDER_MARK).map(<[u8]>::to_vec);
    let head = plain.unwrap_or(head);
    Ok((head.clone(), Box::new(Cursor::new(head).chain(text))))
}

/// Whole lines only, if there are any and more follows: half a number is another one.
fn whole_lines(head: &[u8]) -> &[u8] {
    let cut = head.len() as u64 + BYTE_ORDER_MARK.len() as u64 >= HEAD;
    let whole = head.iter().rposition(|&byte| byte == b'\n').filter(|_| cut);
    whole.and_then(|last| head.get(..=last)).unwrap_or(head)
}

/// A motion of columns in memory, recognised as those of a file are.
///
/// # Errors
/// As of [`open`].
pub fn from_arrays(arrays: &Arrays) -> Result<Trajectory, RecordingError> {
    read_whole(Input::Arrays(arrays))
}

fn read_whole(input: Input<'_>) -> Result<Trajectory, RecordingError> {
    let (path, layout) = (input.path(), Layout::default());
    let table = load(input, &layout)?;
    let mut sheet = Sheet::open(path, &table, &layout, EXAMPLE)?;
    let Chosen { columns, axis, notes } = Columns { path, sheet: &sheet }.all()?;
    let loaded = columns.len() > 2;
    let Cells { values, .. } =
        sheet.columns(&columns.iter().collect::<Vec<_>>(), Missing::Refused)?;
    let rows = Rows::Read(values, 0);
    Ok(Trajectory { path: path.into(), axis, loaded, notes, rows, before: None, ended: false })
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

/// Which columns are read.
struct Chosen {
    /// Time, velocity and, if there is one, load.
    columns: Vec<Found>,
    axis: AxisKind,
    notes: Vec<String>,
}

impl Columns<'_> {
    fn all(&self) -> Result<Chosen, RecordingError> {
        let time = self.require(Channel::Time, "t_s")?;
        self.only_one(|name| {
            Channel::Velocity.recognise(&[name.to_owned()]).is_some()
                && units::parts(name).stem.eq_ignore_ascii_case("velocity")
        })?;
        let velocity = self.require(Channel::Velocity, "velocity_rad_s or velocity_m_s")?;
        let is_load = |name: &str| {
            units::parts(name).stem.eq_ignore_ascii_case(LOAD)
                && matches!(Channel::Force.unit_in(name), Ok(Some(_)))
        };
        let load = self.only_one(is_load)?;
        let load = load.map(|name| self.sheet.find(Channel::Force, name, None)).transpose()?;
        let axis = velocity.axis.unwrap_or(AxisKind::Rotary);
        let mut notes = Vec::new();
        if velocity.assumed {
            let unit = if axis == AxisKind::Rotary { "rad/s" } else { "m/s" };
            let name = &velocity.source.name;
            notes.push(format!("the column `{name}` does not say its unit: it is taken as {unit}"));
        }
        Ok(Chosen { columns: [time, velocity].into_iter().chain(load).collect(), axis, notes })
    }

    /// The only column that is one; none if there is none.
    fn only_one(&self, is_one: impl Fn(&str) -> bool) -> Result<Option<&str>, RecordingError> {
        let names = self.sheet.names.iter().map(String::as_str);
        let found: Vec<&str> = names.filter(|name| is_one(name)).collect();
        match found[..] {
            [] => Ok(None),
            [name] => Ok(Some(name)),
            _ => {
                let channel = if is_one("velocity_rad_s") { "velocity" } else { LOAD };
                let present = found.join(", ");
                Err(RecordingError::Several { path: self.path.into(), channel, present })
            }
        }
    }

    fn require(&self, channel: Channel, expected: &'static str) -> Result<Found, RecordingError> {
        match self.sheet.optional(channel, None)? {
            Some(found) => Ok(found),
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

    /// Only the exact names of this program's own files were known.
    #[test]
    fn the_names_and_forms_of_an_identification_are_read() {
        for (text, assumed) in [
            ("time,dq [rad/s],tau\n0,1,5\n0.5,2,5\n", false),
            ("t [ms];vel\n0;1,0\n500;2,0\n", true),
            ("Rig 5\nof ours\nt,speed (rad/s)\n0,1\n0.5,2\n", false),
            ("sec,nanosec,q,omega_rad_s\n7,0,0,1\n7,500000000,0,2\n", false),
            ("time,velocity\n13.02.2026 10:11:12,1\n13.02.2026 10:11:12.5,2\n", true),
        ] {
            let (found, points) = parsed(text).unwrap_or_else(|error| panic!("{text:?}: {error}"));
            let expected = [[0.0, 1.0], [0.5, 2.0]];
            let read = points.iter().map(|point| [point.time, point.velocity]);
            assert_eq!(read.collect::<Vec<_>>(), expected, "{text:?}");
            assert_eq!(found.notes.len(), usize::from(assumed), "{text:?}");
        }
    }

    /// Also far behind what is looked at first.
    #[test]
    fn texts_of_spreadsheets_are_read_as_they_come() {
        let rows: String = (0..40_000).map(|k| format!("{k},°,{k}\n")).collect();
        let text = format!("t_s,angle °,velocity_rad_s\n{rows}");
        let utf16 = |order: fn(u16) -> [u8; 2]| -> Vec<u8> {
            [0xfeff].into_iter().chain(text.encode_utf16()).flat_map(order).collect()
        };
        let latin: Vec<u8> = text.chars().map(|c| c as u8).collect();
        for bytes in
            [text.clone().into_bytes(), utf16(u16::to_le_bytes), utf16(u16::to_be_bytes), latin]
        {
            let points = from_text(Path::new("x.csv"), Cursor::new(bytes)).unwrap();
            let points: Vec<Point> = points.collect::<Result<_, _>>().unwrap();
            assert_eq!((points.len(), points[39_999].velocity), (40_000, 39_999.0));
        }
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
            ("t_s,v\n0,1\n", &["velocity_rad_s or velocity_m_s", "t_s, v"]),
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
