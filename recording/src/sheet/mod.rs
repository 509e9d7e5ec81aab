//! A table of numbers as text: its names, and its columns as finite numbers.
//!
//! How it is written is told from the text ([`Dialect`]) and can be shown. A row that is longer or
//! shorter than the header is an error: values would stand under the wrong name.

mod cells;
mod dialect;
mod encoding;
mod flow;
mod load;
mod named;
mod stamp;
#[cfg(test)]
mod tests;
mod unit_row;

use std::borrow::Cow;
use std::cell::Cell;
use std::io::Cursor;
use std::path::Path;

use csv::{ReaderBuilder, StringRecord, Trim};

use self::dialect::{Plain, plain};
use friction_ident::statistics::upper_median;

use super::column::{Channel, axis_in};
use super::grid::Grid;
use super::layout::Layout;
use super::{AxisKind, ChannelSource, Column, RecordingError};
use named::Named;

pub use dialect::{Dialect, Separator};
pub use encoding::Encoding;
pub(super) use flow::Flow;
pub(super) use load::{Loaded, has_tables, load};

/// A column that was found: where it stands and how it is scaled.
#[derive(Debug, Clone)]
pub(super) struct Found {
    pub index: usize,
    pub source: ChannelSource,
    /// Kind of axis that its unit or its name tells.
    pub axis: Option<AxisKind>,
    /// Neither its name nor whoever named it says its unit: it is taken to be the SI unit.
    pub assumed: bool,
    /// The unit as its name has it.
    pub written: Option<String>,
    /// Whoever named it gave the factor.
    pub scaled: bool,
    /// It holds the time, which may be written as a date and a time of day.
    pub clock: bool,
}

/// Longest usual step of a recording whose column of the time has no unit \[s\].
const LONGEST_STEP: f64 = 0.5;

/// What becomes of a row that has no value for a column that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Missing {
    /// It is left out, and counted.
    LeftOut,
    /// It is an error.
    Refused,
    /// It is NaN, and so is what is no number.
    AsNan,
}

/// Columns that were read, all of one length.
pub(super) struct Cells {
    pub values: Vec<Vec<f64>>,
    /// Line of each row.
    pub lines: Vec<u64>,
    /// Number of each row, from 0, those that were left out counted.
    pub rows: Vec<u64>,
    /// Rows that had no value somewhere.
    pub blank: usize,
}

/// A table, read up to its names.
pub(super) struct Sheet<'a> {
    path: &'a Path,
    /// Names of the columns as a person gives them.
    pub names: Vec<String>,
    columns: Vec<Named>,
    pub dialect: Dialect,
    /// A header that would do.
    example: &'static str,
    body: Body<'a>,
    layout: Layout,
    /// How the times that were read are written.
    clock: Cell<Clock>,
}

/// How times are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Clock {
    /// None was read.
    Unread,
    /// As numbers.
    Numbers,
    /// As dates or times of day; the first one \[ns\].
    Stamps(i64),
}

/// What stands below the names.
enum Body<'a> {
    Text {
        reader: Box<csv::Reader<Cursor<Cow<'a, [u8]>>>>,
        /// The first row, where it stands above all others.
        first: Option<StringRecord>,
    },
    Grid(&'a Grid),
}

impl<'a> Sheet<'a> {
    /// Starts reading. `example` is a header that would do.
    pub(super) fn open(
        path: &'a Path,
        loaded: &'a Loaded<'a>,
        layout: &Layout,
        example: &'static str,
    ) -> Result<Self, RecordingError> {
        let sheet = match loaded {
            Loaded::Text(bytes, encoding) => {
                let mut sheet = Self::text(path, bytes, layout, example)?;
                sheet.dialect.encoding = *encoding;
                sheet
            }
            Loaded::Grid(grid) => {
                let columns: Vec<Named> = Named::of_grid(&grid.columns);
                Self {
                    path,
                    names: columns.iter().map(Named::full).collect(),
                    columns,
                    dialect: Dialect::of_grid(grid.form),
                    example,
                    body: Body::Grid(grid),
                    layout: layout.clone(),
                    clock: Cell::new(Clock::Unread),
                }
            }
        };
        let joints = sheet.joints();
        match &layout.joint {
            Some(joint) if !joints.contains(joint) => {
                let present = if joints.is_empty() {
                    "none, as no column is called q[2] or q2".to_owned()
                } else {
                    joints.join(", ")
                };
                Err(RecordingError::NoJoint { path: path.into(), name: joint.clone(), present })
            }
            _ => Ok(sheet),
        }
    }

    fn text(
        path: &'a Path,
        bytes: &'a [u8],
        layout: &Layout,
        example: &'static str,
    ) -> Result<Self, RecordingError> {
        // A byte order mark, as spreadsheets write it, is no part of the first name.
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let Plain { text, mut dialect, names } = plain(bytes);
        if text.iter().all(u8::is_ascii_whitespace) {
            return Err(RecordingError::Empty { path: path.into() });
        }
        let mut reader = ReaderBuilder::new()
            .delimiter(dialect.separator.byte())
            .trim(Trim::All)
            .has_headers(false)
            .flexible(true)
            .from_reader(Cursor::new(text));
        let mut first = StringRecord::new();
        reader.read_record(&mut first).map_err(|error| damaged(path, &error))?;
        let (names, mut first) = match names {
            Some(names) => (names, Some(first)),
            None if dialect.headerless => {
                ((1..=first.len()).map(|number| number.to_string()).collect(), Some(first))
            }
            None => {
                let name = |(index, name): (usize, &str)| match name {
                    "" => (index + 1).to_string(),
                    name => name.to_owned(),
                };
                (first.iter().enumerate().map(name).collect::<Vec<_>>(), None)
            }
        };
        let mut units = None;
        if first.is_none() {
            let mut second = StringRecord::new();
            if reader.read_record(&mut second).map_err(|error| damaged(path, &error))? {
                units = unit_row::units(&names, &second);
                first = units.is_none().then_some(second);
            }
        }
        dialect.units_below = units.is_some();
        let columns = Named::of_text(&names, units.as_deref(), layout.joint.is_some());
        let names = columns.iter().map(Named::full).collect();
        let body = Body::Text { reader: Box::new(reader), first };
        let (layout, clock) = (layout.clone(), Cell::new(Clock::Unread));
        Ok(Self { path, names, columns, dialect, example, body, layout, clock })
    }

    /// The column of a channel, which must be there.
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
        match named {
            Some(column) => self.find(channel, &column.name, column.scale).map(Some),
            None => match self.recognised(channel)? {
                Some(index) => self.found(channel, index, None).map(Some),
                None => Ok(None),
            },
        }
    }

    /// Whether a channel is named or recognised.
    pub(super) fn has(&self, channel: Channel, named: Option<&Column>) -> bool {
        named.is_some() || !matches!(self.recognised(channel), Ok(None))
    }

    /// The joints that columns stand for, in their order.
    pub(super) fn joints(&self) -> Vec<String> {
        let mut labels: Vec<String> = Vec::new();
        for label in self.columns.iter().filter_map(|column| column.label.as_ref()) {
            if !labels.contains(label) {
                labels.push(label.clone());
            }
        }
        labels
    }

    /// The column that is recognised, of the joint that was chosen or of the only one.
    fn recognised(&self, channel: Channel) -> Result<Option<usize>, RecordingError> {
        if self.dialect.headerless {
            return Ok(None);
        }
        let joints = self.joints();
        let joint = self.layout.joint.as_ref().or(joints.first().filter(|_| joints.len() == 1));
        let of =
            |wanted: &dyn Fn(Option<&String>) -> bool| -> Result<Option<usize>, RecordingError> {
                let (indices, stems): (Vec<usize>, Vec<String>) = self
                    .columns
                    .iter()
                    .enumerate()
                    .filter(|(_, column)| wanted(column.label.as_ref()))
                    .map(|(index, column)| (index, column.stem.clone()))
                    .unzip();
                let Some(name) = channel.recognise(&stems) else { return Ok(None) };
                let same = || indices.iter().zip(&stems).filter(|(_, stem)| *stem == name);
                let count = same().count();
                if count > 1 {
                    return Err(self.ambiguous(name, &same().map(|(k, _)| *k).collect::<Vec<_>>()));
                }
                Ok(same().map(|(index, _)| *index).next())
            };
        // A chosen joint's own column before one of all; where none was chosen the other way round.
        let of_joint = |label: Option<&String>| label.is_some() && label == joint;
        let chosen = if self.layout.joint.is_some() { of(&of_joint)? } else { None };
        if let Some(index) = chosen {
            return Ok(Some(index));
        }
        if let Some(index) = of(&|label| label.is_none())? {
            return Ok(Some(index));
        }
        if let Some(index) = of(&of_joint)? {
            return Ok(Some(index));
        }
        let one_of_several = |label: &str| {
            of(&|other| other.is_some_and(|other| other == label))
                .is_ok_and(|found| found.is_some())
        };
        if joint.is_none() && joints.iter().any(|label| one_of_several(label)) {
            let (path, present) = (self.path.into(), joints.join(", "));
            return Err(RecordingError::SeveralJoints { path, present });
        }
        Ok(None)
    }

    /// The column of that name, or of that number where no column is called so.
    pub(super) fn find(
        &self,
        channel: Channel,
        name: &str,
        scale: Option<f64>,
    ) -> Result<Found, RecordingError> {
        let joint = self.layout.joint.as_deref();
        let full = |column: &Named| column.full() == name || column.raw == name;
        let of_joint = |column: &Named| {
            column.bare() == name && column.label.is_some() && column.label.as_deref() == joint
        };
        let mut called: Vec<usize> = self.places(&of_joint);
        if called.is_empty() {
            called = self.places(&full);
        }
        if called.len() > 1 {
            return Err(self.ambiguous(name, &called));
        }
        let by_number = || {
            let number: usize = name.parse().ok()?;
            (1..=self.names.len()).contains(&number).then(|| number - 1)
        };
        let index = called.first().copied().or_else(by_number);
        let Some(index) = index else { return Err(self.no_column(channel, name)) };
        self.found(channel, index, scale)
    }

    /// The error of several columns with one name. They are told apart by what the file calls them,
    /// else by their numbers.
    fn ambiguous(&self, name: &str, places: &[usize]) -> RecordingError {
        let full: Vec<&str> = places.iter().map(|&k| self.columns[k].raw.as_str()).collect();
        let apart = full.iter().enumerate().all(|(k, one)| !full[..k].contains(one));
        let present = if apart {
            full.join(", ")
        } else {
            let numbers: Vec<String> = places.iter().map(|k| (k + 1).to_string()).collect();
            format!("number {}, counted from 1", numbers.join(" and "))
        };
        RecordingError::Ambiguous {
            path: self.path.into(),
            name: name.to_owned(),
            count: places.len(),
            present,
        }
    }

    fn places(&self, is: &dyn Fn(&Named) -> bool) -> Vec<usize> {
        self.columns.iter().enumerate().filter(|(_, column)| is(column)).map(|(k, _)| k).collect()
    }

    /// What a column holds.
    fn found(
        &self,
        channel: Channel,
        index: usize,
        scale: Option<f64>,
    ) -> Result<Found, RecordingError> {
        let (called, stem) = (self.names[index].clone(), &self.columns[index].stem);
        let unit = match channel.unit_in(stem) {
            Ok(unit) => unit,
            // Whoever gives a scale knows the unit.
            Err(_) if scale.is_some() => None,
            Err(source) => {
                return Err(RecordingError::Unit {
                    path: self.path.into(),
                    column: called,
                    source,
                });
            }
        };
        let axis = unit.and_then(|unit| unit.quantity.axis()).or_else(|| axis_in(stem));
        let (assumed, scaled) = (scale.is_none() && unit.is_none(), scale.is_some());
        let scale = scale.or(unit.map(|unit| unit.factor)).unwrap_or(1.0);
        let written = unit.and(super::units::parts(stem).unit).map(str::to_owned);
        let (source, clock) = (ChannelSource { name: called, scale }, channel == Channel::Time);
        Ok(Found { index, source, axis, assumed, written, scaled, clock })
    }

    /// A column as it is written.
    fn raw(&self, index: usize) -> Found {
        let source = ChannelSource { name: self.names[index].clone(), scale: 1.0 };
        let stem = self.columns[index].stem.clone();
        let clock = Channel::Time.recognise(&[stem]).is_some();
        Found { index, source, axis: None, assumed: true, written: None, scaled: false, clock }
    }

    /// What was left out of the file, with why.
    pub(super) fn left_out(&self) -> &[String] {
        match self.body {
            Body::Grid(grid) => &grid.left_out,
            Body::Text { .. } => &[],
        }
    }

    /// Refuses a motion along a line beside a torque, and a turn beside a force, where both say
    /// their unit: what comes of that has the unit of neither.
    pub(super) fn check_axis(&self, motion: &Found, force: &Found) -> Result<(), RecordingError> {
        let said = |found: &Found| found.axis.filter(|_| found.written.is_some() && !found.scaled);
        let (Some(one), Some(other)) = (said(motion), said(force)) else { return Ok(()) };
        if one == other {
            return Ok(());
        }
        Err(RecordingError::TwoAxes {
            path: self.path.into(),
            motion: motion.source.name.clone(),
            force: force.source.name.clone(),
            unit: one.force_unit(),
        })
    }

    /// The column of the time; none where the rows come at a period that was given.
    pub(super) fn time(&self, named: Option<&Column>) -> Result<Option<Found>, RecordingError> {
        match (self.optional(Channel::Time, named)?, self.layout.period) {
            (Some(found), None) => Ok(Some(found)),
            (None, Some(_)) => Ok(None),
            (None, None) => Err(self.unrecognised(Channel::Time)),
            (Some(found), Some(period)) => Err(RecordingError::TimeTwice {
                path: self.path.into(),
                column: found.source.name,
                period,
            }),
        }
    }

    /// Times of rows at the period that was given \[s\].
    pub(super) fn periods(&self, rows: &[u64]) -> Vec<f64> {
        let period = self.layout.period.unwrap_or(f64::NAN);
        rows.iter().map(|row| *row as f64 * period).collect()
    }

    /// Refuses times that are no seconds, where nothing says their unit: milliseconds, nanoseconds
    /// since the epoch, or the number of the sample.
    pub(super) fn check_seconds(&self, found: &Found, time: &[f64]) -> Result<(), RecordingError> {
        let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let told = !found.assumed || matches!(self.clock.get(), Clock::Stamps(_));
        let usual = upper_median(&mut steps).filter(|step| !told && *step > LONGEST_STEP);
        let Some(step) = usual else { return Ok(()) };
        let scale = [1e-3, 1e-6].into_iter().find(|scale| step * scale <= LONGEST_STEP);
        Err(RecordingError::TimeUnit {
            path: self.path.into(),
            column: found.source.name.clone(),
            step,
            scale: scale.unwrap_or(1e-9),
        })
    }

    fn no_column(&self, channel: Channel, name: &str) -> RecordingError {
        if self.dialect.headerless && name.parse::<usize>().is_err() {
            return self.no_header();
        }
        RecordingError::NoColumn {
            path: self.path.into(),
            name: name.to_owned(),
            present: self.names.join(", "),
            channel,
        }
    }

    pub(super) fn no_header(&self) -> RecordingError {
        RecordingError::NoHeader {
            path: self.path.into(),
            example: self.example,
            columns: self.names.len(),
        }
    }

    pub(super) fn unrecognised(&self, channel: Channel) -> RecordingError {
        if self.dialect.headerless {
            return self.no_header();
        }
        RecordingError::Unrecognised { path: self.path.into(), channel, present: self.present() }
    }

    /// The names of the columns, and what of the file is none.
    fn present(&self) -> String {
        /// What is told of it at most.
        const TOLD: usize = 3;
        let names = self.names.join(", ");
        match self.left_out() {
            [] => names,
            left_out => {
                let told: Vec<&str> = left_out.iter().take(TOLD).map(String::as_str).collect();
                format!("{names} ({})", told.join("; "))
            }
        }
    }
}

fn damaged(path: &Path, error: &csv::Error) -> RecordingError {
    let line = error.position().map_or(1, csv::Position::line);
    let detail = match error.kind() {
        csv::ErrorKind::Utf8 { .. } => "it is not UTF-8 text".to_owned(),
        _ => error.to_string(),
    };
    RecordingError::Line { path: path.into(), line, detail }
}
