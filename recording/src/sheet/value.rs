//! What a cell of a text is worth in SI units.

use std::cell::Cell;

use csv::StringRecord;

use super::separator::number;
use super::stamp::{self, Stamp};
use super::{Found, Part};

/// Reads cells. A column of times is written one way from its beginning to its end, and counts from
/// its first date and time of day.
#[derive(Debug)]
pub(super) struct Values {
    decimal_comma: bool,
    /// How the times that were read are written.
    clock: Cell<Clock>,
    /// A date whose day and month cannot be told apart was refused.
    unsure: Cell<bool>,
}

/// How times are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Clock {
    /// None was read.
    Unread,
    /// As numbers.
    Numbers,
    /// As dates or times of day; the first one.
    Stamps(Stamp),
    /// In two columns; the first one \[ns\].
    InTwo(i64),
}

impl Values {
    pub(super) const fn new(decimal_comma: bool) -> Self {
        Self { decimal_comma, clock: Cell::new(Clock::Unread), unsure: Cell::new(false) }
    }

    /// Whether times were read that say themselves what they count.
    pub(super) fn are_stamps(&self) -> bool {
        matches!(self.clock.get(), Clock::Stamps(_) | Clock::InTwo(_))
    }

    /// Whether the times that were read are dates or times of day.
    pub(super) fn are_dates(&self) -> bool {
        matches!(self.clock.get(), Clock::Stamps(_))
    }

    /// The value of the column in a row of text; none where there is none.
    pub(super) fn of(&self, record: &StringRecord, found: &Found) -> Option<f64> {
        let cell = |index: usize| record.get(index).unwrap_or_default();
        let read = |index: usize| number(cell(index), self.decimal_comma);
        let value = match found.rest {
            Some(rest) => match rest.part {
                Part::Ticks(tick) => self.joined(read(found.index)?, read(rest.index)?, tick)?,
                Part::Date => {
                    self.stamped(stamp::read_dated(cell(rest.index), cell(found.index)))?
                }
            },
            None if found.clock => {
                self.time_of(cell(found.index), read(found.index), found.source.scale)?
            }
            None => read(found.index)? * found.source.scale,
        };
        value.is_finite().then_some(value)
    }

    /// Whole seconds and what is left of them \[s\], from the first time on.
    pub(super) fn joined(&self, whole: f64, left: f64, tick: i64) -> Option<f64> {
        /// Seconds of which the nanoseconds can be counted.
        const MOST: f64 = 9e9;
        let nanoseconds = |seconds: f64| {
            let usable = seconds.abs() < MOST;
            usable.then(|| (seconds.trunc() as i64, (seconds.fract() * 1e9).round() as i64))
        };
        let (seconds, part) = nanoseconds(whole)?;
        let (over, left) = nanoseconds(left * tick as f64 * 1e-9)?;
        let now =
            seconds.checked_add(over)?.checked_mul(1_000_000_000)?.checked_add(part + left)?;
        let first = match self.clock.get() {
            Clock::InTwo(first) => first,
            _ => now,
        };
        self.clock.set(Clock::InTwo(first));
        Some(now.wrapping_sub(first) as f64 * 1e-9)
    }

    /// The time in a cell \[s\], as a number or from the first date and time of day.
    fn time_of(&self, cell: &str, number: Option<f64>, scale: f64) -> Option<f64> {
        match (self.clock.get(), number) {
            (Clock::Unread | Clock::Numbers, Some(value)) => {
                if value.is_finite() {
                    self.clock.set(Clock::Numbers);
                }
                Some(value * scale)
            }
            (Clock::Unread | Clock::Stamps(_), None) => self.stamped(stamp::read(cell)),
            (Clock::Numbers, None) | (Clock::Stamps(_), Some(_)) | (Clock::InTwo(_), _) => None,
        }
    }

    /// A moment \[s\], from the first one on.
    fn stamped(&self, stamp: Option<Stamp>) -> Option<f64> {
        let stamp = stamp?;
        let Clock::Stamps(first) = self.clock.get() else {
            self.clock.set(Clock::Stamps(stamp));
            return Some(0.0);
        };
        // On one day the order of day and month is all the same.
        if stamp.unsure != first.unsure {
            self.unsure.set(true);
            return None;
        }
        Some(stamp.nanoseconds.wrapping_sub(first.nanoseconds) as f64 * 1e-9)
    }

    /// What was expected where no value was found.
    pub(super) fn expected(&self, found: &Found) -> &'static str {
        if self.unsure.get() {
            "dates whose day and month can be told apart, as in 2024-02-03 12:00:00, since this \
             recording goes past midnight"
        } else if found.rest.is_some_and(|rest| rest.part == Part::Date) {
            "a date such as 2024-03-01, and a time of day such as 12:00:00.001"
        } else if found.rest.is_some() {
            "whole seconds, and what is left of them, as finite numbers"
        } else if found.clock {
            "a finite number or a time such as 2024-03-01T12:00:00.001"
        } else {
            "a finite number"
        }
    }
}
