//! Friction along a recording but for its levels: direction and nearness to rest, sample by sample,
//! with their derivatives.

use std::ops::Range;

use super::AxisStructure;
use super::shape::Shape;
use crate::conditioning::Conditioned;

/// What friction is made of at each sample of a recording.
#[derive(Debug, Clone)]
pub(super) struct FrictionCurve {
    /// Direction of motion, -1 to 1: the sign of the velocity, or the deflection of a bristle over
    /// its limit.
    pub sign: Vec<f64>,
    /// Derivative of that with respect to the bristle's displacement; empty without a bristle.
    sign_slope: Vec<f64>,
    /// Rate of the bristle's deflection \[m/s or rad/s\]; empty without damping.
    pub rate: Vec<f64>,
    /// Derivative of that with respect to the displacement.
    rate_slope: Vec<f64>,
    /// One at rest and zero far from it; empty without a Stribeck curve.
    pub near: Vec<f64>,
    /// Derivative of that with respect to the Stribeck velocity.
    near_slope: Vec<f64>,
}

/// Levels of friction that the signs are multiplied by.
#[derive(Debug, Clone, Copy)]
pub(super) struct Levels {
    /// Away from rest, forward and backward.
    pub kinetic: [f64; 2],
    /// At rest.
    pub rest: [f64; 2],
    /// Change over half of the travel, and its curvature.
    pub along: [f64; 2],
    /// Micro-damping, of the rate of the deflection.
    pub damping: f64,
}

impl FrictionCurve {
    pub fn of(recording: &Conditioned, structure: &AxisStructure, shape: &Shape) -> Self {
        let Bristle { sign, sign_slope, rate, rate_slope } = if structure.presliding {
            Bristle::along(recording, shape.displacement, structure.damping)
        } else {
            let floor = recording.velocity_floor;
            let sign = recording.velocity.iter().map(|&v| direction(v, floor)).collect();
            Bristle { sign, ..Bristle::default() }
        };
        let velocity: &[f64] = if structure.stribeck { &recording.velocity } else { &[] };
        let (near, near_slope) = velocity
            .iter()
            .map(|v| {
                let ratio = (v / shape.v_s).powi(2);
                let near = (-ratio).exp();
                (near, 2.0 * near * ratio / shape.v_s)
            })
            .unzip();
        Self { sign, sign_slope, rate, rate_slope, near, near_slope }
    }

    /// Derivative of the friction of `levels` with respect to the Stribeck velocity.
    pub fn by_velocity(&self, levels: &Levels) -> Vec<f64> {
        let of = |(sign, slope): (&f64, &f64)| {
            let side = usize::from(*sign < 0.0);
            sign * slope * (levels.rest[side] - levels.kinetic[side])
        };
        self.sign.iter().zip(&self.near_slope).map(of).collect()
    }

    /// Derivative of the friction of `levels` with respect to the displacement, where `place` is the
    /// position from -1 to 1 (empty where nothing depends on it).
    pub fn by_displacement(&self, levels: &Levels, place: &[f64]) -> Vec<f64> {
        let Levels { kinetic, rest, along, damping } = levels;
        let of = |(k, (sign, slope)): (usize, (&f64, &f64))| {
            let side = usize::from(*sign < 0.0);
            let near = self.near.get(k).copied().unwrap_or(0.0);
            let x = place.get(k).copied().unwrap_or(0.0);
            let level = kinetic[side] * (1.0 - near) + rest[side] * near;
            let damped = damping * self.rate_slope.get(k).copied().unwrap_or(0.0);
            slope * (level + along[0] * x + along[1] * x * x) + damped
        };
        self.sign.iter().zip(&self.sign_slope).enumerate().map(of).collect()
    }
}

/// The sign of a velocity, zero where it is none but for rounding.
fn direction(v: f64, floor: f64) -> f64 {
    if v.abs() <= floor { 0.0 } else { v.signum() }
}

/// A bristle along a recording.
#[derive(Default)]
struct Bristle {
    sign: Vec<f64>,
    sign_slope: Vec<f64>,
    rate: Vec<f64>,
    rate_slope: Vec<f64>,
}

impl Bristle {
    /// The deflection over its limit of Dahl's (1968) bristle, `z' = (v - |v| z) / displacement`,
    /// solved exactly over a sample of constant velocity, its mean rate over the sample, and their
    /// derivatives with respect to the displacement. The bristle of each stretch begins with its
    /// first recorded sample, at its limit in the direction of its first motion; what is fitted
    /// begins later, when most of that is forgotten. It keeps its deflection while the axis stands.
    fn along(recording: &Conditioned, displacement: f64, damping: bool) -> Self {
        let Conditioned { lived, time_step, pieces, .. } = recording;
        let mut made = Self::default();
        let mut at: Option<(usize, usize, [f64; 2])> = None;
        for piece in pieces {
            let Range { start, end } = piece.origin;
            let (from, [mut z, mut slope]) = match at {
                Some((stretch, done, state)) if stretch == piece.stretch => (done, state),
                _ => (piece.begin, [piece.way, 0.0]),
            };
            for (k, v) in lived.iter().enumerate().take(end).skip(from) {
                let limit = v.signum();
                let way = v.abs() * time_step / displacement;
                let kept = (-way).exp();
                let before = [z, slope];
                slope = (slope + (z - limit) * way / displacement) * kept;
                z = limit + (z - limit) * kept;
                if k < start {
                    continue;
                }
                made.sign.push(z);
                made.sign_slope.push(slope);
                if damping {
                    let moved = [z - before[0], slope - before[1]].map(|by| by / time_step);
                    made.rate.push(displacement * moved[0]);
                    made.rate_slope.push(moved[0] + displacement * moved[1]);
                }
            }
            at = Some((piece.stretch, end, [z, slope]));
        }
        made
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conditioning::{Conditioning, Differences, Signals, condition};

    fn recording() -> Conditioned {
        let time: Vec<f64> = (0..2000).map(|k| f64::from(k) * 1e-3).collect();
        let position: Vec<f64> = time.iter().map(|t| 0.3 * (4.0 * t).sin()).collect();
        let force = vec![1.0; time.len()];
        let signals =
            Signals { time_step: 1e-3, position: Some(&position), velocity: None, force: &force };
        let how = Conditioning {
            differences: Differences::SecondOrder,
            ..Conditioning::for_time_step(1e-3)
        };
        condition(&signals, &how).unwrap()
    }

    /// The derivatives against central differences of the friction itself.
    #[test]
    fn derivatives_are_those_of_the_friction() {
        let recording = recording();
        let structure: AxisStructure = "asymmetric+stribeck+damping".parse().unwrap();
        let levels =
            Levels { kinetic: [3.0, 4.0], rest: [5.0, 3.5], along: [0.4, -0.2], damping: 5.0 };
        let place: Vec<f64> =
            recording.position.iter().flatten().map(|position| position / 0.3).collect();
        let at = |v_s: f64, displacement: f64| {
            let shape = Shape { delay: 0.0, v_s, displacement, period: 1.0 };
            FrictionCurve::of(&recording, &structure, &shape)
        };
        let friction = |curve: &FrictionCurve| -> Vec<f64> {
            (0..curve.sign.len())
                .map(|k| {
                    let (sign, near, x) = (curve.sign[k], curve.near[k], place[k]);
                    let side = usize::from(sign < 0.0);
                    let level = levels.kinetic[side] * (1.0 - near) + levels.rest[side] * near;
                    let along = levels.along[0] * x + levels.along[1] * x * x;
                    sign * (level + along) + levels.damping * curve.rate[k]
                })
                .collect()
        };
        let (v_s, displacement) = (0.2, 0.01);
        let curve = at(v_s, displacement);
        for (slope, before, after, width) in [
            (
                curve.by_velocity(&levels),
                at(v_s - 1e-5, displacement),
                at(v_s + 1e-5, displacement),
                2e-5,
            ),
            (
                curve.by_displacement(&levels, &place),
                at(v_s, displacement - 1e-6),
                at(v_s, displacement + 1e-6),
                2e-6,
            ),
        ] {
            let largest = slope.iter().fold(0.0f64, |most, x| most.max(x.abs()));
            assert!(largest > 1.0, "{largest}");
            for (k, (a, b)) in friction(&before).iter().zip(friction(&after)).enumerate() {
                let central = (b - a) / width;
                assert!((slope[k] - central).abs() < 1e-3 * largest, "{k}: {} {central}", slope[k]);
            }
        }
    }

    /// A reversal 30 ms after the first sample, in what the trim takes off: the bristle of the first
    /// kept sample is still deflected the other way.
    #[test]
    fn a_bristle_lives_through_what_is_trimmed_off() {
        const REACH: f64 = 0.02;
        for (dt, decimate, thinned) in [(1e-3, 10, false), (2e-4, 100, true)] {
            let count = (2.0 / dt) as usize;
            let angle = |k: f64| 4.0 * (k * dt - 0.03) + std::f64::consts::FRAC_PI_2;
            let position: Vec<f64> = (0..count).map(|k| 0.3 * angle(k as f64).sin()).collect();
            let force = vec![1.0; count];
            let signals =
                Signals { time_step: dt, position: Some(&position), velocity: None, force: &force };
            let trim = (0.05 / dt) as usize;
            let how = Conditioning { trim, decimate, ..Conditioning::for_time_step(dt) };
            let fine = condition(&signals, &how).unwrap();
            let recording = fine.clone().coarsened().unwrap();
            assert_eq!(recording.time_step > fine.time_step, thinned);
            let structure: AxisStructure = "symmetric+presliding".parse().unwrap();
            let shape = Shape { delay: 0.0, v_s: 1.0, displacement: REACH, period: 1.0 };
            let curve = FrictionCurve::of(&recording, &structure, &shape);
            let factor = (recording.time_step / dt).round() as usize;
            let mut z = 1.0f64;
            for k in 1..trim + (0.5 / dt) as usize {
                let moved = position[k] - position[k - 1];
                z = moved.signum() + (z - moved.signum()) * (-moved.abs() / REACH).exp();
                if k >= trim && (k - trim).is_multiple_of(factor) {
                    let here = curve.sign[(k - trim) / factor];
                    assert!((here - z).abs() < 0.05, "{dt} s, sample {k}: {here} {z}");
                }
            }
        }
    }
}
