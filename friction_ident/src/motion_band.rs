//! Up to which frequency a recorded position is motion, and from where it is noise.
//!
//! Differentiating twice makes the noise of an encoder grow with the square of the frequency. Noise
//! in the acceleration draws the inertia towards zero, the more the coarser the encoder and the
//! slower the motion: no interval shows that, as the fit takes the acceleration for exact.
//!
//! The variance of the acceleration behind a low-pass tells both apart without knowing the encoder.
//! Over the cutoff it first grows as more of the motion passes, then stays, and grows again with
//! the fifth power where only noise is added. The cutoff belongs where it stays. The velocity has
//! its own, usually higher: a velocity that is smoothed too much creeps where the axis stands.

use crate::conditioning::{Conditioned, Conditioning, Differences, Signals, condition_stretches};
use crate::statistics::Sample;
use crate::zero_phase::LowPass;

/// What a recording's motion asks of a low-pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionBand {
    /// Cutoff that passes the motion and little else \[Hz\].
    pub cutoff: f64,
    /// How much the variance still changes with the cutoff there, per factor of the square root of
    /// two: what is noise, or motion that is lost.
    pub change: f64,
}

/// What is to be told from noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Derivative {
    /// The velocity.
    Velocity,
    /// The acceleration.
    Acceleration,
}

impl Derivative {
    /// Change of the variance below which it stays. White noise of the position that makes up this
    /// share of the variance falls to a third (velocity) or a sixth (acceleration) by the next
    /// cutoff. Noise of the velocity turns its sign around, and friction with it: less is allowed.
    const fn stays(self) -> f64 {
        match self {
            Self::Velocity => 0.001,
            Self::Acceleration => 0.005,
        }
    }
}

/// Between two cutoffs that are tried: half an octave.
const RATIO: f64 = std::f64::consts::SQRT_2;
/// Cutoffs at most: eight octaves.
const CUTOFFS: usize = 17;
/// Share of a recording's samples left out at each end, where the filter has less to go by.
const ENDS: usize = 20;
/// Share of the motion beyond a cutoff that asks for a higher one.
const BEYOND: f64 = 1e-3;
/// Share of the acceleration that differences of the second order may lose: far less than its
/// standard error, or its interval is narrow and wrong.
const LOST: f64 = 1e-4;
/// Highest cutoff, as a share of the sampling rate: differences lose 2 % there.
const FASTEST: f64 = 0.2;
/// Rows that a thinned recording keeps, if it has them.
const ROWS: usize = 500;
/// Rows that a short recording keeps: thinned no more than leaves these.
const FEWEST_ROWS: usize = 60;
/// Share of the motion between rests that the thinning must leave, as a fraction.
const MOST_MOTION: (usize, usize) = (3, 4);
/// Share of the samples that a short recording loses at each end.
const SHORT_ENDS: usize = 10;
/// Periods of the cutoff dropped at each end, as in the usual conditioning.
const TRIM: f64 = 5.0;

impl Conditioning {
    /// [`for_time_step`](Self::for_time_step) with both cutoffs lowered to where the motion ends, if
    /// the noise of the position would cover it; thinning and trimming follow that of the
    /// acceleration, so that the force is taken up to where the acceleration is. Motion faster than
    /// the usual cutoff raises it, up to a fifth of the sampling rate, and asks for differences of a
    /// higher order. Stretches too short to be
    /// filtered do not count.
    #[must_use]
    pub fn for_motion(time_step: f64, stretches: &[Signals]) -> Self {
        let mut usual = Self::for_time_step(time_step);
        if share_beyond(stretches, usual.order, usual.cutoff).is_some_and(|share| share > BEYOND) {
            usual.cutoff = FASTEST / time_step;
            usual.acceleration_cutoff = usual.cutoff;
            usual.decimate = (1.0 / FASTEST) as usize;
        }
        let up_to = |of: Derivative| {
            motion_band(stretches, of, usual.order, usual.cutoff)
                .map_or(usual.cutoff, |band| band.cutoff.min(usual.cutoff))
        };
        let cutoff = up_to(Derivative::Velocity);
        let acceleration_cutoff = up_to(Derivative::Acceleration).min(cutoff);
        let size = |of| variance(stretches, of, usual.order, acceleration_cutoff);
        let squared = size(Derivative::Acceleration).zip(size(Derivative::Velocity));
        let lost = squared.map_or(0.0, |(a, v)| a / v * time_step * time_step / 6.0);
        if lost > LOST {
            usual.differences = Differences::SixthOrder;
        }
        let samples: usize = stretches.iter().map(|signals| signals.force.len()).sum();
        let longest = stretches.iter().map(|signals| signals.force.len()).max().unwrap_or(0);
        if acceleration_cutoff >= usual.cutoff {
            return usual.spared(samples, longest).between_rests(stretches);
        }
        let periods = 1.0 / time_step / acceleration_cutoff;
        let thin = periods.round().min((samples / ROWS) as f64) as usize;
        Self {
            cutoff,
            acceleration_cutoff,
            decimate: thin.clamp(usual.decimate, 1000),
            trim: trim(periods, longest).max(usual.trim),
            ..usual
        }
        .spared(samples, longest)
        .between_rests(stretches)
    }

    /// The same with both cutoffs as they were given \[Hz\]: derivatives, thinning and what is left
    /// out at the ends suit that.
    #[must_use]
    pub fn with_cutoff(self, time_step: f64, stretches: &[Signals], cutoff: f64) -> Self {
        let usual = Self::for_time_step(time_step);
        let longest = stretches.iter().map(|signals| signals.force.len()).max().unwrap_or(0);
        // Nonsense is refused when the recording is conditioned.
        let periods = 1.0 / time_step / cutoff;
        Self {
            cutoff,
            acceleration_cutoff: cutoff,
            decimate: periods.round().clamp(1.0, 1000.0) as usize,
            differences: self.differences,
            trim: trim(periods, longest).max(usual.trim.min(self.trim)),
            ..usual
        }
    }

    /// The same with fewer samples left out, where the axis moves only for short whiles between two
    /// rests: motion that is too short to be thinned would be lost.
    fn between_rests(self, stretches: &[Signals]) -> Self {
        let stretches: Vec<(f64, Signals)> = stretches.iter().map(|own| (0.0, *own)).collect();
        let Ok(found) = condition_stretches(&stretches, &self) else { return self };
        let moving = |decimate: usize| {
            let thinned = Conditioned { decimate, ..found.clone() };
            thinned
                .moving()
                .map_or((0, false), |(moving, rest)| (moving.velocity.len(), rest.kept > 0.0))
        };
        let (all, sticks) = moving(1);
        if all == found.velocity.len() {
            return self;
        }
        let mut decimate = self.decimate;
        while decimate > 1 {
            let (left, sticks_too) = moving(decimate);
            // Sticks that could be left out would be fitted as motion.
            let enough = left >= all * MOST_MOTION.0 / MOST_MOTION.1 && sticks_too == sticks;
            if enough && left >= FEWEST_ROWS * decimate {
                break;
            }
            decimate = 2 * decimate / 3;
        }
        Self { decimate: decimate.max(1), ..self }
    }

    /// The same for a recording of so few samples that little would be left of it: less is dropped
    /// at the ends, and it is thinned less. Of one that nothing can be learnt from, all stays as usual.
    fn spared(self, samples: usize, longest: usize) -> Self {
        if longest < FEWEST_ROWS {
            return self;
        }
        let trim = self.trim.min(longest / SHORT_ENDS);
        let left = samples.saturating_sub(2 * trim);
        Self { trim, decimate: self.decimate.min((left / FEWEST_ROWS).max(1)), ..self }
    }
}

/// Where the motion of a recording ends, at most at `highest` \[Hz\], for a low-pass of that order.
/// None where nothing moves or no stretch is long enough.
#[must_use]
pub fn motion_band(
    stretches: &[Signals],
    of: Derivative,
    order: usize,
    highest: f64,
) -> Option<MotionBand> {
    let mut best: Option<MotionBand> = None;
    let mut before: Option<(f64, f64)> = None;
    let cutoffs = std::iter::successors(Some(highest), |cutoff| Some(cutoff / RATIO));
    for cutoff in cutoffs.take(CUTOFFS) {
        let Some(variance) = variance(stretches, of, order, cutoff) else { break };
        // What falls away now is motion.
        if share_beyond(stretches, order, cutoff).is_some_and(|share| share > BEYOND) {
            best = best.or(Some(MotionBand { cutoff: highest, change: f64::INFINITY }));
            break;
        }
        if let Some((higher, more)) = before {
            let change = (more / variance).ln();
            if change < of.stays() {
                let stays = if higher == highest { higher } else { cutoff };
                return Some(MotionBand { cutoff: stays, change: change.max(0.0) });
            }
            if best.is_none_or(|best| change < best.change) {
                best = Some(MotionBand { cutoff: higher, change });
            }
        }
        before = Some((cutoff, variance));
    }
    best
}

/// Share of the variance of the recorded positions (velocities, where only these are known) that is
/// beyond a cutoff \[Hz\]: the noise of an encoder is next to nothing there, motion is not. None
/// where nothing moves or no stretch is long enough.
#[must_use]
pub fn share_beyond(stretches: &[Signals], order: usize, cutoff: f64) -> Option<f64> {
    let (mut beyond, mut all) = (0.0, 0.0);
    for signals in stretches {
        let Some(recorded) = signals.position.or(signals.velocity) else { continue };
        let low_pass = LowPass::butterworth(order, cutoff, 1.0 / signals.time_step).ok()?;
        let Ok(smooth) = low_pass.filter(recorded) else { continue };
        let end = recorded.len() / ENDS;
        let inner = end..recorded.len() - end;
        let (Some(recorded), Some(smooth)) = (recorded.get(inner.clone()), smooth.get(inner))
        else {
            continue;
        };
        let mean = Sample::of(recorded.iter().copied()).mean;
        for (recorded, smooth) in recorded.iter().zip(smooth) {
            beyond += (recorded - smooth).powi(2);
            all += (recorded - mean).powi(2);
        }
    }
    let share = beyond / all;
    share.is_finite().then_some(share)
}

/// Variance of the velocity or the acceleration behind a low-pass, over all stretches.
fn variance(stretches: &[Signals], of: Derivative, order: usize, cutoff: f64) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0);
    for signals in stretches {
        let dt = signals.time_step;
        let low_pass = LowPass::butterworth(order, cutoff, 1.0 / dt).ok()?;
        let slope = |values: &[f64]| -> Vec<f64> {
            values.windows(2).map(|pair| (pair[1] - pair[0]) / dt).collect()
        };
        let velocity = match (signals.velocity, signals.position) {
            (Some(velocity), _) => low_pass.filter(velocity),
            (None, Some(position)) => low_pass.filter(position).map(|smooth| slope(&smooth)),
            (None, None) => continue,
        };
        let Ok(velocity) = velocity else { continue };
        let values = match of {
            Derivative::Velocity => velocity,
            Derivative::Acceleration => slope(&velocity),
        };
        let end = values.len() / ENDS;
        let Some(inner) = values.get(end..values.len().saturating_sub(end)) else { continue };
        let sample = Sample::of(inner.iter().copied());
        if sample.count > 1 {
            sum += sample.variance() * sample.count as f64;
            count += sample.count as f64;
        }
    }
    let variance = sum / count;
    (variance > 0.0 && variance.is_finite()).then_some(variance)
}

/// Samples that are dropped at each end of the longest stretch, where a period of the cutoff has so
/// many.
fn trim(periods: f64, longest: usize) -> usize {
    ((TRIM * periods).round() as usize).min(longest / ENDS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conditioning::condition;
    use crate::rigid_axis::{AxisModel, fit_axis};

    const DT: f64 = 1e-3;

    /// A slow axis and the torque of an inertia of 0.3 kg m^2, read by an encoder.
    fn slow_axis(counts: f64) -> (Vec<f64>, Vec<f64>) {
        let step = std::f64::consts::TAU / counts;
        let tones = [(0.8, 1.1), (0.5, 2.3), (0.2, 3.7)];
        (0..40_000)
            .map(|k| {
                let t = f64::from(k) * DT;
                let [mut q, mut v, mut a] = [0.0; 3];
                for (size, w) in tones {
                    let (sin, cos) = f64::sin_cos(w * t);
                    q += size * sin;
                    v += size * w * cos;
                    a -= size * w * w * sin;
                }
                ((q / step).round() * step, 0.3 * a + 0.2 * v + 0.5 * v.signum())
            })
            .unzip()
    }

    fn inertia(how: &Conditioning, position: &[f64], force: &[f64]) -> f64 {
        let signals = Signals {
            time_step: DT,
            position: Some(position),
            readings: None,
            velocity: None,
            force,
        };
        let fit = fit_axis(&condition(&signals, how).unwrap(), AxisModel::SYMMETRIC).unwrap();
        fit.value(crate::axis_term::AxisTerm::Inertia)
    }

    /// A stranger's axis: its inertia came out at a fraction of the truth, with a narrow interval.
    #[test]
    fn a_coarse_encoder_does_not_take_the_inertia_away() {
        for counts in [1024.0, 4096.0, 16384.0] {
            let (position, force) = slow_axis(counts);
            let usual = inertia(&Conditioning::for_time_step(DT), &position, &force);
            let signals = Signals {
                time_step: DT,
                position: Some(&position),
                readings: None,
                velocity: None,
                force: &force,
            };
            let how = Conditioning::for_motion(DT, &[signals]);
            let found = inertia(&how, &position, &force);
            assert!((found / 0.3 - 1.0).abs() < 0.01, "{counts}: {found}, {how:?}");
            assert!(counts > 2000.0 || usual < 0.15, "{counts}: {usual} without");
        }
    }

    /// An axis at 200 Hz: its inertia was a third of a percent too large, three times its interval.
    #[test]
    fn differences_lose_less_than_an_interval_is_wide() {
        let dt = 5e-3;
        let (position, force): (Vec<f64>, Vec<f64>) = (0..1000)
            .map(|k| {
                let t = dt * f64::from(k);
                let [mut q, mut v, mut a] = [0.0; 3];
                for (size, w) in [(1.0, 8.2), (0.4, 18.8)] {
                    q -= size * f64::cos(w * t);
                    v += size * w * f64::sin(w * t);
                    a += size * w * w * f64::cos(w * t);
                }
                (q, 0.02 * a + 0.1 * v)
            })
            .unzip();
        let signals = Signals {
            time_step: dt,
            position: Some(&position),
            readings: None,
            velocity: None,
            force: &force,
        };
        let how = Conditioning::for_motion(dt, &[signals]);
        let fit = fit_axis(&condition(&signals, &how).unwrap(), AxisModel::SYMMETRIC).unwrap();
        let found = fit.value(crate::axis_term::AxisTerm::Inertia);
        assert!((found / 0.02 - 1.0).abs() < 5e-4, "{found}, {how:?}");
    }

    /// An arm at 100 Hz whose motion goes up to 14 Hz: the low-pass of 10 Hz left a tenth of it.
    #[test]
    fn motion_faster_than_the_usual_cutoff_raises_it() {
        let dt = 0.01;
        let (position, force): (Vec<f64>, Vec<f64>) = (0..4000)
            .map(|k| {
                let t = dt * f64::from(k);
                let [mut q, mut a] = [0.0; 2];
                for (size, w) in [(0.3, 13.0), (0.1, 87.0)] {
                    q += size * f64::sin(w * t);
                    a -= size * w * w * f64::sin(w * t);
                }
                (q, 0.3 * a)
            })
            .unzip();
        let signals = Signals {
            time_step: dt,
            position: Some(&position),
            readings: None,
            velocity: None,
            force: &force,
        };
        let how = Conditioning::for_motion(dt, &[signals]);
        let usual = Conditioning::for_time_step(dt);
        assert!(how.cutoff > 15.0, "{how:?}");
        let beyond = |how: &Conditioning| share_beyond(&[signals], how.order, how.cutoff).unwrap();
        assert!(beyond(&usual) > 0.05 && beyond(&how) < 0.005);
        let error = |how| {
            let conditioned = condition(&signals, how).unwrap();
            let pairs = conditioned.force.iter().zip(&conditioned.acceleration);
            let (up, down) =
                pairs.fold((0.0, 0.0), |(up, down), (f, a)| (up + f * a, down + a * a));
            (up / down / 0.3 - 1.0).abs()
        };
        assert!(error(&how) < 0.1, "{}", error(&how));
    }

    #[test]
    fn a_fine_encoder_changes_nothing() {
        let (position, force) = slow_axis(f64::from(1 << 24));
        let signals = Signals {
            time_step: DT,
            position: Some(&position),
            readings: None,
            velocity: None,
            force: &force,
        };
        let usual = Conditioning::for_time_step(DT);
        assert_eq!(Conditioning::for_motion(DT, &[signals]), usual);
        assert_eq!(Conditioning::for_motion(DT, &[]), usual);
        let still = vec![0.0; 40_000];
        let rest = Signals { position: Some(&still), ..signals };
        assert_eq!(Conditioning::for_motion(DT, &[rest]), usual);
        let short = Signals { position: Some(&still[..4]), force: &force[..4], ..signals };
        assert_eq!(Conditioning::for_motion(DT, &[short]), usual);
    }

    /// Moves of 0.7 s with rests between, at 100 Hz: none was long enough to be thinned by ten.
    #[test]
    fn short_moves_between_rests_are_kept() {
        let dt = 0.01;
        let (position, force): (Vec<f64>, Vec<f64>) = (0..3000)
            .map(|k| {
                let (move_, part) = (k / 200, (f64::from(k % 200) * dt / 0.7).min(1.0));
                let way = if move_ % 2 == 0 { 1.0 } else { -1.0 };
                let (x, v, a) = (
                    part.powi(3) * (10.0 - 15.0 * part + 6.0 * part * part),
                    30.0 * part.powi(2) * (1.0 - part).powi(2) / 0.7,
                    60.0 * part * (1.0 - part) * (1.0 - 2.0 * part) / 0.49,
                );
                let q = if way > 0.0 { x } else { 1.0 - x };
                let moves = if part < 1.0 { way } else { 0.0 };
                (q, 0.1 * way * a + 0.2 * way * v + 0.5 * moves)
            })
            .unzip();
        let signals = Signals {
            time_step: dt,
            position: Some(&position),
            readings: None,
            velocity: None,
            force: &force,
        };
        let how = Conditioning::for_motion(dt, &[signals]);
        let (moving, rest) = condition(&signals, &how).unwrap().moving().unwrap();
        assert!(rest.out > 10.0 && rest.out < 25.0, "{rest:?}, {how:?}");
        let fit = fit_axis(&moving, AxisModel::SYMMETRIC).unwrap();
        let found = fit.value(crate::axis_term::AxisTerm::Coulomb);
        assert!((found / 0.5 - 1.0).abs() < 0.15, "{found}, {how:?}");
    }

    /// One and a half seconds at 100 Hz: with 50 samples off each end and one in ten kept, five were
    /// left. A long recording is treated as before.
    #[test]
    fn a_short_recording_keeps_enough_to_be_fitted() {
        let dt = 0.01;
        let record = |count: u32| -> (Vec<f64>, Vec<f64>) {
            (0..count)
                .map(|k| {
                    let (sin, cos) = f64::sin_cos(12.0 * dt * f64::from(k));
                    (0.5 * sin, -0.02 * 72.0 * sin + 0.1 * 6.0 * cos + 0.5 * cos.signum())
                })
                .unzip()
        };
        let how = |position: &[f64], force: &[f64]| {
            let signals = Signals {
                time_step: dt,
                position: Some(position),
                readings: None,
                velocity: None,
                force,
            };
            (Conditioning::for_motion(dt, &[signals]), signals.force.len())
        };
        let (position, force) = record(150);
        let (short, _) = how(&position, &force);
        let signals = Signals {
            time_step: dt,
            position: Some(&position),
            readings: None,
            velocity: None,
            force: &force,
        };
        let fit = fit_axis(&condition(&signals, &short).unwrap(), AxisModel::SYMMETRIC).unwrap();
        let found = fit.value(crate::axis_term::AxisTerm::Coulomb);
        assert!((found / 0.5 - 1.0).abs() < 0.2, "{found}, {short:?}");
        let (position, force) = record(4000);
        let (long, _) = how(&position, &force);
        assert!(long.trim >= 50 && short.trim <= 15, "{long:?} {short:?}");
    }
}
