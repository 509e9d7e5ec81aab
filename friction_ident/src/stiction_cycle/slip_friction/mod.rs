//! What brakes the axis while it slides, in volts.
//!
//! `u(t - delay) = a theta'' + b theta' + c sign(theta') + offset + d alpha` by least squares over
//! the samples where the axis surely moves. With a small armature inductance `a` is inertia times
//! resistance over torque constant, and `b` is the back-EMF constant and viscous friction together.
//! A pendulum hinged to the axis acts through `alpha''`; its own equation of motion turns that into
//! `theta''` and, for small angles, `alpha`, so that one column for `alpha` holds the whole
//! coupling.
//!
//! The delay is an unknown like the others: [`delay_profile`] finds it and carries what is not
//! known of it into every interval.

mod delay_profile;

use std::ops::ControlFlow;

use nalgebra::DMatrix;
use serde::Serialize;

use super::StictionRecording;
use crate::bounded::{Bound, Minimum, Patience, Residuals, minimise};
use crate::estimate::{Estimate, Estimates, Unknown};
use crate::zero_phase::LowPass;
use crate::{Conditioning, Differences, IdentError, Signals, condition};

/// How the regression is done.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SlipOptions {
    /// Cutoff of the low-pass over all signals, forwards and backwards \[Hz\].
    pub cutoff: f64,
    /// Slower motion is left out \[rad/s\]: there the axis may stick.
    pub slowest: f64,
    /// Longest delay from the voltage to its effect that is tried \[samples\].
    pub longest_delay: usize,
}

impl Default for SlipOptions {
    /// 8 Hz, so that the quantised angle disturbs the acceleration little, 0.2 rad/s, up to 15
    /// samples.
    fn default() -> Self {
        Self { cutoff: 8.0, slowest: 0.2, longest_delay: 15 }
    }
}

/// Friction while sliding.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SlipFriction {
    /// `inertia`, `speed`, `coulomb`, `offset`, `pendulum`, in volts and volts per motion. The
    /// intervals run over every delay that explains the voltage about as well; covariance and
    /// correlation are those at the delay found.
    pub estimates: Estimates,
    /// Samples used.
    pub samples: usize,
    /// Time from the voltage to its effect \[s\]: the one that explains most, with the interval of
    /// its profile.
    pub delay: Estimate,
    /// Residual over voltage, both root mean square, over the samples used.
    pub unexplained: f64,
    /// Speed of each sample used \[rad/s\].
    #[serde(skip)]
    pub speed: Vec<f64>,
    /// Voltage less all terms but those of friction and speed \[V\].
    #[serde(skip)]
    pub friction: Vec<f64>,
}

/// Order of the low-pass.
const ORDER: usize = 2;

const UNKNOWNS: [(&str, &str, &str); 5] = [
    ("inertia", "V s^2/rad", "record motion that speeds up and slows down hard"),
    ("speed", "V s/rad", "record motion at several steady speeds in both directions"),
    ("coulomb", "V", "record slow motion in both directions, as a triangle of the reference"),
    ("offset", "V", "record as much motion forwards as backwards"),
    ("pendulum", "V/rad", "fix or take off the pendulum"),
];

/// Fits the slip equation to the samples of `within`.
///
/// # Errors
/// [`IdentError`] where the recording is unfit or hardly moves.
pub fn slip_friction(
    recording: &StictionRecording,
    within: std::ops::Range<usize>,
    options: &SlipOptions,
) -> Result<SlipFriction, IdentError> {
    recording.check()?;
    let sliding = Sliding::new(recording, &within, options)?;
    let (best, estimates, delay) =
        delay_profile::over_delays(&sliding, options.longest_delay as f64)?;
    let x = &best.minimum.x;
    let others = |i: usize| -> f64 {
        [0, 3, 4].iter().filter_map(|&j| Some(sliding.columns.get(j)?[i] * x.get(j)?)).sum()
    };
    let friction =
        sliding.target(best.delay).iter().enumerate().map(|(i, u)| u - others(i)).collect();
    let speed = sliding.columns.get(1).cloned().unwrap_or_default();
    Ok(SlipFriction {
        estimates,
        samples: sliding.used.len(),
        delay,
        unexplained: best.unexplained,
        speed,
        friction,
    })
}

/// The regressors of the samples where the axis slides, and the voltage, all through the same
/// low-pass.
struct Sliding {
    time_step: f64,
    columns: Vec<Vec<f64>>,
    /// Of the whole recording, so that it can be shifted.
    voltage: Vec<f64>,
    /// Samples of the recording.
    used: Vec<usize>,
}

/// The least squares at one delay.
struct AtDelay {
    /// \[samples\]
    delay: f64,
    minimum: Minimum,
    /// Residual over voltage, root mean square.
    unexplained: f64,
}

impl Sliding {
    fn new(
        recording: &StictionRecording,
        within: &std::ops::Range<usize>,
        options: &SlipOptions,
    ) -> Result<Self, IdentError> {
        let rate = 1.0 / recording.time_step;
        let filter = LowPass::butterworth(ORDER, options.cutoff, rate)?;
        let trim = (0.1 * rate).round() as usize;
        // The whole recording is filtered, so that the cut between the parts makes no transient.
        let how = Conditioning {
            cutoff: options.cutoff,
            acceleration_cutoff: options.cutoff,
            order: ORDER,
            differences: Differences::SecondOrder,
            trim,
            decimate: 1,
            low_pass_force: false,
        };
        let voltage = filter.filter(recording.voltage)?;
        let signals = Signals {
            time_step: recording.time_step,
            position: Some(recording.angle),
            readings: None,
            velocity: None,
            force: &voltage,
        };
        let axis = condition(&signals, &how)?;
        let alpha = recording.pendulum.map(|alpha| filter.filter(alpha)).transpose()?;
        // The sign jumps; it passes the same filter as the voltage that answers it.
        let sign: Vec<f64> = std::iter::repeat_n(0.0, trim)
            .chain(axis.velocity.iter().map(|v| v.signum()))
            .chain(std::iter::repeat_n(0.0, trim))
            .collect();
        let sign = filter.filter(&sign)?;
        let kept: Vec<usize> = (0..axis.velocity.len())
            .filter(|&k| within.contains(&(k + trim)) && axis.velocity[k].abs() >= options.slowest)
            .collect();
        let columns: Vec<Vec<f64>> = [
            Some(kept.iter().map(|&k| axis.acceleration[k]).collect()),
            Some(kept.iter().map(|&k| axis.velocity[k]).collect()),
            Some(kept.iter().map(|&k| sign[k + trim]).collect()),
            Some(vec![1.0; kept.len()]),
            alpha.as_ref().map(|alpha| kept.iter().map(|&k| alpha[k + trim]).collect()),
        ]
        .into_iter()
        .flatten()
        .collect();
        let needed = 20 * columns.len();
        if kept.len() < needed {
            return Err(IdentError::TooFewSamples {
                what: "friction while sliding",
                needed,
                found: kept.len(),
                lower: Some("the slowest speed that counts"),
            });
        }
        let used = kept.into_iter().map(|k| k + trim).collect();
        Ok(Self { time_step: recording.time_step, columns, voltage, used })
    }

    /// The voltage `delay` samples before each sample used \[V\]; between samples on a straight
    /// line, far below whose period the low-pass cuts.
    fn target(&self, delay: f64) -> Vec<f64> {
        let whole = delay.floor();
        let part = delay - whole;
        let at = |k: usize| self.voltage.get(k).copied().unwrap_or(0.0);
        let value = |&k: &usize| {
            let late = k.saturating_sub(whole as usize);
            (1.0 - part) * at(late) + part * at(late.saturating_sub(1))
        };
        self.used.iter().map(value).collect()
    }

    fn fit(&self, delay: f64) -> Result<AtDelay, IdentError> {
        let target = self.target(delay);
        let mut problem = Linear { columns: &self.columns, target: &target };
        let start = vec![0.0; self.columns.len()];
        let bounds = vec![Bound::free(1.0); self.columns.len()];
        let go = &mut |_: &_| ControlFlow::Continue(());
        let minimum = minimise(&mut problem, &start, &bounds, &Patience::default(), go)
            .ok_or_else(|| IdentError::NoConvergence("the voltages are not finite".to_owned()))?;
        let power: f64 = target.iter().map(|u| u * u).sum();
        let unexplained = (minimum.sum / power.max(f64::MIN_POSITIVE)).sqrt();
        Ok(AtDelay { delay, minimum, unexplained })
    }

    fn unknowns(&self) -> Vec<Unknown> {
        UNKNOWNS
            .iter()
            .take(self.columns.len())
            .map(|&(name, unit, remedy)| Unknown { id: name.into(), unit, remedy })
            .collect()
    }
}

struct Linear<'a> {
    columns: &'a [Vec<f64>],
    target: &'a [f64],
}

impl Residuals for Linear<'_> {
    fn len(&self) -> usize {
        self.target.len()
    }

    fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool {
        for (i, residual) in out.iter_mut().enumerate() {
            *residual = self.columns.iter().zip(x).map(|(column, x)| column[i] * x).sum::<f64>()
                - self.target[i];
        }
        true
    }

    fn jacobian(&mut self, _: &[f64], _: &[f64], jacobian: &mut DMatrix<f64>) -> bool {
        for (j, column) in self.columns.iter().enumerate() {
            jacobian.column_mut(j).copy_from_slice(column);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    const DT: f64 = 0.002;
    const RESOLUTION: f64 = 2.0 * std::f64::consts::PI / 2048.0;
    const TRUTH: [(&str, f64); 4] =
        [("inertia", 0.02), ("speed", 0.15), ("coulomb", 0.25), ("offset", 0.05)];

    /// Angle and voltage of a made-up axis; the voltage acts `delay` \[s\] late and `noise` \[V\]
    /// of slow disturbance rides on it.
    fn axis(delay: f64, noise: f64, n: usize) -> (Vec<f64>, Vec<f64>) {
        let [(_, a), (_, b), (_, c), (_, offset)] = TRUTH;
        let motion = |t: f64| {
            let terms = [(1.1, 0.8), (0.6, 2.3), (0.2, 5.1)];
            terms.iter().fold((0.0, 0.0, 0.0), |(q, v, acc), &(size, w)| {
                (
                    q + size * (w * t).sin(),
                    v + size * w * (w * t).cos(),
                    acc - size * w * w * (w * t).sin(),
                )
            })
        };
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(11);
        let mut disturbance = 0.0;
        (0..n)
            .map(|k| {
                let t = k as f64 * DT;
                let (_, v, acc) = motion(t + delay);
                disturbance =
                    0.98 * disturbance + 0.2 * noise * rng.sample::<f64, _>(StandardNormal);
                let voltage = a * acc + b * v + c * v.signum() + offset + disturbance;
                ((motion(t).0 / RESOLUTION).round() * RESOLUTION, voltage)
            })
            .unzip()
    }

    fn identify(angle: &[f64], voltage: &[f64]) -> Result<SlipFriction, IdentError> {
        let recording = StictionRecording {
            time_step: DT,
            angle,
            resolution: RESOLUTION,
            voltage,
            pendulum: None,
        };
        slip_friction(&recording, 0..angle.len(), &SlipOptions::default())
    }

    #[test]
    fn the_terms_of_a_known_axis_come_back() {
        let (angle, voltage) = axis(0.0, 0.0, 10_000);
        let found = identify(&angle, &voltage).unwrap();
        for (name, truth) in TRUTH {
            let estimate = found.estimates.get(name).unwrap();
            assert!((estimate.value / truth - 1.0).abs() < 0.05, "{estimate:?}");
            assert!(estimate.is_identified());
        }
        assert!(found.delay.value <= 0.1 * DT, "{:?}", found.delay);
    }

    #[test]
    fn an_axis_that_stands_still_says_nothing() {
        let still = vec![0.0; 10_000];
        assert!(matches!(identify(&still, &still), Err(IdentError::TooFewSamples { .. })));
    }

    #[test]
    fn a_delay_between_samples_comes_back_within_its_interval() {
        let (angle, voltage) = axis(0.0075, 0.01, 10_000);
        let found = identify(&angle, &voltage).unwrap();
        let interval = found.delay.interval.unwrap();
        assert!(
            interval.contains(0.0075) && interval.high - interval.low < 0.01,
            "{:?}",
            found.delay
        );
        assert!(found.delay.is_identified());
        for (name, truth) in TRUTH {
            let estimate = found.estimates.get(name).unwrap();
            assert!(estimate.interval.unwrap().contains(truth), "{truth}: {estimate:?}");
        }
    }

    /// The delay takes part in every interval: none is narrower than with the delay known.
    #[test]
    fn intervals_are_at_least_those_of_a_known_delay_and_wider_for_what_the_delay_moves() {
        let (angle, voltage) = axis(0.006, 0.01, 10_000);
        let recording = StictionRecording {
            time_step: DT,
            angle: &angle,
            resolution: RESOLUTION,
            voltage: &voltage,
            pendulum: None,
        };
        let options = SlipOptions::default();
        let sliding = Sliding::new(&recording, &(0..angle.len()), &options).unwrap();
        let (best, profiled, _) = delay_profile::over_delays(&sliding, 15.0).unwrap();
        let share = crate::residual_whiteness::effective_share(best.minimum.residuals.as_slice());
        let known = Estimates::linearised(&best.minimum, &sliding.unknowns(), share);
        let width = |estimates: &Estimates, name: &'static str| {
            let interval = estimates.get(name).unwrap().interval.unwrap();
            interval.high - interval.low
        };
        for (name, _) in TRUTH {
            assert!(width(&profiled, name) >= width(&known, name) * (1.0 - 1e-9), "{name}");
        }
        // theta(t + delay) = theta + delay theta' + delay^2 theta'' / 2: the acceleration's term
        // feels a delay through the speed's.
        assert!(width(&profiled, "inertia") > 1.5 * width(&known, "inertia"));
    }
}
