//! A table of numbers as text: its names, and its columns as finite numbers.
//!
//! How it is written is told from the text ([`Dialect`]) and can be shown. A row that is longer or
//! shorter than the header is an error: values would stand under the wrong name.

mod cells;
mod decoding;
mod dialect;
mod encoding;
mod find;
mod flow;
mod guessed;
mod load;
mod named;
mod preamble;
mod refusals;
mod separator;
mod stamp;
#[cfg(test)]
mod tests;
mod time;
mod unit_row;
mod value;
mod words;

use std::borrow::Cow;
use std::io::Cursor;
use std::path::Path;

use csv::{ReaderBuilder, StringRecord, Trim};

use super::grid::Grid;
use super::layout::Layout;
use super::{AxisKind, ChannelSource, RecordingError};
use dialect::{Plain, plain};
use named::Named;
use refusals::damaged;
use value::Values;

pub(super) use decoding::Decoding;
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
    /// The column with the other part of a time that stands in two.
    pub rest: Option<Rest>,
    /// Why it was taken, where its name does not say so plainly.
    pub guess: Option<Guess>,
}

/// Why a column was taken that does not say plainly what it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Guess {
    /// It is the only one in such a unit.
    ByUnit,
    /// It was commanded or wanted, and nothing else was there.
    Commanded,
}

/// A column with the other part of a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Rest {
    pub index: usize,
    pub part: Part,
}

/// Which part of a time it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    /// What is left of whole seconds, in ticks of so long \[ns\].
    Ticks(i64),
    /// The date of a time of day.
    Date,
}

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
    /// What cells are worth.
    values: Values,
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
                    values: Values::new(false),
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
        let (layout, values) = (layout.clone(), Values::new(dialect.decimal_comma));
        Ok(Self { path, names, columns, dialect, example, body, layout, values })
    }

    /// What was left out of the file, with why.
    pub(super) fn left_out(&self) -> &[String] {
        match self.body {
            Body::Grid(grid) => &grid.left_out,
            Body::Text { .. } => &[],
        }
    }
}
