//! When the samples were taken: the evenly sampled stretches of a recording, and what was uneven
//! about it.
//!
//! The usual step is the median. A sample whose step is within the tolerance of it stays as it is.
//! Where one came late, or up to two are missing, the recording is bridged: what lies off the even
//! grid is read between its neighbours. A longer step cuts the recording in two, and so does a
//! lasting change of the rate; a sample with the time of the one before is dropped. Filters,
//! derivatives and initial states never reach across a cut. Everything is counted
//! ([`Irregularities`]).

mod between;
mod cuts;
mod even_grid;
mod even_step;
mod irregular;
mod options;
mod resample;
mod stretch;
mod uneven;

use std::path::Path;

use friction_ident::statistics::upper_median;

use super::RecordingError;
use super::irregularities::Irregularities;
use super::sheet::Dialect;
use cuts::cut;
use even_grid::even;
use irregular::{irregular, is_irregular};
use resample::resampled;

pub use even_step::even_step;
pub(super) use irregular::rate_for;
pub use options::{PeriodError, RateError, ToleranceError, period, rate, tolerance};
pub use stretch::EvenStretch;

/// Steps up to so many usual ones are bridged: two samples are missing at most.
const BRIDGED: f64 = 3.0;
/// A longer step without samples is a pause between two runs, and nothing is missing \[s\].
const PAUSE: f64 = 0.5;
/// Steps over which a rate is told.
const WINDOW: usize = 20;
/// Steps that a change of the rate must last.
const LASTING: usize = 5;
/// A median that differs by more is another rate, as a fraction.
const OTHER_RATE: f64 = 0.2;
/// Steps off by more, as a fraction, are uneven whatever the tolerance says: with many of them there
/// is no one step, and its mean would only hide that.
const UNEVEN: f64 = 0.1;
/// Share of uneven steps from which a recording is irregular.
const IRREGULAR: f64 = 0.25;
/// Samples without which there is no sampling period.
const NEEDED: usize = 3;
/// How far a time step may be from the usual one where nothing else is said, as a fraction.
pub const TOLERANCE: f64 = 0.05;

/// How the times of a recording become even.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steps {
    /// How far a time step may be from the usual one for its sample to be taken as it is, as a
    /// fraction.
    pub tolerance: f64,
    /// Rate to which uneven samples are brought \[Hz\]; without it an irregular recording is
    /// refused.
    pub resample: Option<f64>,
}

impl From<f64> for Steps {
    fn from(tolerance: f64) -> Self {
        Self { tolerance, resample: None }
    }
}

/// The stretches of a recording with what was uneven.
#[derive(Debug, Clone, PartialEq)]
pub struct Timing {
    /// In the order of time; one at least.
    pub stretches: Vec<EvenStretch>,
    /// What was uneven.
    pub irregularities: Irregularities,
}

impl Timing {
    /// Tells the stretches of a recording apart. `time` is in the order of time. `place` says where
    /// sample `i` stands, as in `line 17`.
    ///
    /// # Errors
    /// [`RecordingError::TooShort`], [`RecordingError::TimeOrder`], [`RecordingError::CoarseTimes`],
    /// [`RecordingError::Irregular`], [`RecordingError::ResampleRate`].
    pub fn of(
        path: &Path,
        time: &[f64],
        steps: impl Into<Steps>,
        place: impl Fn(usize) -> String,
    ) -> Result<Self, RecordingError> {
        let Steps { tolerance, resample } = steps.into();
        let mut kept: Vec<usize> = Vec::with_capacity(time.len());
        for (index, &now) in time.iter().enumerate() {
            match kept.last().map(|&last| time[last]) {
                Some(before) if now < before => {
                    let place = place(index);
                    return Err(RecordingError::TimeOrder {
                        path: path.into(),
                        place,
                        before,
                        time: now,
                    });
                }
                Some(before) if now == before => {}
                _ => kept.push(index),
            }
        }
        let repeated = time.len() - kept.len();
        if 2 * repeated > time.len() {
            let (path, samples) = (path.into(), time.len());
            return Err(RecordingError::CoarseTimes { path, repeated, samples });
        }
        let mut irregularities = Irregularities { repeated, ..Irregularities::default() };
        let times: Vec<f64> = kept.iter().map(|&index| time[index]).collect();
        let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        if let Some(rate) = resample {
            return resampled(path, &kept, &times, rate, irregularities);
        }
        if is_irregular(&steps) {
            return Err(irregular(path, &steps));
        }
        let mut stretches = Vec::new();
        for (samples, after_gap) in cut(&steps, tolerance, &mut irregularities) {
            if samples.len() < NEEDED {
                irregularities.leave_out(samples.len());
                continue;
            }
            stretches.push(even(&kept, &times, samples, tolerance, after_gap, &mut irregularities));
        }
        if stretches.is_empty() {
            return Err(RecordingError::TooShort {
                path: path.into(),
                found: times.len(),
                needed: NEEDED,
            });
        }
        irregularities.stretches = stretches.len();
        Ok(Self { stretches, irregularities })
    }

    /// Without the stretches that have fewer than `shortest` samples.
    ///
    /// # Errors
    /// [`RecordingError::TooShort`] if none is left.
    pub fn longer_than(mut self, path: &Path, shortest: usize) -> Result<Self, RecordingError> {
        let longest = self.stretches.iter().map(EvenStretch::len).max().unwrap_or(0);
        if longest < shortest {
            return Err(RecordingError::TooShort {
                path: path.into(),
                found: longest,
                needed: shortest,
            });
        }
        self.stretches.retain(|stretch| {
            let long = stretch.len() >= shortest;
            if !long {
                self.irregularities.leave_out(stretch.len());
            }
            long
        });
        self.irregularities.stretches = self.stretches.len();
        Ok(self)
    }

    /// Only the stretches with the rate that most samples have, all with their mean sampling
    /// period; the others are counted.
    #[must_use]
    pub fn of_one_rate(mut self) -> Self {
        let samples_like = |one: &EvenStretch| -> usize {
            let like = self.stretches.iter().filter(|other| alike(one.time_step, other.time_step));
            like.map(EvenStretch::len).sum()
        };
        // Of equals the faster one.
        let best = self
            .stretches
            .iter()
            .map(|one| (samples_like(one), one.time_step))
            .max_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)));
        let Some((_, usual)) = best else { return self };
        let (mut steps, mut seconds) = (0, 0.0);
        self.stretches.retain(|stretch| {
            let like = alike(stretch.time_step, usual);
            if like {
                steps += stretch.len() - 1;
                seconds += stretch.time_step * (stretch.len() - 1) as f64;
            } else {
                self.irregularities.other_rate += 1;
                self.irregularities.other_rate_samples += stretch.len();
            }
            like
        });
        if self.stretches.len() > 1 {
            let mean = seconds / steps as f64;
            self.stretches.iter_mut().for_each(|stretch| stretch.time_step = mean);
        }
        self.irregularities.stretches = self.stretches.len();
        self
    }
}

impl Timing {
    /// With what is to be said of the table that it was read from.
    #[must_use]
    pub(super) fn written_as(mut self, blank: usize, dialect: Dialect) -> Self {
        self.irregularities = self.irregularities.written_as(blank, dialect);
        self
    }
}

fn alike(a: f64, b: f64) -> bool {
    (a - b).abs() <= OTHER_RATE * a.min(b)
}

fn median(values: &[f64]) -> f64 {
    upper_median(&mut values.to_vec()).unwrap_or(f64::NAN)
}

/// Six significant digits, for messages.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests;
