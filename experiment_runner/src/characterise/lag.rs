//! Experiment 2: the loop of friction over a periodic velocity.
//!
//! Torque and velocity are turned into Fourier series over whole periods, which uses every sample
//! and keeps the noise of one from that of the other. The area is exact for the series:
//!
//! ```text
//! F = sum a_k cos k theta + b_k sin k theta,  w = sum c_k cos k theta + d_k sin k theta
//! loop area = closed integral of F dw = pi sum k (a_k d_k - b_k c_k)
//! ```
//!
//! It is above zero where the torque is higher at rising velocity than at falling velocity:
//! friction lags.

use std::f64::consts::{PI, TAU};

use friction_ident::FrictionTorque;
use serde::{Deserialize, Serialize};

/// Harmonics that are kept: beyond, at 10 rad/s, the test bed's friction shows only noise.
const HARMONICS: usize = 8;

/// Points of a loop as it is drawn.
const POINTS: usize = 180;

/// The loop of one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LagLoop {
    /// Area, closed integral of F dw [N m rad/s].
    pub area: f64,
    /// Its standard deviation by noise, from the scatter of one torque sample [N m rad/s].
    pub area_noise: f64,
    /// Its standard deviation by the drive's constants [N m rad/s].
    pub area_systematic: f64,
    /// Whole periods that counted.
    pub periods: u32,
    /// Velocity over one period [rad/s].
    pub velocity: Vec<f64>,
    /// Friction torque over one period [N m].
    pub torque: Vec<f64>,
}

/// A Fourier series: mean, and cosine and sine of each harmonic.
struct Series {
    mean: f64,
    terms: [(f64, f64); HARMONICS],
}

impl Series {
    /// The series of `values` over `length` samples, a whole number of periods of angular frequency
    /// `w` that need not end at a sample: trapezia up to there. `values` holds two samples more
    /// than `length`, or as many as there are.
    fn of(values: &[f64], time_step: f64, w: f64, length: f64) -> Self {
        let last = length.floor() as usize;
        let part = length - length.floor();
        let weight = |i: usize| match i {
            0 => 0.5,
            _ if i < last => 1.0,
            _ if i == last => 0.5 + part * (1.0 - 0.5 * part),
            _ => 0.5 * part * part,
        };
        let weighted: Vec<f64> =
            values.iter().take(last + 2).enumerate().map(|(i, value)| weight(i) * value).collect();
        let mut terms = [(0.0, 0.0); HARMONICS];
        for (k, term) in (1..).zip(&mut terms) {
            // The angle turns by a product of complex numbers; restarted often enough that
            // roundings do not gather.
            let step = f64::from(k) * w * time_step;
            let (turn_sin, turn_cos) = step.sin_cos();
            for (block, values) in weighted.chunks(1000).enumerate() {
                let (mut sin, mut cos) = (step * (1000 * block) as f64).sin_cos();
                for value in values {
                    term.0 += value * cos;
                    term.1 += value * sin;
                    (sin, cos) = (sin * turn_cos + cos * turn_sin, cos * turn_cos - sin * turn_sin);
                }
            }
            *term = (term.0 * 2.0 / length, term.1 * 2.0 / length);
        }
        Self { mean: weighted.iter().sum::<f64>() / length, terms }
    }

    fn at(&self, theta: f64) -> f64 {
        let term = |(k, (a, b)): (i32, &(f64, f64))| {
            let (sin, cos) = (f64::from(k) * theta).sin_cos();
            a * cos + b * sin
        };
        self.mean + (1..).zip(&self.terms).map(term).sum::<f64>()
    }

    /// Closed integral of `self` d `other`.
    fn area(&self, other: &Self) -> f64 {
        let pairs = (1..).zip(self.terms.iter().zip(&other.terms));
        pairs.map(|(k, ((a, b), (c, d)))| PI * f64::from(k) * (a * d - b * c)).sum()
    }
}

/// The loop of friction over the velocity [rad/s] at angular frequency `w` [rad/s], over the whole
/// periods that begin with sample `first`; `None` where there is not one.
#[must_use]
pub fn lag_loop(
    friction: &FrictionTorque,
    velocity: &[f64],
    time_step: f64,
    first: usize,
    w: f64,
) -> Option<LagLoop> {
    let period = TAU / w / time_step;
    let left = velocity.len().min(friction.torque.len()).checked_sub(first)?;
    // Two samples are needed beyond the last whole one.
    let periods = ((left as f64 - 2.0) / period).floor();
    if periods < 1.0 {
        return None;
    }
    let samples = periods * period;
    let window = first..first + samples as usize + 2;
    let motion = Series::of(velocity.get(window.clone())?, time_step, w, samples);
    let torque = Series::of(friction.torque.get(window.clone())?, time_step, w, samples);
    let area_of = |values: &[f64]| {
        values
            .get(window.clone())
            .map_or(0.0, |part| Series::of(part, time_step, w, samples).area(&motion))
    };
    let power: f64 =
        (1..).zip(&motion.terms).map(|(k, (c, d))| (f64::from(k) * c.hypot(*d)).powi(2)).sum();
    let angles = (0..=POINTS).map(|i| TAU * i as f64 / POINTS as f64);
    Some(LagLoop {
        area: torque.area(&motion),
        area_noise: friction.noise * PI * (2.0 * power / samples).sqrt(),
        area_systematic: friction.propagate(area_of),
        periods: periods as u32,
        velocity: angles.clone().map(|theta| motion.at(theta)).collect(),
        torque: angles.map(|theta| torque.at(theta)).collect(),
    })
}

#[cfg(test)]
mod tests {
    use friction_ident::TorqueSource;

    use super::*;

    /// F = 0.09 + 0.04 w lagging by an angle: the loop is an ellipse with area pi 0.04 0.95^2
    /// sin(angle).
    #[test]
    fn the_area_of_an_ellipse_is_its_closed_form() {
        let (w, h, angle) = (5.0, 1e-3, 0.01f64);
        let at = |i: u32| w * h * f64::from(i);
        let velocity: Vec<f64> = (0..30_000).map(|i| 1.0 - 0.95 * at(i).cos()).collect();
        let torque = (0..30_000).map(|i| 0.13 - 0.038 * (at(i) + angle).cos()).collect();
        let friction =
            FrictionTorque { source: TorqueSource::Sensor, torque, noise: 0.0, constants: vec![] };
        let found = lag_loop(&friction, &velocity, h, 2000, w).unwrap();
        // The torque is ahead of the velocity here: higher when it rises.
        let expected = PI * 0.95 * 0.038 * angle.sin();
        assert!((found.area / expected - 1.0).abs() < 1e-4, "{} {expected}", found.area);
        assert_eq!(found.periods, 22);
        assert!(lag_loop(&friction, &velocity, h, 29_500, w).is_none());
        assert!(lag_loop(&friction, &velocity, h, 40_000, w).is_none());
    }
}
