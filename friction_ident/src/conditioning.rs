//! From sampled position and force to velocity, acceleration and force without phase shift.
//!
//! The position (or the velocity, where that is what was measured) goes through a zero-phase
//! Butterworth low-pass and is differentiated by central differences; the filter's and the
//! differences' troubles at both ends are cut off. The force is left as measured: filtering it
//! alone would shift nothing but would flatten the steps that Coulomb friction makes. Decimation
//! comes later, when the regression is set up, and treats every regressor and the force alike
//! ([`crate::rigid_axis`]).
//!
//! A recording with gaps is conditioned stretch by stretch ([`condition_stretches`]): no filter,
//! difference or delay reaches across a gap.

use std::ops::Range;

use crate::IdentError;
use crate::rest::standing;
use crate::zero_phase::{LowPass, decimate};

/// How a recording is conditioned and thinned.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Conditioning {
    /// Cutoff of the low-pass of position and velocity \[Hz\], where its zero-phase gain is one
    /// half.
    pub cutoff: f64,
    /// Cutoff of that of the acceleration \[Hz\]; one above `cutoff` counts as that.
    pub acceleration_cutoff: f64,
    /// Order of the low-pass in one direction, 1 to 12.
    pub order: usize,
    /// How derivatives are taken.
    pub differences: Differences,
    /// Samples dropped at each end.
    pub trim: usize,
    /// Every how many samples one is kept for the regression, after an anti-alias low-pass; one
    /// keeps all.
    pub decimate: usize,
}

impl Conditioning {
    /// What suits a recording with the sampling period `time_step` \[s\]: a tenth of the sampling
    /// rate but at most 100 Hz, fourth order, 50 samples off each end, and decimation to about the
    /// cutoff. At 1 kHz this is the conditioning published with the EMPS benchmark.
    pub fn for_time_step(time_step: f64) -> Self {
        let rate = 1.0 / time_step;
        let cutoff = (rate / 10.0).min(100.0);
        Self {
            cutoff,
            acceleration_cutoff: cutoff,
            order: 4,
            differences: Differences::SecondOrder,
            trim: 50,
            decimate: ((rate / cutoff).round() as usize).clamp(1, 1000),
        }
    }
}

/// Central differences. At a frequency `w` they lose a share of the derivative.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Differences {
    /// Of two samples: `(w dt)^2 / 6` is lost, 6 % at a tenth of the sampling rate.
    SecondOrder,
    /// Of six: `(w dt)^6 / 140`, 0.05 % there. More of the noise passes.
    SixthOrder,
}

/// What was recorded, all channels at the same instants.
#[derive(Debug, Clone, Copy)]
pub struct Signals<'a> {
    /// Sampling period \[s\].
    pub time_step: f64,
    /// Position \[m or rad\].
    pub position: Option<&'a [f64]>,
    /// Velocity \[m/s or rad/s\]; the position is not used where this is given.
    pub velocity: Option<&'a [f64]>,
    /// Driving force \[N\] or torque \[N m\].
    pub force: &'a [f64],
}

/// A conditioned recording, still at the full sampling rate; of one with gaps the stretches stand
/// one behind the other.
#[derive(Debug, Clone, PartialEq)]
pub struct Conditioned {
    /// Sampling period \[s\].
    pub time_step: f64,
    /// Index of the first kept sample in the recording, or in each of its stretches.
    pub first: usize,
    /// Position \[m or rad\], where it was recorded.
    pub position: Option<Vec<f64>>,
    /// Velocity \[m/s or rad/s\].
    pub velocity: Vec<f64>,
    /// Acceleration \[m/s^2 or rad/s^2\].
    pub acceleration: Vec<f64>,
    /// Force \[N\] or torque \[N m\], as recorded.
    pub force: Vec<f64>,
    /// Acceleration that rounding alone can make; anything below is no excitation.
    pub(crate) acceleration_floor: f64,
    /// Velocity that rounding alone can make.
    pub(crate) velocity_floor: f64,
    /// Factor by which the regression thins the samples.
    pub(crate) decimate: usize,
    /// Samples between two that rest is told by.
    pub(crate) stride: usize,
    /// The stretches without a gap; one at least.
    pub(crate) pieces: Vec<Piece>,
    /// Velocity with the time in which the axis stands still, where that was taken out: bristles
    /// keep their deflection while it stands.
    pub(crate) history: Option<Vec<f64>>,
}

/// A stretch of a conditioned recording.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Piece {
    /// Which of the stretches that were given it is.
    pub stretch: usize,
    /// Its kept samples among all of them.
    pub kept: Range<usize>,
    /// The same in the history, where there is one.
    pub origin: Range<usize>,
    /// Time of its first recorded sample \[s\].
    pub start: f64,
}

impl Conditioned {
    /// Stretches of the recording that were long enough to be conditioned.
    pub fn stretches(&self) -> usize {
        let mut all: Vec<usize> = self.pieces.iter().map(|piece| piece.stretch).collect();
        all.dedup();
        all.len()
    }

    /// The recording without the time in which it stands still, and how long that was \[s\].
    ///
    /// At rest the sign of the velocity is that of its noise, and friction is whatever is applied: a
    /// regression on it is ruined. Rest is told from motion after the low-pass, at twice its cutoff,
    /// where noise is nearly white. However long the rest is, it says nothing of friction in motion.
    ///
    /// # Errors
    /// [`IdentError::TooFewSamples`] where no motion between two rests is long enough.
    pub fn moving(self) -> Result<(Self, f64), IdentError> {
        let stride = self.stride;
        let shortest = THINNING_PADDING.max(LEAST_ROWS * self.decimate) + 1;
        let mut pieces = Vec::new();
        let mut kept: Vec<Range<usize>> = Vec::new();
        let mut longest = 0;
        for piece in &self.pieces {
            let velocity = self.velocity.get(piece.kept.clone()).unwrap_or_default();
            let thinned: Vec<f64> = velocity.iter().copied().step_by(stride).collect();
            let rest = standing(&thinned);
            let at_rest = |k: usize| rest.get(k / stride).copied().unwrap_or(false);
            let mut begin = 0;
            while begin < velocity.len() {
                let state = at_rest(begin);
                let same = (begin..velocity.len()).take_while(|&k| at_rest(k) == state).count();
                let end = begin + same;
                longest = longest.max(if state { 0 } else { same });
                if !state && same >= shortest {
                    let from = kept.iter().map(ExactSizeIterator::len).sum::<usize>();
                    let origin = piece.kept.start + begin..piece.kept.start + end;
                    pieces.push(Piece {
                        stretch: piece.stretch,
                        kept: from..from + same,
                        origin: origin.clone(),
                        start: piece.start + begin as f64 * self.time_step,
                    });
                    kept.push(origin);
                }
                begin = end;
            }
        }
        let left: usize = kept.iter().map(ExactSizeIterator::len).sum();
        let out = self.velocity.len() - left;
        if out == 0 || self.velocity.iter().all(|v| v.abs() <= self.velocity_floor) {
            return Ok((self, 0.0));
        }
        if left == 0 {
            return Err(IdentError::TooFewSamples {
                what: "the motion between two rests",
                needed: shortest,
                found: longest,
                lower: Some("the decimation"),
            });
        }
        let of = |column: &[f64]| -> Vec<f64> {
            kept.iter().filter_map(|range| column.get(range.clone())).flatten().copied().collect()
        };
        let moving = Self {
            position: self.position.as_deref().map(of),
            velocity: of(&self.velocity),
            acceleration: of(&self.acceleration),
            force: of(&self.force),
            pieces,
            history: Some(self.velocity),
            ..self
        };
        let seconds = out as f64 * moving.time_step;
        Ok((moving, seconds))
    }

    /// The recording at a lower rate that still holds all of the motion, where the regression keeps
    /// far fewer samples than there are: what is computed sample by sample, bristles above all, then
    /// costs a fraction. Motion is beyond its low-pass, so that leaving samples out loses nothing;
    /// the force goes through an anti-alias low-pass. As it was where there is nothing to gain.
    ///
    /// # Errors
    /// Those of the low-pass.
    pub fn coarsened(self) -> Result<Self, IdentError> {
        let of_motion = self.stride / SAMPLES_A_STRIDE;
        let factor = of_motion.min(self.decimate / SAMPLES_A_ROW);
        let shortest = self.pieces.iter().map(|piece| piece.kept.len()).min().unwrap_or(0);
        if factor < 2 || shortest <= THINNING_PADDING || self.history.is_some() {
            return Ok(self);
        }
        let thin = |column: &[f64]| {
            self.by_piece(column, |own| Ok(own.iter().copied().step_by(factor).collect()))
        };
        let force = self.by_piece(&self.force, |own| decimate(own, factor))?;
        let position = self.position.as_deref().map(thin).transpose()?;
        let (velocity, acceleration) = (thin(&self.velocity)?, thin(&self.acceleration)?);
        let time_step = self.time_step * factor as f64;
        let (mut pieces, mut from) = (Vec::with_capacity(self.pieces.len()), 0);
        // The first sample stays where it is; counts of samples before it are others.
        let first = (self.first as f64 / factor as f64).round() as usize;
        let shift = self.first as f64 * self.time_step - first as f64 * time_step;
        for piece in self.pieces {
            let kept = from..from + piece.kept.len().div_ceil(factor);
            from = kept.end;
            let start = piece.start + shift;
            pieces.push(Piece { kept: kept.clone(), origin: kept, start, ..piece });
        }
        Ok(Self {
            time_step,
            first,
            position,
            velocity,
            acceleration,
            force,
            pieces,
            decimate: (self.decimate as f64 / factor as f64).round() as usize,
            stride: (self.stride / factor).max(1),
            ..self
        })
    }

    /// What the axis does, sample by sample: velocity, acceleration, way since the last reversal,
    /// and position where it is known.
    pub(crate) fn motion(&self) -> Vec<Vec<f64>> {
        let mut since = 0.0;
        let mut before = 0.0f64;
        let way = self.velocity.iter().map(|&v| {
            since = if v * before < 0.0 { 0.0 } else { since + v.abs() * self.time_step };
            before = v;
            since
        });
        let mut motion = vec![way.collect(), self.velocity.clone(), self.acceleration.clone()];
        motion.extend(self.position.clone());
        motion
    }

    /// A column made anew stretch by stretch, so that nothing reaches across a gap.
    pub(crate) fn by_piece(
        &self,
        column: &[f64],
        make: impl Fn(&[f64]) -> Result<Vec<f64>, IdentError>,
    ) -> Result<Vec<f64>, IdentError> {
        let mut made = Vec::with_capacity(column.len());
        for piece in &self.pieces {
            made.extend(make(column.get(piece.kept.clone()).unwrap_or_default())?);
        }
        Ok(made)
    }
}

/// Samples that are left between two that rest is told by: four in a period of the cutoff.
const SAMPLES_A_STRIDE: usize = 2;
/// Samples that are left between two rows of the regression: a reversal is known to one of them.
const SAMPLES_A_ROW: usize = 8;
/// Thinned samples that motion between two rests must have to be of use.
const LEAST_ROWS: usize = 8;

/// Conditions each stretch of a recording for itself and puts them one behind the other. Each comes
/// with the time of its first sample \[s\]; all have one sampling period. Stretches too short for
/// the filters are left out, which [`Conditioned::stretches`] tells.
///
/// # Errors
/// Those of [`condition`] for the longest stretch, and [`IdentError::TimeStep`] where the sampling
/// periods differ.
pub fn condition_stretches(
    stretches: &[(f64, Signals)],
    how: &Conditioning,
) -> Result<Conditioned, IdentError> {
    let longest =
        (0..stretches.len()).max_by_key(|&i| (stretches[i].1.force.len(), stretches.len() - i));
    let Some(longest) = longest else { return Err(IdentError::NoMotion) };
    let dt = stretches[longest].1.time_step;
    if let Some((_, other)) = stretches.iter().find(|(_, signals)| signals.time_step != dt) {
        return Err(IdentError::TimeStep(other.time_step));
    }
    let thinning = if how.decimate > 1 { THINNING_PADDING } else { 0 };
    let mut found: Option<Conditioned> = None;
    for (i, (start, signals)) in stretches.iter().enumerate() {
        let mut one = match condition(signals, how) {
            Err(IdentError::TooFewSamples { .. }) if i != longest => continue,
            other => other?,
        };
        if i != longest && one.force.len() <= thinning {
            continue;
        }
        let before = found.as_ref().map_or(0, |all| all.force.len());
        let kept = before..before + one.force.len();
        let piece = Piece { stretch: i, kept: kept.clone(), origin: kept, start: *start };
        let Some(all) = &mut found else {
            one.pieces = vec![piece];
            found = Some(one);
            continue;
        };
        all.pieces.push(piece);
        if let (Some(all), Some(one)) = (&mut all.position, &one.position) {
            all.extend_from_slice(one);
        }
        all.velocity.extend_from_slice(&one.velocity);
        all.acceleration.extend_from_slice(&one.acceleration);
        all.force.extend_from_slice(&one.force);
        all.velocity_floor = all.velocity_floor.max(one.velocity_floor);
        all.acceleration_floor = all.acceleration_floor.max(one.acceleration_floor);
    }
    found.ok_or(IdentError::NoMotion)
}

/// Samples that the anti-alias low-pass of the thinning needs more than: three times its order.
const THINNING_PADDING: usize = 24;

/// Filters, differentiates and trims a recording.
///
/// # Errors
/// [`IdentError`] for a sampling period, a cutoff or an order out of range, channels of different
/// length, values that are not finite, a missing motion, and too few samples for the filter or the
/// trimming.
pub fn condition(signals: &Signals, how: &Conditioning) -> Result<Conditioned, IdentError> {
    let dt = signals.time_step;
    if !(dt > 0.0 && dt.is_finite()) {
        return Err(IdentError::TimeStep(dt));
    }
    let filter = LowPass::butterworth(how.order, how.cutoff, 1.0 / dt)?;
    if !(1..=1000).contains(&how.decimate) {
        return Err(IdentError::Decimation(how.decimate));
    }
    let n = signals.force.len();
    let channels = [
        ("the position", signals.position),
        ("the velocity", signals.velocity),
        ("the force", Some(signals.force)),
    ];
    for (channel, values) in
        channels.iter().filter_map(|(name, values)| values.map(|values| (*name, values)))
    {
        if values.len() != n {
            return Err(IdentError::UnequalLengths { channel, found: values.len(), expected: n });
        }
        if let Some(index) = values.iter().position(|value| !crate::finite::usable(*value)) {
            return Err(IdentError::NotFinite { channel, index, value: values[index] });
        }
    }
    let needed = how.trim.saturating_mul(2).saturating_add(3).max(filter.padding() + 1);
    if n < needed {
        return Err(IdentError::TooFewSamples {
            what: "conditioning (low-pass and trimming)",
            needed,
            found: n,
            lower: Some("the trim or the filter order"),
        });
    }
    let position = signals.position.map(|position| filter.filter(position)).transpose()?;
    let (velocity, velocity_floor) = match (signals.velocity, signals.position, &position) {
        (Some(velocity), ..) => (filter.filter(velocity)?, rounding(velocity)),
        (None, Some(raw), Some(smooth)) => (how.differences.of(smooth, dt), rounding(raw) / dt),
        _ => return Err(IdentError::NoMotion),
    };
    let acceleration = if how.acceleration_cutoff < how.cutoff {
        let filter = LowPass::butterworth(how.order, how.acceleration_cutoff, 1.0 / dt)?;
        how.differences.of(&filter.filter(&velocity)?, dt)
    } else {
        how.differences.of(&velocity, dt)
    };
    let kept = how.trim..n - how.trim;
    let all = 0..kept.len();
    let pieces = vec![Piece { stretch: 0, kept: all.clone(), origin: all, start: 0.0 }];
    Ok(Conditioned {
        pieces,
        time_step: dt,
        first: how.trim,
        position: position.map(|position| position[kept.clone()].to_vec()),
        velocity: velocity[kept.clone()].to_vec(),
        acceleration: acceleration[kept.clone()].to_vec(),
        force: signals.force[kept].to_vec(),
        acceleration_floor: velocity_floor / dt,
        velocity_floor,
        decimate: how.decimate,
        history: None,
        stride: ((0.5 / (dt * how.cutoff)).round() as usize).max(1),
    })
}

impl Differences {
    /// The derivative of a signal, inside by central differences, next to the ends by shorter and
    /// one-sided ones. `signal` has at least two samples.
    fn of(self, signal: &[f64], dt: f64) -> Vec<f64> {
        let last = signal.len() - 1;
        let longest = match self {
            Self::SecondOrder => 1,
            Self::SixthOrder => 3,
        };
        let slope = |k: usize| {
            let across = |reach: usize| signal[k + reach] - signal[k - reach];
            match k.min(last - k).min(longest) {
                0 if k == 0 => signal[1] - signal[0],
                0 => signal[last] - signal[last - 1],
                1 => across(1) / 2.0,
                2 => (8.0 * across(1) - across(2)) / 12.0,
                _ => (45.0 * across(1) - 9.0 * across(2) + across(3)) / 60.0,
            }
        };
        (0..=last).map(|k| slope(k) / dt).collect()
    }
}

/// The size of what filtering in double precision can leave of a signal that should be smooth.
fn rounding(signal: &[f64]) -> f64 {
    1e-12 * signal.iter().fold(0.0f64, |largest, value| largest.max(value.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn signals<'a>(position: &'a [f64], force: &'a [f64]) -> Signals<'a> {
        Signals { time_step: 1e-3, position: Some(position), velocity: None, force }
    }

    const HOW: Conditioning = Conditioning {
        cutoff: 100.0,
        acceleration_cutoff: 100.0,
        order: 4,
        differences: Differences::SecondOrder,
        trim: 50,
        decimate: 10,
    };

    #[test]
    fn differentiates_a_sine_without_delay() {
        let w = 2.0 * std::f64::consts::PI * 2.0;
        let time = |i: usize| i as f64 * 1e-3;
        let position: Vec<f64> = (0..2000).map(|i| (w * time(i)).sin()).collect();
        let out = condition(&signals(&position, &position), &HOW).unwrap();
        assert_eq!(out.first, 50);
        assert_eq!(out.velocity.len(), 1900);
        for (k, (v, a)) in out.velocity.iter().zip(&out.acceleration).enumerate() {
            let t = time(k + 50);
            // The central difference's own error is (w dt)^2 / 6, 2.6e-5.
            assert!((v - w * (w * t).cos()).abs() < 4e-5 * w, "velocity at {t}");
            assert!((a + w * w * (w * t).sin()).abs() < 8e-5 * w * w, "acceleration at {t}");
        }
    }

    /// An arm that is sampled slowly for its motion: the inertia of a tone at a twentieth of the rate
    /// came out 3 % too large.
    #[test]
    fn fast_motion_keeps_its_size() {
        let lines: Vec<f64> = (0..200).map(|k| (0.314 * f64::from(k)).sin()).collect();
        let slopes = Differences::SixthOrder.of(&lines, 1.0);
        for (k, slope) in slopes.iter().enumerate().skip(3).take(194) {
            let truth = 0.314 * (0.314 * k as f64).cos();
            assert!((slope - truth).abs() < 1e-5 * 0.314, "{k}: {slope} {truth}");
        }
        for order in 0..=2 {
            let curve: Vec<f64> = (0..9).map(|k| f64::from(k).powi(order)).collect();
            for how in [Differences::SecondOrder, Differences::SixthOrder] {
                let slopes = how.of(&curve, 1.0);
                let truth = |k: usize| f64::from(order) * (k as f64).powi(order - 1);
                assert!((1..8).all(|k| (slopes[k] - truth(k)).abs() < 1e-12), "{slopes:?}");
            }
        }
    }

    #[test]
    fn a_given_velocity_is_used() {
        let velocity: Vec<f64> = (0..500).map(|i| 0.5 + 1e-3 * i as f64).collect();
        let zeros = vec![0.0; 500];
        let given = Signals {
            time_step: 1e-3,
            position: Some(&zeros),
            velocity: Some(&velocity),
            force: &zeros,
        };
        let out = condition(&given, &HOW).unwrap();
        assert!(out.acceleration.iter().all(|a| (a - 1.0).abs() < 1e-6));
    }

    #[test]
    fn degenerate_recordings_are_refused() {
        let ok = vec![1.0; 300];
        let short = vec![1.0; 102];
        assert!(matches!(
            condition(&signals(&short, &short), &HOW),
            Err(IdentError::TooFewSamples { needed: 103, .. })
        ));
        assert!(matches!(
            condition(&signals(&[], &[]), &HOW),
            Err(IdentError::TooFewSamples { .. })
        ));
        assert!(matches!(
            condition(&signals(&short, &ok), &HOW),
            Err(IdentError::UnequalLengths { .. })
        ));
        let mut broken = ok.clone();
        broken[7] = f64::NAN;
        assert!(matches!(
            condition(&signals(&broken, &ok), &HOW),
            Err(IdentError::NotFinite { channel: "the position", index: 7, .. })
        ));
        let no_motion = Signals { time_step: 1e-3, position: None, velocity: None, force: &ok };
        assert!(matches!(condition(&no_motion, &HOW), Err(IdentError::NoMotion)));
        let no_time = Signals { time_step: 0.0, ..signals(&ok, &ok) };
        assert!(matches!(condition(&no_time, &HOW), Err(IdentError::TimeStep(_))));
        assert!(condition(&signals(&ok, &ok), &Conditioning { decimate: 0, ..HOW }).is_err());
    }

    /// Two seconds of a sine, two of rest with an encoder's noise, two of the sine.
    #[test]
    fn rest_is_left_out_and_motion_stays_with_its_times() {
        use rand::{RngExt, SeedableRng};
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(7);
        let place = |t: f64| match t {
            t if t < 2.0 => (std::f64::consts::PI * t).cos(),
            t if t < 4.0 => 1.0,
            t => (std::f64::consts::PI * (t - 4.0)).cos(),
        };
        let mut noisy = |i: u32| place(f64::from(i) * 1e-3) + 1e-4 * rng.random::<f64>();
        let position: Vec<f64> = (0..6000).map(&mut noisy).collect();
        let whole = condition(&signals(&position, &position), &HOW).unwrap();
        let (found, rest) = whole.clone().moving().unwrap();
        assert!((rest - 2.0).abs() < 0.2, "{rest}");
        assert_eq!((found.stretches(), found.pieces.len()), (1, 2));
        assert!((found.pieces[1].start - 4.0).abs() < 0.15, "{:?}", found.pieces);
        assert_eq!(found.pieces[1].kept.end, found.velocity.len());
        let offset = whole.velocity.len() - found.velocity.len();
        assert_eq!(found.velocity[..100], whole.velocity[..100]);
        let last = found.force.len() - 1;
        assert_eq!(found.force[last], whole.force[last + offset]);
        let sine: Vec<f64> = (0..6000).map(|i| (f64::from(i) * 3e-3).sin()).collect();
        let whole = condition(&signals(&sine, &sine), &HOW).unwrap();
        assert_eq!(whole.clone().moving().unwrap(), (whole, 0.0));
    }

    /// An axis that rested for most of a recording used to be fitted with its rest: Coulomb friction
    /// of 0.5 N m came out as 0.007 +- 0.023.
    #[test]
    fn a_long_rest_is_left_out_however_long() {
        use rand::{RngExt, SeedableRng};
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(9);
        let w = 2.0 * std::f64::consts::PI;
        let mut recording = |motion: std::ops::Range<u32>| -> Vec<f64> {
            let place = |i: u32| (w * 1e-3 * f64::from(i.clamp(motion.start, motion.end))).cos();
            (0..40_000).map(|i| place(i) + 1e-4 * rng.random::<f64>()).collect()
        };
        let (long, short) = (recording(20_000..22_000), recording(20_000..20_060));
        let of = |position: &[f64]| condition(&signals(position, position), &HOW).unwrap().moving();
        let (found, rest) = of(&long).unwrap();
        assert!((rest - 37.9).abs() < 0.3, "{rest}");
        assert_eq!(found.pieces.len(), 1);
        let said = of(&short).unwrap_err().to_string();
        assert!(said.contains("the motion between two rests"), "{said}");
    }

    /// Of 5 kHz with a motion of a few hertz a fifth is left, at the same times and of the same size.
    #[test]
    fn a_coarser_recording_has_the_same_motion() {
        let w = 2.0 * std::f64::consts::PI * 1.5;
        let position: Vec<f64> = (0..20_000).map(|i| (w * f64::from(i) * 2e-4).sin()).collect();
        let given = Signals { time_step: 2e-4, ..signals(&position, &position) };
        let how = Conditioning { cutoff: 100.0, decimate: 100, ..HOW };
        let fine = condition(&given, &how).unwrap();
        let coarse = fine.clone().coarsened().unwrap();
        let factor = (coarse.time_step / fine.time_step).round() as usize;
        assert!(factor >= 4, "{factor}");
        assert_eq!(coarse.decimate * factor, fine.decimate / factor * factor);
        assert_eq!(coarse.velocity.len(), fine.velocity.len().div_ceil(factor));
        assert_eq!(coarse.velocity[7], fine.velocity[7 * factor]);
        let time = |of: &Conditioned| of.pieces[0].start + of.first as f64 * of.time_step;
        assert!((time(&coarse) - time(&fine)).abs() < 1e-12);
        for (a, b) in coarse.force.iter().zip(fine.force.iter().step_by(factor)) {
            assert!((a - b).abs() < 0.01, "{a} {b}");
        }
    }

    #[test]
    fn the_default_at_one_kilohertz_is_that_of_the_benchmark() {
        assert_eq!(Conditioning::for_time_step(1e-3), HOW);
        assert!(Conditioning::for_time_step(0.01).cutoff < 50.0);
    }

    proptest! {
        #[test]
        fn never_panics(
            position in proptest::collection::vec(-1e9..1e9f64, 0..400),
            trim in 0usize..300, order in 0usize..20, cutoff in -10.0..2000.0f64, decimate in 0usize..2000,
        ) {
            let _ = condition(&signals(&position, &position), &Conditioning { cutoff, acceleration_cutoff: 0.5 * cutoff, order, differences: Differences::SixthOrder, trim, decimate });
        }
    }
}
