//! Friction along a recording but for its levels: direction and nearness to rest, sample by sample,
//! with their derivatives.

use super::AxisStructure;
use super::bristle::{Bristle, Lag};
use super::dip::dip;
use super::shape::Shape;
use crate::conditioning::Conditioned;

/// What friction is made of at each sample of a recording.
#[derive(Debug, Clone, Default)]
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
    /// One at rest and zero far from it; empty without a Stribeck curve, and where it lags.
    near: Vec<f64>,
    /// Derivative of that with respect to the Stribeck velocity.
    near_slope: Vec<f64>,
    /// What is left of where a bristle began, and its derivative with respect to the displacement;
    /// empty without a bristle.
    pub left: [Vec<f64>; 2],
    /// What it is instead where the bristle's limit follows the dip.
    lag: Option<Lag>,
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

impl Levels {
    /// The kinetic level in the direction of `sign`, where the position is `place`, from -1 to 1.
    fn kinetic_at(&self, sign: f64, place: Option<&f64>) -> f64 {
        let x = place.copied().unwrap_or(0.0);
        self.kinetic[usize::from(sign < 0.0)] + self.along[0] * x + self.along[1] * x * x
    }
}

impl FrictionCurve {
    pub fn of(recording: &Conditioned, structure: &AxisStructure, shape: &Shape) -> Self {
        if structure.lag {
            let (bristle, lag) = Bristle::lugre(recording, shape, structure.damping);
            return Self { lag: Some(lag), ..Self::from(bristle) };
        }
        let bristle = if structure.presliding {
            Bristle::dahl(recording, shape.displacement, structure.damping)
        } else {
            let floor = recording.velocity_floor;
            let sign = recording.velocity.iter().map(|&v| direction(v, floor)).collect();
            Bristle { sign, ..Bristle::default() }
        };
        let velocity: &[f64] = if structure.stribeck { &recording.velocity } else { &[] };
        let (near, near_slope) = velocity.iter().map(|v| dip(*v, shape.v_s)).unzip();
        Self { near, near_slope, ..Self::from(bristle) }
    }

    /// What the kinetic level and that at rest are multiplied by; none without a Stribeck curve.
    ///
    /// Where it lags, the derivatives of the force with respect to both: it is of the first degree in
    /// them.
    pub fn levels(&self) -> Option<[Vec<f64>; 2]> {
        if let Some(lag) = &self.lag {
            let by_ratio = lag.force_by_ratio();
            let both = self.sign.iter().zip(&by_ratio);
            let kinetic = both.map(|(sign, by_ratio)| sign - lag.ratio * by_ratio).collect();
            return Some([kinetic, by_ratio]);
        }
        let both = || self.sign.iter().zip(&self.near);
        (!self.near.is_empty()).then(|| {
            [
                both().map(|(sign, near)| sign * (1.0 - near)).collect(),
                both().map(|(sign, near)| sign * near).collect(),
            ]
        })
    }

    /// Derivative of the friction of `levels` with respect to the Stribeck velocity, where `place` is
    /// the position from -1 to 1 (empty where nothing depends on it).
    pub fn by_velocity(&self, levels: &Levels, place: &[f64]) -> Vec<f64> {
        if let Some(lag) = &self.lag {
            let of = |(k, (sign, slope)): (usize, (&f64, &f64))| {
                let damped = lag.rate_by_velocity.get(k).copied().unwrap_or(0.0);
                levels.kinetic_at(*sign, place.get(k)) * slope + levels.damping * damped
            };
            return self.sign.iter().zip(&lag.by_velocity).enumerate().map(of).collect();
        }
        let of = |(sign, slope): (&f64, &f64)| {
            let side = usize::from(*sign < 0.0);
            sign * slope * (levels.rest[side] - levels.kinetic[side])
        };
        self.sign.iter().zip(&self.near_slope).map(of).collect()
    }

    /// The same with respect to the ratio of the levels of a dip that lags.
    pub fn by_ratio(&self, levels: &Levels, place: &[f64]) -> Vec<f64> {
        let Some(lag) = &self.lag else { return vec![0.0; self.sign.len()] };
        let of = |(k, (sign, slope)): (usize, (&f64, &f64))| {
            let damped = lag.rate_by_ratio.get(k).copied().unwrap_or(0.0);
            levels.kinetic_at(*sign, place.get(k)) * slope + levels.damping * damped
        };
        self.sign.iter().zip(&lag.by_ratio).enumerate().map(of).collect()
    }

    /// Derivative of the friction of `levels` with respect to the displacement, where `place` is the
    /// position from -1 to 1 (empty where nothing depends on it).
    pub fn by_displacement(&self, levels: &Levels, place: &[f64]) -> Vec<f64> {
        let Levels { kinetic, rest, along, damping } = levels;
        let of = |(k, (sign, slope)): (usize, (&f64, &f64))| {
            let side = usize::from(*sign < 0.0);
            // Where the dip lags, it is part of the slope.
            let near = self.near.get(k).copied().unwrap_or(0.0);
            let x = place.get(k).copied().unwrap_or(0.0);
            let level = kinetic[side] * (1.0 - near) + rest[side] * near;
            let damped = damping * self.rate_slope.get(k).copied().unwrap_or(0.0);
            slope * (level + along[0] * x + along[1] * x * x) + damped
        };
        self.sign.iter().zip(&self.sign_slope).enumerate().map(of).collect()
    }
}

impl From<Bristle> for FrictionCurve {
    fn from(bristle: Bristle) -> Self {
        let Bristle { sign, sign_slope, rate, rate_slope, left, left_slope } = bristle;
        Self { sign, sign_slope, rate, rate_slope, left: [left, left_slope], ..Self::default() }
    }
}

/// The sign of a velocity, zero where it is none but for rounding.
fn direction(v: f64, floor: f64) -> f64 {
    if v.abs() <= floor { 0.0 } else { v.signum() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conditioning::{Conditioning, Differences, Signals, condition};

    fn recording() -> Conditioned {
        let time: Vec<f64> = (0..2000).map(|k| f64::from(k) * 1e-3).collect();
        let position: Vec<f64> = time.iter().map(|t| 0.3 * (4.0 * t).sin()).collect();
        let force = vec![1.0; time.len()];
        let signals = Signals {
            time_step: 1e-3,
            position: Some(&position),
            readings: None,
            velocity: None,
            force: &force,
        };
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
        let place: Vec<f64> =
            recording.position.iter().flatten().map(|position| position / 0.3).collect();
        for (name, kinetic, rest) in [
            ("asymmetric+stribeck+damping", [3.0, 4.0], [5.0, 3.5]),
            ("symmetric+damping+lag", [3.0; 2], [6.0; 2]),
        ] {
            let structure: AxisStructure = name.parse().unwrap();
            let levels = Levels { kinetic, rest, along: [0.4, -0.2], damping: 5.0 };
            let at = |v_s: f64, displacement: f64, rest: f64| {
                let (ratio, damped) = (rest / kinetic[0], levels.damping / kinetic[0]);
                let shape = Shape { v_s, displacement, ratio, damped, ..Shape::UNUSED };
                FrictionCurve::of(&recording, &structure, &shape)
            };
            let friction = |curve: &FrictionCurve, levels: &Levels| -> Vec<f64> {
                let [of_kinetic, of_rest] = curve.levels().unwrap();
                let force = |k: usize| {
                    let (sign, x) = (curve.sign[k], place[k]);
                    let side = usize::from(sign < 0.0);
                    let along = levels.along[0] * x + levels.along[1] * x * x;
                    let level =
                        levels.kinetic[side] * of_kinetic[k] + levels.rest[side] * of_rest[k];
                    level + sign * along + levels.damping * curve.rate[k]
                };
                (0..curve.sign.len()).map(force).collect()
            };
            let (v_s, displacement, f_s) = (0.2, 0.01, rest[0]);
            let curve = at(v_s, displacement, f_s);
            let with = |f_s: f64| Levels { rest: [f_s; 2], along: [0.0; 2], ..levels };
            let mut all = vec![
                (
                    curve.by_velocity(&levels, &place),
                    friction(&at(v_s - 1e-5, displacement, f_s), &levels),
                    friction(&at(v_s + 1e-5, displacement, f_s), &levels),
                    2e-5,
                ),
                (
                    curve.by_displacement(&levels, &place),
                    friction(&at(v_s, displacement - 1e-6, f_s), &levels),
                    friction(&at(v_s, displacement + 1e-6, f_s), &levels),
                    2e-6,
                ),
            ];
            if structure.lag {
                let tied = |f_s: f64| {
                    friction(&at(v_s, displacement, f_s), &Levels { rest: [f_s; 2], ..levels })
                };
                let (less, more) = (f_s - 1e-4, f_s + 1e-4);
                let by_ratio = curve.by_ratio(&levels, &place);
                all.push((by_ratio, tied(less), tied(more), 2e-4 / kinetic[0]));
                // The force is of the first degree in both levels, damping kept: it is its own
                // derivatives.
                let of_rest = curve.levels().unwrap()[1].clone();
                let (less, more) = (f_s - 1e-4, f_s + 1e-4);
                let before = friction(&at(v_s, displacement, less), &with(less));
                let after = friction(&at(v_s, displacement, more), &with(more));
                all.push((of_rest, before, after, 2e-4));
            }
            for (slope, before, after, width) in all {
                let largest = slope.iter().fold(0.0f64, |most, x| most.max(x.abs()));
                assert!(largest > 0.1, "{largest}");
                for (k, (a, b)) in before.iter().zip(&after).enumerate() {
                    let central = (b - a) / width;
                    let near = (slope[k] - central).abs() < 1e-3 * largest;
                    assert!(near, "{name}, {k}: {} {central}", slope[k]);
                }
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
            let signals = Signals {
                time_step: dt,
                position: Some(&position),
                readings: None,
                velocity: None,
                force: &force,
            };
            let trim = (0.05 / dt) as usize;
            let how = Conditioning { trim, decimate, ..Conditioning::for_time_step(dt) };
            let fine = condition(&signals, &how).unwrap();
            let recording = fine.clone().coarsened().unwrap();
            assert_eq!(recording.time_step > fine.time_step, thinned);
            let structure: AxisStructure = "symmetric+presliding".parse().unwrap();
            let shape = Shape { displacement: REACH, ..Shape::UNUSED };
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
