//! A table of numbers as text: its names, and its columns as finite numbers.
//!
//! How it is written is told from the text ([`Dialect`]) and can be shown. A row that is longer or
//! shorter than the header is an error: values would stand under the wrong name.

mod dialect;
mod flow;

use std::borrow::Cow;
use std::io::Cursor;
use std::path::Path;

use csv::{ReaderBuilder, StringRecord, Trim};

use self::dialect::{Plain, number, plain};
use friction_ident::statistics::upper_median;

use super::column::{Channel, axis_in};
use super::{AxisKind, ChannelSource, Column, RecordingError};

pub use dialect::{Dialect, Separator};
pub(super) use flow::Flow;

/// A column that was found: where it stands and how it is scaled.
#[derive(Debug, Clone)]
pub(super) struct Found {
    pub index: usize,
    pub source: ChannelSource,
    /// Kind of axis that its unit or its name tells.
    pub axis: Option<AxisKind>,
    /// Neither its name nor whoever named it says its unit: it is taken to be the SI unit.
    pub assumed: bool,
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
}

/// Columns that were read, all of one length.
pub(super) struct Cells {
    pub values: Vec<Vec<f64>>,
    /// Line of each row.
    pub lines: Vec<u64>,
    /// Rows that had no value somewhere.
    pub blank: usize,
}

/// A table, read up to its names.
pub(super) struct Sheet<'a> {
    path: &'a Path,
    pub names: Vec<String>,
    pub dialect: Dialect,
    /// A header that would do.
    example: &'static str,
    reader: csv::Reader<Cursor<Cow<'a, [u8]>>>,
    /// The first row, where it stands above all others.
    first: Option<StringRecord>,
}

impl<'a> Sheet<'a> {
    /// Starts reading. `example` is a header that would do.
    pub(super) fn open(
        path: &'a Path,
        bytes: &'a [u8],
        example: &'static str,
    ) -> Result<Self, RecordingError> {
        // A byte order mark, as spreadsheets write it, is no part of the first name.
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let Plain { text, dialect, names } = plain(bytes);
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
        let (names, first) = match names {
            Some(names) => (names, Some(first)),
            None if dialect.headerless => {
                ((1..=first.len()).map(|number| number.to_string()).collect(), Some(first))
            }
            None => (first.iter().map(str::to_owned).collect(), None),
        };
        Ok(Self { path, names, dialect, example, reader, first })
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
            None if self.dialect.headerless => Ok(None),
            None => channel
                .recognise(&self.names)
                .map(|name| self.find(channel, name, None))
                .transpose(),
        }
    }

    /// The column of that name, or of that number where no column is called so.
    pub(super) fn find(
        &self,
        channel: Channel,
        name: &str,
        scale: Option<f64>,
    ) -> Result<Found, RecordingError> {
        let count = self.names.iter().filter(|other| *other == name).count();
        if count > 1 {
            let (path, name) = (self.path.into(), name.to_owned());
            return Err(RecordingError::Ambiguous { path, name, count });
        }
        let by_number = || {
            let number: usize = name.parse().ok()?;
            (1..=self.names.len()).contains(&number).then(|| number - 1)
        };
        let index = self.names.iter().position(|other| other == name).or_else(by_number);
        let Some(index) = index else { return Err(self.no_column(channel, name)) };
        let called = self.names[index].clone();
        let unit = match channel.unit_in(&called) {
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
        let axis = unit.and_then(|unit| unit.quantity.axis()).or_else(|| axis_in(&called));
        let assumed = scale.is_none() && unit.is_none();
        let scale = scale.or(unit.map(|unit| unit.factor)).unwrap_or(1.0);
        Ok(Found { index, source: ChannelSource { name: called, scale }, axis, assumed })
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
        let mut read =
            Cells { values: vec![Vec::new(); wanted.len()], lines: Vec::new(), blank: 0 };
        let mut without = vec![0usize; wanted.len()];
        let mut row = vec![0.0; wanted.len()];
        let mut record = StringRecord::new();
        while self.next_row(&mut record)? {
            let line = self.line_of(&record)?;
            let mut whole = true;
            for ((value, found), without) in row.iter_mut().zip(wanted).zip(&mut without) {
                match self.number(&record, line, found, missing)? {
                    Some(number) => *value = number,
                    None => {
                        *without += 1;
                        whole = false;
                    }
                }
            }
            if whole {
                read.lines.push(line);
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

    /// Reads the next row; false behind the last one.
    fn next_row(&mut self, record: &mut StringRecord) -> Result<bool, RecordingError> {
        if let Some(first) = self.first.take() {
            *record = first;
            return Ok(true);
        }
        self.reader.read_record(record).map_err(|error| damaged(self.path, &error))
    }

    /// Its line, once it has as many fields as there are names.
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
            _ => Err(RecordingError::Cell {
                path: self.path.into(),
                line,
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
