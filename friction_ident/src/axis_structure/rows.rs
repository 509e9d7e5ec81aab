//! The rows of the regression: samples behind the low-pass of the thinning, one in so many, read as
//! late as the force acts.

use std::ops::Range;

use super::shape::LONGEST_DELAY;
use crate::IdentError;
use crate::conditioning::{Conditioned, Piece};
use crate::zero_phase::LowPass;

/// Where the low-pass of the thinning ends, as a share of the rate of the rows.
const PASS: f64 = 0.4;

/// Rows that the low-pass of the thinning remembers.
const MEMORY: usize = 15;

/// How a column is read on the rows, to be as late as the force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Reading {
    /// So many samples later; earlier where that is below zero.
    Later(f64),
    /// Behind a low-pass of the first order with a time constant of so many samples.
    LowPassed(f64),
}

/// How a recording's samples become rows.
pub(super) struct Rows<'a> {
    recording: &'a Conditioned,
    filter: Option<LowPass>,
}

impl<'a> Rows<'a> {
    pub fn of(recording: &'a Conditioned) -> Result<Self, IdentError> {
        let filter = match recording.decimate {
            1 => None,
            factor => Some(LowPass::chebyshev(8, 0.05, PASS / factor as f64, 1.0)?),
        };
        Ok(Self { recording, filter })
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.pieces().iter().sum()
    }

    /// Rows of each stretch.
    pub fn pieces(&self) -> Vec<usize> {
        let factor = self.recording.decimate;
        self.recording.pieces.iter().map(|piece| rows_of(piece, factor)).collect()
    }

    /// The rows of each stretch; its rests are left out of them.
    pub fn stretches(&self) -> Vec<Range<usize>> {
        let counts = self.pieces();
        self.whole(counts.into_iter().scan(0, |first, count| {
            let own = *first..*first + count;
            *first = own.end;
            Some(own)
        }))
    }

    /// The kept samples of each stretch.
    pub fn samples(&self) -> Vec<Range<usize>> {
        self.whole(self.recording.pieces.iter().map(|piece| piece.kept.clone()))
    }

    /// The ranges of all pieces, those of one stretch together.
    fn whole(&self, ranges: impl Iterator<Item = Range<usize>>) -> Vec<Range<usize>> {
        let mut all: Vec<Range<usize>> = Vec::new();
        let mut last = None;
        for (piece, range) in self.recording.pieces.iter().zip(ranges) {
            match all.last_mut().filter(|_| last == Some(piece.stretch)) {
                Some(stretch) => stretch.end = range.end,
                None => all.push(range),
            }
            last = Some(piece.stretch);
        }
        all
    }

    /// Time since the recording's first sample \[s\], of each row.
    pub fn time(&self) -> Vec<f64> {
        let Conditioned { time_step, first, decimate, .. } = *self.recording;
        let of = |piece: &Piece| {
            let start = piece.start;
            (0..rows_of(piece, decimate))
                .map(move |k| start + (first + k * decimate) as f64 * time_step)
        };
        self.recording.pieces.iter().flat_map(of).collect()
    }

    /// How many waves a second pass the low-pass of the thinning.
    pub fn fastest_wave(&self) -> f64 {
        let Conditioned { decimate, time_step, .. } = *self.recording;
        if decimate == 1 { f64::INFINITY } else { PASS / (decimate as f64 * time_step) }
    }

    /// A column on the kept rows, never from beyond its own stretch.
    pub fn read(&self, column: &[f64], reading: Reading) -> Vec<f64> {
        match reading {
            Reading::Later(samples) => self.later(column, samples),
            Reading::LowPassed(samples) => self.low_passed(column, samples),
        }
    }

    /// A column behind a low-pass of the first order, straight between its samples, at rest where each
    /// piece begins.
    fn low_passed(&self, column: &[f64], samples: f64) -> Vec<f64> {
        let factor = self.recording.decimate;
        let mut rows = Vec::with_capacity(self.recording.pieces.len() * 8);
        let left = (-1.0 / samples).exp();
        let part = samples * (1.0 - left);
        let (own, before) = (1.0 - part, part - left);
        for piece in &self.recording.pieces {
            let values = column.get(piece.kept.clone()).unwrap_or_default();
            let Some(&first) = values.first() else { continue };
            let behind = values.iter().scan([first; 2], |[behind, last], &value| {
                *behind = left * *behind + own * value + before * *last;
                *last = value;
                Some(*behind)
            });
            rows.extend(behind.step_by(factor).take(rows_of(piece, factor)));
        }
        rows
    }

    fn later(&self, column: &[f64], delay: f64) -> Vec<f64> {
        let factor = self.recording.decimate;
        let mut rows = Vec::with_capacity(self.recording.pieces.len() * 8);
        let (later, t) = (delay.floor() as isize, delay - delay.floor());
        let weights = cubic(t);
        for piece in &self.recording.pieces {
            let own = column.get(piece.kept.clone()).unwrap_or_default();
            rows.extend((0..rows_of(piece, factor)).map(|k| {
                let at = (k * factor) as isize + later;
                let first = usize::try_from(at - 1).ok().filter(|_| t > 0.0);
                match first.and_then(|first| own.get(first..first + 4)) {
                    Some(near) => near.iter().zip(&weights).map(|(y, w)| y * w).sum(),
                    None => read(own, at as f64 + t),
                }
            }));
        }
        rows
    }

    /// A column that dies out from the start of each piece on, after the low-pass of the thinning, as
    /// far as it is larger than `least`; empty where it is nowhere. The low-pass is spared what is
    /// zero.
    pub fn smoothed_start(&self, column: &[f64], least: f64) -> Result<Vec<f64>, IdentError> {
        let mut smooth = Vec::new();
        for piece in &self.recording.pieces {
            let own = column.get(piece.kept.clone()).unwrap_or_default();
            let lasts = own.iter().take_while(|left| **left > least).count();
            if lasts == 0 {
                continue;
            }
            smooth.resize(column.len(), 0.0);
            let memory = MEMORY * self.recording.decimate;
            let own = own.get(..lasts + memory).unwrap_or(own);
            let to = smooth.iter_mut().skip(piece.kept.start);
            match &self.filter {
                Some(filter) => to.zip(filter.filter(own)?).for_each(|(to, from)| *to = from),
                None => to.zip(own).for_each(|(to, from)| *to = *from),
            }
        }
        Ok(smooth)
    }

    /// Columns after the low-pass of the thinning.
    pub fn smoothed(&self, columns: Vec<Vec<f64>>) -> Result<Vec<Vec<f64>>, IdentError> {
        let Some(filter) = &self.filter else { return Ok(columns) };
        let mut smooth = vec![Vec::new(); columns.len()];
        for piece in &self.recording.pieces {
            let kept = || piece.kept.clone();
            let own: Vec<&[f64]> =
                columns.iter().map(|column| column.get(kept()).unwrap_or_default()).collect();
            for (all, own) in smooth.iter_mut().zip(filter.filter_all(&own)?) {
                if all.is_empty() { *all = own } else { all.extend(own) }
            }
        }
        Ok(smooth)
    }
}

/// Rows that a stretch gives: its end is left to the longest delay.
pub(crate) fn rows_of(piece: &Piece, factor: usize) -> usize {
    piece.kept.len().saturating_sub(LONGEST_DELAY + 2).div_ceil(factor)
}

/// A column between its samples, by the cubic through the four around it.
pub(crate) fn read(column: &[f64], at: f64) -> f64 {
    let at = at.max(0.0);
    let i = at.floor() as usize;
    let t = at - i as f64;
    let value =
        |k: usize| column.get(k.min(column.len().saturating_sub(1))).copied().unwrap_or(0.0);
    if t == 0.0 {
        return value(i);
    }
    let near = [value(i.saturating_sub(1)), value(i), value(i + 1), value(i + 2)];
    near.iter().zip(cubic(t)).map(|(y, weight)| y * weight).sum()
}

/// Weights of four samples in the value of their cubic at `t` between the second and the third.
fn cubic(t: f64) -> [f64; 4] {
    [
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    ]
}

#[cfg(test)]
mod tests {
    use super::read;

    /// A cubic is met exactly inside.
    #[test]
    fn a_cubic_is_read_exactly_between_samples() {
        let cubic = |t: f64| 1.0 + t * (2.0 - t * (0.5 - 0.25 * t));
        let column: Vec<f64> = (0..8).map(|i| cubic(f64::from(i))).collect();
        for at in [1.0, 1.3, 2.5, 4.999, 5.5] {
            assert!((read(&column, at) - cubic(at)).abs() < 1e-12, "{at}");
        }
    }
}
