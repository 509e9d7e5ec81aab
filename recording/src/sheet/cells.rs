//! The rows of a table: their cells as numbers, in SI units.

use csv::StringRecord;

use super::dialect::{Separator, number};
use super::{Body, Cells, Clock, Found, Missing, Sheet, damaged, stamp};
use crate::RecordingError;

impl Sheet<'_> {
    /// Reads the columns of all rows; one row at least.
    pub(in super::super) fn columns(
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
                    None => loop {
                        let read = reader.read_record(record);
                        if !read.map_err(|error| damaged(self.path, &error))? {
                            return Ok(None);
                        }
                        if self.names.len() < 2 || !is_blank(record) {
                            break;
                        }
                    },
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
    pub(in super::super) fn place(&self, line: u64) -> String {
        self.dialect.place(line)
    }

    /// The line of a row of text, once it has as many fields as there are names.
    fn line_of(&self, record: &StringRecord) -> Result<u64, RecordingError> {
        let line = record.position().map_or(0, csv::Position::line);
        let (fields, names) = (record.len(), self.names.len());
        if fields == names {
            return Ok(line);
        }
        let names_below = record.iter().all(|cell| number(cell, false).is_none());
        let commas = if fields > names && names_below {
            "; if it has the names of the columns, begin each line above it with #"
        } else if fields > names && self.dialect.separator == Separator::Comma {
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
            _ => Err(self.no_number(line, found, &written.to_string())),
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
        let read = number(cell, self.dialect.decimal_comma);
        let read = if found.clock {
            self.time_of(cell, read, found.source.scale)
        } else {
            read.map(|value| value * found.source.scale)
        };
        match read {
            Some(value) if value.is_finite() => Ok(Some(value)),
            _ if missing == Missing::LeftOut && is_missing(cell) => Ok(None),
            _ if missing == Missing::AsNan => Ok(Some(f64::NAN)),
            _ => Err(self.no_number(line, found, cell)),
        }
    }

    /// The time in a cell \[s\], as a number or from the first date and time of day. A column is
    /// written one way from its beginning to its end.
    fn time_of(&self, cell: &str, number: Option<f64>, scale: f64) -> Option<f64> {
        let stamp = || stamp::nanoseconds(cell, self.dialect.decimal_comma);
        match (self.clock.get(), number) {
            (Clock::Unread | Clock::Numbers, Some(value)) => {
                if value.is_finite() {
                    self.clock.set(Clock::Numbers);
                }
                Some(value * scale)
            }
            (Clock::Unread, None) => {
                self.clock.set(Clock::Stamps(stamp()?));
                Some(0.0)
            }
            (Clock::Stamps(first), None) => Some(stamp()?.wrapping_sub(first) as f64 * 1e-9),
            (Clock::Numbers, None) | (Clock::Stamps(_), Some(_)) => None,
        }
    }

    fn no_number(&self, line: u64, found: &Found, cell: &str) -> RecordingError {
        RecordingError::Cell {
            path: self.path.into(),
            place: self.place(line),
            column: found.source.name.clone(),
            expected: if found.clock && matches!(self.body, Body::Text { .. }) {
                "a finite number or a time such as 2024-03-01T12:00:00.001"
            } else {
                "a finite number"
            },
            found: cell.to_owned(),
        }
    }
}

/// Whether a row has nothing but blanks in it.
pub(super) fn is_blank(record: &StringRecord) -> bool {
    record.len() == 1 && record.get(0).is_some_and(str::is_empty)
}

/// What people and programs write where there is no value.
fn is_missing(cell: &str) -> bool {
    ["", "nan", "-nan", "na", "n/a", "#n/a", "null", "none", "-"]
        .iter()
        .any(|word| cell.eq_ignore_ascii_case(word))
}
