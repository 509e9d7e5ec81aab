//! When the samples were taken: the evenly sampled stretches of a recording, and what was uneven
//! about it.
//!
//! The usual step is the median. A sample whose step is within the tolerance of it stays as it is.
//! Where one came late, or up to two are missing, the recording is bridged: what lies off the even
//! grid is read between its neighbours. A longer step cuts the recording in two, and so does a
//! lasting change of the rate; a sample with the time of the one before is dropped. Filters,
//! derivatives and initial states never reach across a cut. Everything is counted
//! ([`Irregularities`]).

mod resample;

use std::ops::Range;
use std::path::Path;

use friction_ident::statistics::upper_median;

use super::RecordingError;
use super::irregularities::{Irregularities, Resampled};
use super::sheet::Dialect;
use resample::{DENSEST, LARGEST_FACTOR, Uneven};

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

/// Where a sample on the even grid is read.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Place {
    /// The recorded sample at or before it.
    index: usize,
    /// Which one follows that; samples may have been dropped between.
    next: usize,
    /// How far on the way to the next one it lies, from 0.
    part: f64,
}

/// An evenly sampled stretch of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct EvenStretch {
    /// Time of its first sample \[s\].
    pub start: f64,
    /// Sampling period \[s\].
    pub time_step: f64,
    /// The recording was going on before it, and broke off.
    pub after_gap: bool,
    places: Places,
}

/// Where the samples of a stretch are read.
#[derive(Debug, Clone, PartialEq)]
enum Places {
    /// At samples, or between two of them.
    Grid(Vec<Place>),
    /// Everywhere between.
    Resampled(Uneven),
}

impl EvenStretch {
    /// Samples.
    #[must_use]
    pub fn len(&self) -> usize {
        match &self.places {
            Places::Grid(places) => places.len(),
            Places::Resampled(uneven) => uneven.len(),
        }
    }

    /// The first two recorded samples of it.
    pub(super) fn first_two(&self) -> Option<(usize, usize)> {
        let Places::Grid(places) = &self.places else { return None };
        let [first, next, ..] = &places[..] else { return None };
        (next.part == 0.0).then_some((first.index, next.index))
    }

    /// Whether there is no sample.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A channel of the recording on the even grid. What was recorded on the grid comes out bit by
    /// bit.
    ///
    /// `step` is that of a quantiser, if the channel comes from one: what is read between two
    /// samples keeps to its steps.
    #[must_use]
    pub fn channel(&self, recorded: &[f64], step: Option<f64>) -> Vec<f64> {
        let value = |index: usize| recorded.get(index).copied().unwrap_or_default();
        let read = |place: &Place| {
            let here = value(place.index);
            if place.part == 0.0 {
                return here;
            }
            let between = place.part * (value(place.next) - here);
            here + step.map_or(between, |step| (between / step).round() * step)
        };
        match &self.places {
            Places::Grid(places) => places.iter().map(read).collect(),
            Places::Resampled(uneven) => uneven.channel(recorded, step),
        }
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

/// Where the recording is cut: ranges of samples, and whether each begins behind a gap.
fn cut(steps: &[f64], tolerance: f64, found: &mut Irregularities) -> Vec<(Range<usize>, bool)> {
    let ahead = |from: usize| median(&steps[from..(from + WINDOW).min(steps.len())]);
    let mut parts = Vec::new();
    let (mut first, mut after_gap) = (0, false);
    let mut usual = if steps.is_empty() { f64::INFINITY } else { ahead(0) };
    for (k, &step) in steps.iter().enumerate() {
        if (step - usual).abs() <= tolerance * usual {
            continue;
        }
        let gap = step > (BRIDGED + tolerance) * usual;
        let other_rate =
            || steps.len() - k >= LASTING && (ahead(k) - usual).abs() > OTHER_RATE * usual;
        if !(gap || other_rate()) {
            continue;
        }
        parts.push((first..k + 1, after_gap));
        first = k + 1;
        after_gap = false;
        if step > PAUSE.max(BRIDGED * usual) {
            found.pauses += 1;
        } else if gap {
            found.gaps += 1;
            found.missing += (step / usual).round() as usize - 1;
            after_gap = true;
        } else {
            found.rate_changes += 1;
            after_gap = true;
        }
        if first < steps.len() {
            usual = ahead(first);
        }
    }
    parts.push((first..steps.len() + 1, after_gap));
    parts
}

/// One stretch on its grid.
fn even(
    kept: &[usize],
    times: &[f64],
    samples: Range<usize>,
    tolerance: f64,
    after_gap: bool,
    found: &mut Irregularities,
) -> EvenStretch {
    let (first, last) = (samples.start, samples.end - 1);
    let steps: Vec<f64> = times[samples.clone()].windows(2).map(|pair| pair[1] - pair[0]).collect();
    let usual = median(&steps);
    let mean = (times[last] - times[first]) / (last - first) as f64;
    // Where much is tolerated, steps may be off as long as the samples keep to one grid.
    let off = |k: usize| (times[k] - times[first] - mean * (k - first) as f64).abs();
    let near = tolerance * usual;
    let keeps = tolerance <= UNEVEN || samples.clone().all(|k| off(k) <= near);
    let near = if keeps { near } else { UNEVEN * usual };
    let whole = |k: usize| Place { index: kept[k], next: kept[k], part: 0.0 };
    if keeps && steps.iter().all(|step| (step - usual).abs() <= near) {
        // The mean does not suffer from the rounding of the single times.
        let time_step = mean;
        let places = samples.map(whole).collect();
        let places = Places::Grid(places);
        return EvenStretch { start: times[first], time_step, after_gap, places };
    }
    let mut places = vec![whole(first)];
    let (mut now, mut k, mut read_between) = (times[first], first, 0);
    while now + usual <= times[last] + near {
        let next = now + usual;
        while k < last && times[k + 1] <= next {
            k += 1;
        }
        if next - times[k] <= near && times[k] > now {
            places.push(whole(k));
            now = times[k];
        } else if k < last && times[k + 1] - next <= near {
            k += 1;
            places.push(whole(k));
            now = times[k];
        } else if k < last {
            let part = (next - times[k]) / (times[k + 1] - times[k]);
            places.push(Place { index: kept[k], next: kept[k + 1], part });
            read_between += 1;
            now = next;
        } else {
            break;
        }
    }
    let unused = samples.len() - (places.len() - read_between);
    let moved = unused.min(read_between);
    found.moved += moved;
    found.filled += read_between - moved;
    found.dropped += unused - moved;
    let time_step = (now - times[first]) / (places.len() - 1).max(1) as f64;
    EvenStretch { start: times[first], time_step, after_gap, places: Places::Grid(places) }
}

/// The rate to which irregular samples would be brought \[Hz\]; none where their steps are even.
pub(super) fn rate_for(time: &[f64]) -> Option<f64> {
    let steps: Vec<f64> =
        time.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    is_irregular(&steps).then(|| even_rate(&steps))
}

/// Whether so many steps are off their neighbours' median that there is no even grid.
fn is_irregular(steps: &[f64]) -> bool {
    let uneven: usize = steps
        .chunks(WINDOW)
        .map(|window| {
            let usual = median(window);
            // Longer ones are gaps.
            let off = |step: &&f64| {
                (**step - usual).abs() > UNEVEN * usual && **step <= (BRIDGED + UNEVEN) * usual
            };
            window.iter().filter(off).count()
        })
        .sum();
    uneven as f64 > IRREGULAR * steps.len() as f64
}

/// The error that says how irregular it is.
fn irregular(path: &Path, steps: &[f64]) -> RecordingError {
    let mut sorted = steps.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = |part: f64| rounded(sorted[((sorted.len() - 1) as f64 * part) as usize]);
    RecordingError::Irregular {
        path: path.into(),
        shortest: at(0.05),
        usual: at(0.5),
        longest: at(0.95),
        rate: even_rate(steps),
    }
}

/// The mean rate between gaps \[Hz\], to two digits and not above it.
fn even_rate(steps: &[f64]) -> f64 {
    let usual = median(steps);
    let without_gaps: Vec<f64> =
        steps.iter().copied().filter(|step| *step <= BRIDGED * usual).collect();
    let mean_rate = without_gaps.len() as f64 / without_gaps.iter().sum::<f64>();
    let digits = 10f64.powi(mean_rate.log10().floor() as i32 - 1);
    rounded((mean_rate / digits).floor() * digits)
}

/// All stretches between gaps, at one rate.
fn resampled(
    path: &Path,
    kept: &[usize],
    times: &[f64],
    rate: f64,
    mut found: Irregularities,
) -> Result<Timing, RecordingError> {
    let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let usual = median(&steps);
    let mut parts: Vec<(Range<usize>, bool)> = Vec::new();
    let (mut first, mut after_gap) = (0, false);
    for (k, &step) in steps.iter().enumerate().filter(|(_, step)| **step > BRIDGED * usual) {
        parts.push((first..k + 1, after_gap));
        after_gap = step <= PAUSE.max(BRIDGED * usual);
        first = k + 1;
        if after_gap {
            found.gaps += 1;
            found.missing += (step / usual).round() as usize - 1;
        } else {
            found.pauses += 1;
        }
    }
    parts.push((first..times.len(), after_gap));
    let mut stretches: Vec<EvenStretch> = Vec::new();
    let mut longest = 0;
    for (samples, after_gap) in parts {
        let nodes: Vec<(usize, f64)> = samples.clone().map(|k| (kept[k], times[k])).collect();
        let uneven = if nodes.len() < NEEDED {
            None
        } else {
            let seconds = times[samples.end - 1] - times[samples.start];
            let mean_rate = (nodes.len() - 1) as f64 / seconds;
            if !(rate <= DENSEST * mean_rate && rate * LARGEST_FACTOR >= mean_rate) {
                let mean_rate = rounded(mean_rate);
                return Err(RecordingError::ResampleRate { path: path.into(), rate, mean_rate });
            }
            Uneven::new(nodes, rate).map(|uneven| (uneven, mean_rate))
        };
        let Some((uneven, mean_rate)) = uneven.filter(|(uneven, _)| uneven.len() >= NEEDED) else {
            found.leave_out(samples.len());
            continue;
        };
        if samples.len() > longest {
            longest = samples.len();
            found.resampled = Some(Resampled {
                rate,
                mean_rate: rounded(mean_rate),
                low_pass: uneven.low_pass(rate).map(rounded),
                noise: uneven.noise(),
            });
        }
        stretches.push(EvenStretch {
            start: times[samples.start],
            time_step: 1.0 / rate,
            after_gap,
            places: Places::Resampled(uneven),
        });
    }
    if stretches.is_empty() {
        let (path, found, needed) = (path.into(), times.len(), NEEDED);
        return Err(RecordingError::TooShort { path, found, needed });
    }
    found.stretches = stretches.len();
    Ok(Timing { stretches, irregularities: found })
}

/// The sampling period of `time` \[s\], if every step is within `tolerance` (a fraction) of the
/// median step.
///
/// `place` says where sample `i` stands, as in `line 17`.
///
/// # Errors
/// [`RecordingError::TooShort`], [`RecordingError::TimeOrder`], [`RecordingError::Uneven`].
pub fn even_step(
    path: &Path,
    time: &[f64],
    tolerance: f64,
    place: impl Fn(usize) -> String,
) -> Result<f64, RecordingError> {
    let n = time.len();
    if n < NEEDED {
        return Err(RecordingError::TooShort { path: path.into(), found: n, needed: NEEDED });
    }
    let steps: Vec<_> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if let Some(index) = steps.iter().position(|&step| step <= 0.0) {
        return Err(RecordingError::TimeOrder {
            path: path.into(),
            place: place(index + 1),
            before: time[index],
            time: time[index + 1],
        });
    }
    let usual = median(&steps);
    if let Some(index) = steps.iter().position(|step| (step - usual).abs() > tolerance * usual) {
        return Err(RecordingError::Uneven {
            path: path.into(),
            place: place(index + 1),
            step: rounded(steps[index]),
            usual: rounded(usual),
            percent: rounded(100.0 * tolerance),
        });
    }
    // The mean does not suffer from the rounding of the single times.
    Ok((time[n - 1] - time[0]) / (n - 1) as f64)
}

/// A text that is no rate to which samples can be brought.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("expected a rate in Hz above zero, as in 100")]
pub struct RateError;

/// The rate of the option `--resample` \[Hz\].
///
/// # Errors
/// [`RateError`] says what was expected.
pub fn rate(text: &str) -> Result<f64, RateError> {
    text.trim().parse::<f64>().ok().filter(|rate| *rate > 0.0 && rate.is_finite()).ok_or(RateError)
}

/// A text that is no time from row to row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("expected a time in seconds above zero, as in 0.001")]
pub struct PeriodError;

/// The period of the option `--period` \[s\].
///
/// # Errors
/// [`PeriodError`] says what was expected.
pub fn period(text: &str) -> Result<f64, PeriodError> {
    let period = text.trim().parse::<f64>().ok();
    period.filter(|period| *period > 0.0 && period.is_finite()).ok_or(PeriodError)
}

/// A text that is no tolerance of the time steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("expected a fraction of the usual time step from 0 to 0.5, as in 0.05")]
pub struct ToleranceError;

/// The tolerance on the command line.
///
/// # Errors
/// [`ToleranceError`] says what was expected.
pub fn tolerance(text: &str) -> Result<f64, ToleranceError> {
    match text.trim().parse::<f64>() {
        Ok(value) if (0.0..=0.5).contains(&value) => Ok(value),
        _ => Err(ToleranceError),
    }
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
