//! What brakes the axis while it slides, in volts.
//!
//! `u = a theta'' + b theta' + c sign(theta') + offset + d alpha` by least squares over the samples where the axis surely moves.
//! With a small armature inductance `a` is inertia times resistance over torque constant, and `b` is the back-EMF constant and
//! viscous friction together. A pendulum hinged to the axis acts through `alpha''`; its own equation of motion turns that into
//! `theta''` and, for small angles, `alpha`, so that one column for `alpha` holds the whole coupling.

use std::ops::ControlFlow;

use nalgebra::DMatrix;
use serde::Serialize;

use super::StictionRecording;
use crate::bounded::{Bound, Patience, Residuals, minimise};
use crate::estimate::{Estimates, Unknown};
use crate::residual_whiteness::effective_share;
use crate::zero_phase::LowPass;
use crate::{Conditioning, IdentError, Signals, condition};

/// How the regression is done.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SlipOptions {
    /// Cutoff of the low-pass over all signals, forwards and backwards \[Hz\].
    pub cutoff: f64,
    /// Slower motion is left out \[rad/s\]: there the axis may stick.
    pub slowest: f64,
    /// Delays from the voltage to its effect that are tried \[samples\]: from none to this many; the one that explains most is kept.
    pub longest_delay: usize,
}

impl Default for SlipOptions {
    /// 8 Hz, so that the quantised angle disturbs the acceleration little, .2 rad/s, up to 15 samples.
    fn default() -> Self {
        Self { cutoff: 8.0, slowest: 0.2, longest_delay: 15 }
    }
}

/// Friction while sliding.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SlipFriction {
    /// `inertia`, `speed`, `coulomb`, `offset`, `pendulum`, in volts and volts per motion.
    pub estimates: Estimates,
    /// Samples used.
    pub samples: usize,
    /// Time from the voltage to its effect that explains most \[s\].
    pub delay: f64,
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
    let fit = |delay| fit(recording, &within, options, delay);
    let mut best = fit(0)?;
    for delay in 1..=options.longest_delay {
        match fit(delay) {
            Ok(found) if found.unexplained < best.unexplained => best = found,
            _ => {}
        }
    }
    Ok(best)
}

fn fit(
    recording: &StictionRecording,
    within: &std::ops::Range<usize>,
    options: &SlipOptions,
    delay: usize,
) -> Result<SlipFriction, IdentError> {
    let rate = 1.0 / recording.time_step;
    let filter = LowPass::butterworth(ORDER, options.cutoff, rate)?;
    let trim = (0.1 * rate).round() as usize;
    // The whole recording is filtered, so that the cut between the parts makes no transient.
    let how = Conditioning { cutoff: options.cutoff, order: ORDER, trim, decimate: 1 };
    let late: Vec<f64> = (0..recording.samples())
        .filter_map(|k| recording.voltage.get(k.saturating_sub(delay)).copied())
        .collect();
    let voltage = filter.filter(&late)?;
    let signals = Signals {
        time_step: recording.time_step,
        position: Some(recording.angle),
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
    let used: Vec<usize> = (0..axis.velocity.len())
        .filter(|&k| within.contains(&(k + trim)) && axis.velocity[k].abs() >= options.slowest)
        .collect();
    let columns: Vec<Vec<f64>> = [
        Some(used.iter().map(|&k| axis.acceleration[k]).collect()),
        Some(used.iter().map(|&k| axis.velocity[k]).collect()),
        Some(used.iter().map(|&k| sign[k + trim]).collect()),
        Some(vec![1.0; used.len()]),
        alpha.as_ref().map(|alpha| used.iter().map(|&k| alpha[k + trim]).collect()),
    ]
    .into_iter()
    .flatten()
    .collect();
    let needed = 20 * columns.len();
    if used.len() < needed {
        return Err(IdentError::TooFewSamples {
            what: "friction while sliding",
            needed,
            found: used.len(),
            lower: "the slowest speed that counts",
        });
    }
    let target: Vec<f64> = used.iter().map(|&k| axis.force[k]).collect();
    let mut problem = Linear { columns: &columns, target: &target };
    let start = vec![0.0; columns.len()];
    let bounds = vec![Bound::free(1.0); columns.len()];
    let go = &mut |_: &_| ControlFlow::Continue(());
    let minimum = minimise(&mut problem, &start, &bounds, &Patience::default(), go)
        .ok_or_else(|| IdentError::NoConvergence("the voltages are not finite".to_owned()))?;
    let unknowns: Vec<Unknown> = UNKNOWNS
        .iter()
        .take(columns.len())
        .map(|&(name, unit, remedy)| Unknown { name: name.to_owned(), unit, remedy })
        .collect();
    let share = effective_share(minimum.residuals.as_slice());
    let estimates = Estimates::linearised(&minimum, &unknowns, share);
    let speed = columns[1].clone();
    let friction = (0..used.len())
        .map(|i| {
            target[i] - [0, 3, 4].iter().filter_map(|&j| Some(columns.get(j)?[i] * minimum.x[j])).sum::<f64>()
        })
        .collect();
    let power: f64 = target.iter().map(|u| u * u).sum();
    let unexplained = (minimum.sum / power.max(f64::MIN_POSITIVE)).sqrt();
    let delay = delay as f64 * recording.time_step;
    Ok(SlipFriction { estimates, samples: used.len(), delay, unexplained, speed, friction })
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
            *residual =
                self.columns.iter().zip(x).map(|(column, x)| column[i] * x).sum::<f64>() - self.target[i];
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

    /// A made-up axis under a quantised encoder gives back what it was made of.
    #[test]
    fn the_terms_of_a_known_axis_come_back() {
        let dt = 0.002;
        let resolution = 2.0 * std::f64::consts::PI / 2048.0;
        let (a, b, c, offset) = (0.02, 0.15, 0.25, 0.05);
        let motion = |t: f64| {
            let terms = [(1.1, 0.8), (0.6, 2.3), (0.2, 5.1)];
            terms.iter().fold((0.0, 0.0, 0.0), |(q, v, acc), &(size, w)| {
                (q + size * (w * t).sin(), v + size * w * (w * t).cos(), acc - size * w * w * (w * t).sin())
            })
        };
        let n = 10_000;
        let (mut angle, mut voltage) = (Vec::new(), Vec::new());
        for k in 0..n {
            let (q, v, acc) = motion(k as f64 * dt);
            angle.push((q / resolution).round() * resolution);
            voltage.push(a * acc + b * v + c * v.signum() + offset);
        }
        let recording =
            StictionRecording { time_step: dt, angle: &angle, resolution, voltage: &voltage, pendulum: None };
        let found = slip_friction(&recording, 0..n, &SlipOptions::default()).unwrap();
        for (name, truth) in [("inertia", a), ("speed", b), ("coulomb", c), ("offset", offset)] {
            let estimate = found.estimates.get(name).unwrap();
            assert!((estimate.value / truth - 1.0).abs() < 0.05, "{estimate:?}");
            assert!(estimate.is_identified());
        }
        // An axis that stands still says nothing.
        let still = vec![0.0; n];
        let recording = StictionRecording { angle: &still, ..recording };
        assert!(matches!(
            slip_friction(&recording, 0..n, &SlipOptions::default()),
            Err(IdentError::TooFewSamples { .. })
        ));
    }
}
