//! Hysteresis operators of unit level: torque over level along a path.

use std::f64::consts::PI;

use friction_model::{Hysteresis, Sine};

/// A rate-independent operator that rises to one; its lengths are in the unit of the displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Operator {
    /// The proposed model: sine of quarter period `z_b`. One length: `z_b`.
    Sine,
    /// LuGre: `du/dx = (1 - sgn(dx) u) / l`. One length: `l = f_s / sigma0`.
    Exponential,
    /// Dahl: `du/dx = (1 - sgn(dx) u)^delta / l`. One length: `l = f_c / sigma0`.
    Power {
        /// Exponent.
        delta: f64,
    },
    /// Elasto-plastic: elastic up to `z_ba`, sliding from `l` on. Two lengths: `l = f_s / sigma0`
    /// and `z_ba`.
    ElastoPlastic,
}

/// Longest move of a normalised plastic deflection that one step of Runge and Kutta covers.
const PLASTIC_STEP: f64 = 0.05;

impl Operator {
    /// How many lengths it has.
    pub fn lengths(&self) -> usize {
        if *self == Self::ElastoPlastic { 2 } else { 1 }
    }

    /// Torque over level at every displacement of a path from the unloaded contact, into `out`,
    /// which is as long. False where the lengths are not allowed.
    pub fn run(&self, lengths: &[f64], path: &[f64], out: &mut [f64]) -> bool {
        let positive =
            |&length: &f64| length > 0.0 && length.is_finite() && (1.0 / length).is_finite();
        match (self, lengths) {
            (Self::Sine, [z_b]) if positive(z_b) => {
                let curve = Sine::new(1.0, *z_b);
                let mut memory = Hysteresis::default();
                // The bristle slips at +-z_b; the memory clamps it there.
                along(path, out, |dx| memory.commit(&curve, memory.deflection() + dx));
            }
            (Self::Exponential, [length]) if positive(length) => {
                let (mut u, inverse) = (0.0, 1.0 / length);
                along(path, out, |dx: f64| {
                    let end = 1.0f64.copysign(dx);
                    u = end + (u - end) * (-(dx * inverse).abs()).exp();
                    u
                });
            }
            (Self::Power { delta }, [length]) if positive(length) => {
                let mut u: f64 = 0.0;
                along(path, out, |dx: f64| {
                    let end = 1.0f64.copysign(dx);
                    // w = 1 - sgn u is never negative: u starts between the ends.
                    u = end
                        * (1.0 - remaining((1.0 - end * u).max(0.0), (dx / length).abs(), *delta));
                    u
                });
            }
            (Self::ElastoPlastic, [length, z_ba])
                if positive(length) && *z_ba > 0.0 && z_ba < length =>
            {
                let (mut u, elastic) = (0.0, z_ba / length);
                along(path, out, |dx| {
                    u = elasto_plastic(u, dx / length, elastic);
                    u
                });
            }
            _ => return false,
        }
        true
    }
}

/// Runs `step` over the moves of a path that starts at zero; samples at rest keep their value.
fn along(path: &[f64], out: &mut [f64], mut step: impl FnMut(f64) -> f64) {
    let (mut before, mut value) = (0.0, 0.0);
    for (&x, out) in path.iter().zip(out) {
        if x != before {
            value = step(x - before);
            before = x;
        }
        *out = value;
    }
}

/// What is left of `w` with `w' = -w^delta` after a travel.
fn remaining(w: f64, travel: f64, delta: f64) -> f64 {
    let e = 1.0 - delta;
    if e == 0.0 {
        return w * (-travel).exp();
    }
    let left = w.powf(e) - e * travel;
    if left > 0.0 { left.powf(1.0 / e) } else { 0.0 }
}

/// The normalised deflection after a move `d`: elastic inwards and up to `elastic`, then
/// `u' = 1 - alpha(u) u`.
fn elasto_plastic(u: f64, d: f64, elastic: f64) -> f64 {
    let side = 1.0f64.copysign(d);
    let (mut outward, mut left) = (side * u, d.abs());
    if outward < elastic {
        let spring = left.min(elastic - outward);
        outward += spring;
        left -= spring;
    }
    if left > 0.0 {
        let middle = 0.5 * (1.0 + elastic);
        let slope = |u: f64| {
            let alpha = if u >= 1.0 {
                1.0
            } else {
                0.5 + 0.5 * (PI * (u - middle) / (1.0 - elastic)).sin()
            };
            1.0 - alpha * u
        };
        let steps = (left / (PLASTIC_STEP * (1.0 - elastic).max(0.02))).ceil().min(10_000.0);
        let h = left / steps;
        for _ in 0..steps as usize {
            let a = slope(outward);
            let b = slope(outward + 0.5 * h * a);
            let c = slope(outward + 0.5 * h * b);
            let e = slope(outward + h * c);
            outward = (outward + h / 6.0 * (a + 2.0 * b + 2.0 * c + e)).min(1.0);
        }
    }
    side * outward
}
