//! Rows of a text table as they come: nothing but the row at hand stands in memory.

use std::io::{self, BufRead, Read};
use std::path::PathBuf;

use csv::{ReaderBuilder, StringRecord, Trim};

use super::Found;
use super::cells::is_blank;
use super::dialect::{Dialect, Separator, is_remark, tabbed_line};
use super::refusals::damaged;
use super::value::Values;
use crate::RecordingError;

/// A table whose columns are known.
pub(crate) struct Flow {
    path: PathBuf,
    values: Values,
    /// Columns of each row.
    fields: usize,
    wanted: Vec<Found>,
    reader: csv::Reader<PlainLines>,
    record: StringRecord,
    /// Rows of the table so far.
    rows: u64,
    /// The next row holds units.
    units: bool,
}

impl Flow {
    /// The rows below the header, of which `fields` columns are known. `text` begins with the
    /// header.
    pub fn new(
        path: PathBuf,
        text: Box<dyn BufRead>,
        dialect: Dialect,
        fields: usize,
        wanted: Vec<Found>,
    ) -> Self {
        let blanks = dialect.separator == Separator::Blanks;
        let above = dialect.above;
        let lines = PlainLines { text, blanks, above, line: Vec::new(), given: 0 };
        let reader = ReaderBuilder::new()
            .delimiter(dialect.separator.byte())
            .trim(Trim::All)
            .has_headers(!(dialect.headerless || dialect.names_in_remark))
            .flexible(true)
            .from_reader(lines);
        let record = StringRecord::new();
        let units = dialect.units_below;
        let values = Values::new(dialect.decimal_comma);
        Self { path, values, fields, wanted, reader, record, rows: 0, units }
    }

    /// The line of the next row; its values of the wanted columns go into `row`, in SI units.
    /// None behind the last one.
    pub fn next(&mut self, row: &mut [f64]) -> Result<Option<u64>, RecordingError> {
        let mut read = self.reader.read_record(&mut self.record);
        if std::mem::take(&mut self.units) {
            read = self.reader.read_record(&mut self.record);
        }
        while matches!(read, Ok(true)) && self.fields > 1 && is_blank(&self.record) {
            read = self.reader.read_record(&mut self.record);
        }
        if !read.map_err(|error| self.broken(&error))? {
            let path = self.path.clone();
            return if self.rows == 0 {
                Err(RecordingError::HeaderOnly { path })
            } else {
                Ok(None)
            };
        }
        self.rows += 1;
        let line = self.record.position().map_or(0, csv::Position::line);
        let (fields, names) = (self.record.len(), self.fields);
        if fields != names {
            let detail = format!("it has {fields} fields where the header has {names}");
            return Err(RecordingError::Line { path: self.path.clone(), line, detail });
        }
        for (value, found) in row.iter_mut().zip(&self.wanted) {
            *value = self.values.of(&self.record, found).ok_or_else(|| RecordingError::Cell {
                path: self.path.clone(),
                place: format!("line {line}"),
                column: found.source.name.clone(),
                expected: self.values.expected(found),
                found: self.record.get(found.index).unwrap_or_default().to_owned(),
            })?;
        }
        Ok(Some(line))
    }

    /// Bytes of the table that the rows so far took.
    pub fn bytes(&self) -> u64 {
        self.reader.position().byte()
    }

    fn broken(&self, error: &csv::Error) -> RecordingError {
        match error.kind() {
            csv::ErrorKind::Io(error) => RecordingError::Read {
                path: self.path.clone(),
                source: io::Error::new(error.kind(), error.to_string()),
            },
            _ => damaged(&self.path, error),
        }
    }
}

/// Lines without remarks, which become empty ones so that the others keep their numbers.
struct PlainLines {
    text: Box<dyn BufRead>,
    /// Columns are separated by blanks: by one tab then.
    blanks: bool,
    /// Lines that are still to come above the names.
    above: usize,
    line: Vec<u8>,
    given: usize,
}

/// Longest line \[bytes\]: what has no end of line is no table, and must not fill the memory.
pub(super) const LONGEST_LINE: u64 = 1 << 20;

impl PlainLines {
    fn next_line(&mut self) -> io::Result<()> {
        self.given = 0;
        self.line.clear();
        (&mut self.text).take(LONGEST_LINE).read_until(b'\n', &mut self.line)?;
        if self.line.len() as u64 == LONGEST_LINE {
            let what = format!("a line is longer than {LONGEST_LINE} bytes");
            return Err(io::Error::new(io::ErrorKind::InvalidData, what));
        }
        let above = self.above > 0 && !self.line.is_empty();
        self.above = self.above.saturating_sub(1);
        if above || is_remark(&self.line) {
            self.line.clear();
            self.line.push(b'\n');
        } else if self.blanks {
            let mut line = tabbed_line(&self.line);
            if !self.line.is_empty() {
                line.push(b'\n');
            }
            self.line = line;
        }
        Ok(())
    }
}

impl Read for PlainLines {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if self.given == self.line.len() {
            self.next_line()?;
        }
        let rest = self.line.get(self.given..).unwrap_or_default();
        let count = rest.len().min(into.len());
        if let (Some(into), Some(rest)) = (into.get_mut(..count), rest.get(..count)) {
            into.copy_from_slice(rest);
        }
        self.given += count;
        Ok(count)
    }
}
