//! The rows of a table: their cells as numbers, in SI units.

use csv::StringRecord;

use super::refusals::damaged;
use super::separator::{Separator, number};
use super::{Body, Cells, Found, Missing, Part, Rest, Sheet};
use crate::RecordingError;

impl Sheet<'_> {
    /// Reads the columns of all rows; one row at least.
    pub(in super::super) fn columns(
        &mut self,
        wanted: &[&Found],
        missing: Missing,
    ) -> Result<Cells, RecordingError> {
        self.columns_beside(wanted, missing, &[])
    }

    /// The same with other columns behind them, which take no row away: what is no number in them
    /// is NaN.
    pub(in super::super) fn columns_beside(
        &mut self,
        wanted: &[&Found],
        missing: Missing,
        beside: &[&Found],
    ) -> Result<Cells, RecordingError> {
        let needed = wanted.len();
        let wanted = &[wanted, beside].concat()[..];
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
            let cells = row.iter_mut().zip(wanted).zip(&mut without).enumerate();
            for (index, ((value, found), without)) in cells {
                let missing = if index < needed { missing } else { Missing::AsNan };
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
        let at = |index: usize| {
            let row = usize::try_from(row).ok()?;
            grid.columns.get(index)?.values.get(row).copied()
        };
        let written = at(found.index).unwrap_or(f64::NAN);
        let value = match found.rest {
            Some(Rest { index, part: Part::Ticks(tick) }) => {
                let left = at(index).unwrap_or(f64::NAN);
                self.values.joined(written, left, tick).unwrap_or(f64::NAN)
            }
            // A grid of numbers has no times of day.
            Some(Rest { part: Part::Date, .. }) => f64::NAN,
            None => written * found.source.scale,
        };
        match value {
            value if value.is_finite() => Ok(Some(value)),
            value if value.is_nan() && missing == Missing::LeftOut => Ok(None),
            _ if missing == Missing::AsNan => Ok(Some(f64::NAN)),
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
        match self.values.of(record, found) {
            Some(value) => Ok(Some(value)),
            None => {
                let cells = [Some(found.index), found.rest.map(|rest| rest.index)];
                let mut cells =
                    cells.into_iter().flatten().map(|index| record.get(index).unwrap_or_default());
                let cell = cells.clone().next().unwrap_or_default();
                match missing {
                    Missing::LeftOut if cells.any(is_missing) => Ok(None),
                    Missing::AsNan => Ok(Some(f64::NAN)),
                    _ => Err(self.no_number(line, found, cell)),
                }
            }
        }
    }

    fn no_number(&self, line: u64, found: &Found, cell: &str) -> RecordingError {
        RecordingError::Cell {
            path: self.path.into(),
            place: self.place(line),
            column: found.source.name.clone(),
            expected: match self.body {
                Body::Text { .. } => self.values.expected(found),
                Body::Grid(_) => "a finite number",
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
