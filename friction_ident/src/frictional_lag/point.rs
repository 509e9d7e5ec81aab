//! One point of the search: the best linear unknowns there, and which way is down.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

use super::pass::Sums;
use crate::finite::finite;

/// What the sums say at one point.
pub(super) struct Point {
    /// `f_c`, dip, `f_v`, less the baseline.
    pub linear: Vector3<f64>,
    /// Sum of squares.
    pub sum: f64,
    /// Sensitivities of the linear unknowns to the logarithms, and the projected normal equations.
    pub tilt: [Vector3<f64>; 2],
    pub normal: Matrix2<f64>,
    pub gradient: Vector2<f64>,
    pub sums: Sums,
}

impl Point {
    /// `None` where the three linear unknowns cannot be told apart.
    pub fn new(sums: Sums) -> Option<Self> {
        let matrix = Matrix3::from_fn(|i, j| sums.linear[i][j]);
        // Scaled to a unit diagonal.
        let root = matrix.diagonal().map(f64::sqrt);
        let scaled = Matrix3::from_fn(|i, j| matrix[(i, j)] / (root[i] * root[j]));
        let factor = finite(scaled)?.cholesky()?;
        let solve =
            |right: Vector3<f64>| factor.solve(&right.component_div(&root)).component_div(&root);
        let torque = Vector3::from(sums.torque);
        let linear = solve(torque);
        if !linear.iter().all(|x| x.is_finite()) {
            return None;
        }
        let sum = (sums.yy - linear.dot(&torque)).max(0.0);
        let by = sums.by.map(Vector3::from);
        let tilt = by.map(solve);
        let dip = linear[1];
        let normal = Matrix2::from_fn(|i, j| dip * dip * (sums.by_by[i][j] - by[i].dot(&tilt[j])));
        let gradient = Vector2::from_fn(|i, _| dip * (sums.by_torque[i] - by[i].dot(&linear)));
        Some(Self { linear, sum, tilt, normal, gradient, sums })
    }
}
