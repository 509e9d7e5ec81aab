//! The Stribeck curve for a given `v_s`: linear in the dip `f_s - f_c`, in `f_c` and in `f_v`.
//!
//! The columns of `f_c` and `f_v` are the same for every `v_s`; they are made orthonormal once, so
//! that a trial costs one exponential a point and a few sums (variable projection, Golub and
//! Pereyra 1973).

use super::StribeckValues;
use super::data::Data;

/// The points, prepared for many trials of `v_s`.
pub(super) struct Separable {
    /// Speeds.
    speed: Vec<f64>,
    /// Orthonormal columns of `f_c` and `f_v`, and that of the dip without the exponential.
    level: Vec<f64>,
    slope: Vec<f64>,
    /// Column of `f_c` before scaling: `weight sgn v`.
    signed: Vec<f64>,
    /// Torques less their projection on both columns.
    rest: Vec<f64>,
    /// Triangular factor of the two columns: `signed = r11 level`,
    /// `weight v = r12 level + r22 slope`.
    triangle: [f64; 3],
    /// The torques' coordinates along `level` and `slope`.
    along: [f64; 2],
    delta: f64,
    /// `sum rest^2`: the least sum of squares without a dip.
    pub without_dip: f64,
}

/// The best curve for one `v_s`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Trial {
    pub v_s: f64,
    /// Dip `f_s - f_c`, `f_c` and `f_v`.
    pub dip: f64,
    pub f_c: f64,
    pub f_v: f64,
    /// Sum of squares.
    pub sum: f64,
    /// Variances of `f_s`, `f_c` and `f_v` in units of the residual variance, `v_s` held.
    pub variances: [f64; 3],
}

impl Trial {
    /// Whether a friction has such a curve.
    pub fn valid(&self) -> bool {
        self.dip >= 0.0 && self.f_c > 0.0 && self.f_v >= 0.0 && self.dip.is_finite()
    }

    pub fn values(&self, delta: f64) -> StribeckValues {
        StribeckValues {
            f_s: self.f_c + self.dip,
            f_c: self.f_c,
            v_s: self.v_s,
            f_v: self.f_v,
            delta,
        }
    }
}

impl Separable {
    /// `None` where sliding friction and slope cannot be told apart.
    pub fn new(data: &Data, delta: f64) -> Option<Self> {
        let weighted =
            |x: &[f64]| x.iter().zip(&data.weight).map(|(x, w)| w * x).collect::<Vec<_>>();
        let signed: Vec<f64> =
            data.velocity.iter().zip(&data.weight).map(|(v, w)| w * v.signum()).collect();
        let (level, r11) = unit(signed.clone())?;
        let velocity = weighted(&data.velocity);
        let r12 = dot(&level, &velocity);
        let (slope, r22) = unit(less(velocity, &level, r12))?;
        let torque = weighted(&data.torque);
        let along = [dot(&level, &torque), dot(&slope, &torque)];
        let rest = less(less(torque, &level, along[0]), &slope, along[1]);
        let without_dip = dot(&rest, &rest);
        let speed = data.velocity.iter().map(|v| v.abs()).collect();
        Some(Self {
            speed,
            level,
            slope,
            signed,
            rest,
            triangle: [r11, r12, r22],
            along,
            delta,
            without_dip,
        })
    }

    pub fn points(&self) -> usize {
        self.speed.len()
    }

    /// The best curve without a dip.
    pub fn plain(&self) -> Trial {
        let [r11, r12, r22] = self.triangle;
        let f_v = self.along[1] / r22;
        let f_c = (self.along[0] - f_v * r12) / r11;
        let level = (1.0 / r11).powi(2) + (r12 / (r11 * r22)).powi(2);
        let variances = [level, level, (1.0 / r22).powi(2)];
        Trial { v_s: f64::NAN, dip: 0.0, f_c, f_v, sum: self.without_dip, variances }
    }

    /// The best curve for `v_s`; none where the dip has no effect there or cannot be told from the
    /// rest.
    pub fn trial(&self, v_s: f64) -> Option<Trial> {
        let gaussian = self.delta == 2.0;
        let inverse = 1.0 / v_s;
        let (mut on_level, mut on_slope) = (0.0, 0.0);
        let mut column = vec![0.0; self.speed.len()];
        for (i, entry) in column.iter_mut().enumerate() {
            let r = self.speed[i] * inverse;
            let power = if gaussian { r * r } else { r.powf(self.delta) };
            *entry = self.signed[i] * (-power).exp();
            on_level += *entry * self.level[i];
            on_slope += *entry * self.slope[i];
        }
        let (mut norm, mut length, mut along) = (0.0, 0.0, 0.0);
        for (i, entry) in column.iter().enumerate() {
            let clear = entry - on_level * self.level[i] - on_slope * self.slope[i];
            length += entry * entry;
            norm += clear * clear;
            along += clear * self.rest[i];
        }
        // The rest of the column is rounding.
        if !(norm > 1e-20 * length && norm > 0.0) {
            return None;
        }
        let [r11, r12, r22] = self.triangle;
        let dip = along / norm;
        let f_v = (self.along[1] - dip * on_slope) / r22;
        let f_c = (self.along[0] - dip * on_level - f_v * r12) / r11;
        // Rows of the inverse triangle of [level, slope, dip].
        let slope_by_dip = -on_slope / r22;
        let level_by_slope = -r12 / (r11 * r22);
        let level_by_dip = (-on_level - slope_by_dip * r12) / r11;
        let level = (1.0 / r11).powi(2) + level_by_slope * level_by_slope;
        let variances = [
            level + (1.0 + level_by_dip).powi(2) / norm,
            level + level_by_dip * level_by_dip / norm,
            (1.0 / r22).powi(2) + slope_by_dip * slope_by_dip / norm,
        ];
        let sum = (self.without_dip - dip * along).max(0.0);
        Some(Trial { v_s, dip, f_c, f_v, sum, variances })
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `x - factor * direction`.
fn less(mut x: Vec<f64>, direction: &[f64], factor: f64) -> Vec<f64> {
    x.iter_mut().zip(direction).for_each(|(x, d)| *x -= factor * d);
    x
}

/// `x` made one long, and its length; none where it has none.
fn unit(mut x: Vec<f64>) -> Option<(Vec<f64>, f64)> {
    let before = dot(&x, &x);
    let length = before.sqrt();
    x.iter_mut().for_each(|x| *x /= length);
    (length > 0.0 && length.is_finite()).then_some((x, length))
}
