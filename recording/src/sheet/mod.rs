//! A table of numbers as text: its names, and its columns as finite numbers.
//!
//! How it is written is told from the text ([`Dialect`]) and can be shown. A row that is longer or
//! shorter than the header is an error: values would stand under the wrong name.

mod dialect;
mod flow;
mod load;
mod named;
#[cfg(test)]
mod tests;
mod unit_row;

use std::borrow::Cow;
use std::io::Cursor;
use std::path::Path;

use csv::{ReaderBuilder, StringRecord, Trim};

use self::dialect::{Plain, number, plain};
use friction_ident::statistics::upper_median;

use super::column::{Channel, axis_in};
use super::grid::Grid;
use super::layout::Layout;
use super::{AxisKind, ChannelSource, Column, RecordingError};
use named::Named;

pub use dialect::{Dialect, Separator};
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
            Loaded::Text(bytes) => Self::text(path, bytes, layout, example)?,
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
            None => (first.iter().map(str::to_owned).collect::<Vec<_>>(), None),
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
        Ok(Self { path, names, columns, dialect, example, body, layout: layout.clone() })
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
                    let (path, name) = (self.path.into(), name.to_owned());
                    return Err(RecordingError::Ambiguous { path, name, count });
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
            let (path, name, count) = (self.path.into(), name.to_owned(), called.len());
            return Err(RecordingError::Ambiguous { path, name, count });
        }
        let by_number = || {
            let number: usize = name.parse().ok()?;
            (1..=self.names.len()).contains(&number).then(|| number - 1)
        };
        let index = called.first().copied().or_else(by_number);
        let Some(index) = index else { return Err(self.no_column(channel, name)) };
        self.found(channel, index, scale)
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
        let assumed = scale.is_none() && unit.is_none();
        let scale = scale.or(unit.map(|unit| unit.factor)).unwrap_or(1.0);
        let written = unit.and(super::units::parts(stem).unit).map(str::to_owned);
        Ok(Found { index, source: ChannelSource { name: called, scale }, axis, assumed, written })
    }

    /// A column as it is written.
    fn raw(&self, index: usize) -> Found {
        let source = ChannelSource { name: self.names[index].clone(), scale: 1.0 };
        Found { index, source, axis: None, assumed: true, written: None }
    }

    /// What was left out of the file, with why.
    pub(super) fn left_out(&self) -> &[String] {
        match self.body {
            Body::Grid(grid) => &grid.left_out,
            Body::Text { .. } => &[],
        }
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
        let usual = upper_median(&mut steps).filter(|step| found.assumed && *step > LONGEST_STEP);
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
        RecordingError::Unrecognised {
            path: self.path.into(),
            channel,
            present: self.names.join(", "),
        }
    }

    /// Reads the columns of all rows; one row at least.
    pub(super) fn columns(
        &mut self,
        wanted: &[&Found],
        missing: Missing,
    ) -> Result<Cells, RecordingError> {
        let mut read = Cells {
            values: vec![Vec::new(); wanted.len()],
            lines: Vec::new(),
            rows: Vec::new(),
            blank: 0,
        };
        let mut without = vec![0usize; wanted.len()];
        let mut row = vec![0.0; wanted.len()];
        let mut record = StringRecord::new();
        for count in 0.. {
            let Some(line) = self.next_row(&mut record, count)? else { break };
            let mut whole = true;
            for ((value, found), without) in row.iter_mut().zip(wanted).zip(&mut without) {
                match self.value(&record, line, count, found, missing)? {
                    Some(number) => *value = number,
                    None => {
                        *without += 1;
                        whole = false;
                    }
                }
            }
            if whole {
                read.lines.push(line);
                read.rows.push(count);
                read.values.iter_mut().zip(&row).for_each(|(column, value)| column.push(*value));
            } else {
                read.blank += 1;
            }
        }
        let rows = read.lines.len() + read.blank;
        if rows == 0 {
            return Err(RecordingError::HeaderOnly { path: self.path.into() });
        }
        if read.lines.is_empty() {
            let fullest = |(found, without): (&&Found, &usize)| {
                (*without == rows).then(|| found.source.name.clone())
            };
            let column = wanted.iter().zip(&without).find_map(fullest);
            return Err(RecordingError::NoValues { path: self.path.into(), column, rows });
        }
        Ok(read)
    }

    /// Reads the next row, and tells its line; none behind the last one.
    fn next_row(
        &mut self,
        record: &mut StringRecord,
        count: u64,
    ) -> Result<Option<u64>, RecordingError> {
        match &mut self.body {
            Body::Text { reader, first } => {
                match first.take() {
                    Some(first) => *record = first,
                    None => {
                        if !reader
                            .read_record(record)
                            .map_err(|error| damaged(self.path, &error))?
                        {
                            return Ok(None);
                        }
                    }
                }
                self.line_of(record).map(Some)
            }
            Body::Grid(grid) => {
                let rows = grid.columns.first().map_or(0, |column| column.values.len());
                Ok((count < rows as u64).then_some(count + 1))
            }
        }
    }

    /// Where a line stands, in words.
    pub(super) fn place(&self, line: u64) -> String {
        self.dialect.place(line)
    }

    /// The line of a row of text, once it has as many fields as there are names.
    fn line_of(&self, record: &StringRecord) -> Result<u64, RecordingError> {
        let line = record.position().map_or(0, csv::Position::line);
        let (fields, names) = (record.len(), self.names.len());
        if fields == names {
            return Ok(line);
        }
        let commas = if fields > names && self.dialect.separator == Separator::Comma {
            "; where decimals are written with a comma, columns must be separated by semicolons or tabs"
        } else {
            ""
        };
        let what = if self.dialect.headerless { "first row" } else { "header" };
        let detail = format!("it has {fields} fields where the {what} has {names}{commas}");
        Err(RecordingError::Line { path: self.path.into(), line, detail })
    }

    /// The value of a cell in SI units; none where there is none.
    fn value(
        &self,
        record: &StringRecord,
        line: u64,
        row: u64,
        found: &Found,
        missing: Missing,
    ) -> Result<Option<f64>, RecordingError> {
        let Body::Grid(grid) = self.body else {
            return self.number(record, line, found, missing);
        };
        let column = grid.columns.get(found.index).map(|column| &column.values);
        let written = usize::try_from(row).ok().and_then(|row| column?.get(row).copied());
        let written = written.unwrap_or(f64::NAN);
        match written * found.source.scale {
            value if value.is_finite() => Ok(Some(value)),
            value if value.is_nan() && missing == Missing::LeftOut => Ok(None),
            _ => Err(RecordingError::Cell {
                path: self.path.into(),
                place: self.place(line),
                column: found.source.name.clone(),
                found: written.to_string(),
            }),
        }
    }

    /// The value of a cell in SI units; none where there is none.
    fn number(
        &self,
        record: &StringRecord,
        line: u64,
        found: &Found,
        missing: Missing,
    ) -> Result<Option<f64>, RecordingError> {
        let cell = record.get(found.index).unwrap_or_default();
        match number(cell, self.dialect.decimal_comma).map(|value| value * found.source.scale) {
            Some(value) if value.is_finite() => Ok(Some(value)),
            _ if missing == Missing::LeftOut && is_missing(cell) => Ok(None),
            _ if missing == Missing::AsNan => Ok(Some(f64::NAN)),
            _ => Err(RecordingError::Cell {
                path: self.path.into(),
                place: self.place(line),
                column: found.source.name.clone(),
                found: cell.to_owned(),
            }),
        }
    }
}

/// What people and programs write where there is no value.
fn is_missing(cell: &str) -> bool {
    ["", "nan", "-nan", "na", "n/a", "null", "none", "-"]
        .iter()
        .any(|word| cell.eq_ignore_ascii_case(word))
}

fn damaged(path: &Path, error: &csv::Error) -> RecordingError {
    let line = error.position().map_or(1, csv::Position::line);
    let detail = match error.kind() {
        csv::ErrorKind::Utf8 { .. } => "it is not UTF-8 text".to_owned(),
        _ => error.to_string(),
    };
    RecordingError::Line { path: path.into(), line, detail }
}
