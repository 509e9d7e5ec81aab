//! The time of the rows: in a column, in two, or at a period that was given.

use friction_ident::statistics::upper_median;

use super::separator::number;
use super::stamp;
use super::{Body, Found, Part, Rest, Sheet};
use crate::column::Channel;
use crate::units;
use crate::{ChannelSource, Column, RecordingError};

/// Longest usual step of a recording whose column of the time has no unit \[s\].
const LONGEST_STEP: f64 = 0.5;
/// Ends of the names of two columns that are one time, as ROS and C have it: whole seconds, what is
/// left of them, and what the latter counts \[ns\].
const IN_TWO: [(&str, &str, i64); 7] = [
    ("sec", "nanosec", 1),
    ("sec", "nsec", 1),
    ("secs", "nsecs", 1),
    ("secs", "nanosecs", 1),
    ("seconds", "nanoseconds", 1),
    ("sec", "usec", 1000),
    ("sec", "microsec", 1000),
];

/// Ends of the names of two columns that are one time: a date and a time of day.
const DATED: [(&str, &str); 4] =
    [("time", "date"), ("time_of_day", "date"), ("timeofday", "date"), ("clock", "date")];

impl Sheet<'_> {
    /// The column with the first part of a time that stands in two: the whole seconds, or the time
    /// of a day.
    pub(super) fn first_part(&self, channel: Channel) -> Option<usize> {
        let wanted = channel == Channel::Time && !self.dialect.headerless;
        (0..self.columns.len()).find(|index| wanted && self.other_part(*index).is_some())
    }

    /// The column with the other part of the time in this one.
    pub(super) fn other_part(&self, index: usize) -> Option<Rest> {
        self.rest_of(index).or_else(|| self.date_of(index))
    }

    /// The column with what is left of the whole seconds in this one.
    fn rest_of(&self, index: usize) -> Option<Rest> {
        let name = ended(&self.columns.get(index)?.raw);
        IN_TWO.iter().find_map(|(whole, rest, tick)| {
            let before = name.strip_suffix(whole).filter(|b| b.is_empty() || b.ends_with('_'))?;
            let other = format!("{before}{rest}");
            let index = self.columns.iter().position(|column| ended(&column.raw) == other)?;
            Some(Rest { index, part: Part::Ticks(*tick) })
        })
    }

    /// The column with the date of the time of day in this one, where the first row has both.
    fn date_of(&self, index: usize) -> Option<Rest> {
        let Body::Text { first: Some(first), .. } = &self.body else { return None };
        let name = ended(&self.columns.get(index)?.raw);
        let date = DATED.iter().find_map(|(time, date)| {
            let before = name.strip_suffix(time).filter(|b| b.is_empty() || b.ends_with('_'))?;
            let other = format!("{before}{date}");
            self.columns.iter().position(|column| ended(&column.raw) == other)
        })?;
        let (day, clock) = (first.get(date)?, first.get(index)?);
        let is_number = number(clock, self.dialect.decimal_comma).is_some();
        let both = stamp::read_dated(day, clock).is_some();
        (both && !is_number).then_some(Rest { index: date, part: Part::Date })
    }

    pub(super) fn in_two_columns(&self, index: usize, rest: Rest) -> Found {
        let (first, second) = match rest.part {
            Part::Ticks(_) => (index, rest.index),
            Part::Date => (rest.index, index),
        };
        let name = format!("{} and {}", self.names[first], self.names[second]);
        let written = match rest.part {
            Part::Ticks(_) => Some("s".to_owned()),
            Part::Date => None,
        };
        Found {
            index,
            source: ChannelSource { name, scale: 1.0 },
            axis: None,
            assumed: false,
            written,
            scaled: false,
            clock: true,
            rest: Some(rest),
            guess: None,
        }
    }

    /// The column of the time; none where the rows come at a period that was given.
    pub(in super::super) fn time(
        &self,
        named: Option<&Column>,
    ) -> Result<Option<Found>, RecordingError> {
        match (self.optional(Channel::Time, named)?, self.layout.period) {
            (Some(found), None) => Ok(Some(found)),
            (None, Some(_)) => Ok(None),
            (None, None) => self.require(Channel::Time, named).map(Some),
            (Some(found), Some(period)) => Err(RecordingError::TimeTwice {
                path: self.path.into(),
                column: found.source.name,
                period,
            }),
        }
    }

    /// Times of rows at the period that was given \[s\].
    pub(in super::super) fn periods(&self, rows: &[u64]) -> Vec<f64> {
        let period = self.layout.period.unwrap_or(f64::NAN);
        rows.iter().map(|row| *row as f64 * period).collect()
    }

    /// Whether the times that were read are dates or times of day.
    pub(in super::super) fn has_dates(&self) -> bool {
        self.values.are_dates()
    }

    /// Refuses times that are no seconds, where nothing says their unit: milliseconds, nanoseconds
    /// since the epoch, or the number of the sample.
    pub(in super::super) fn check_seconds(
        &self,
        found: &Found,
        time: &[f64],
    ) -> Result<(), RecordingError> {
        let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let told = !found.assumed || self.values.are_stamps();
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
}

/// A name in small letters, whatever stands between its words: `/stamp/sec` is `_stamp_sec`.
fn ended(name: &str) -> String {
    let parts = units::parts(name);
    let bare = if parts.bracketed { parts.stem } else { name };
    let plain = |c: char| if c.is_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
    bare.trim().chars().map(plain).collect()
}
