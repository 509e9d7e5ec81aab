//! The points that a curve is fitted to.

use nalgebra::{DMatrix, DVector};

use super::{SteadyPoint, StribeckValues};
use crate::steady_point::relative_weights;

/// Indices of the parameters.
pub(super) const F_S: usize = 0;
pub(super) const F_C: usize = 1;
pub(super) const V_S: usize = 2;
pub(super) const F_V: usize = 3;

/// The points as columns, with the square roots of their weights.
pub(super) struct Data {
    pub(super) velocity: Vec<f64>,
    pub(super) torque: Vec<f64>,
    pub(super) weight: Vec<f64>,
}

impl Data {
    pub(super) fn new(points: &[SteadyPoint]) -> Self {
        Self {
            velocity: points.iter().map(|point| point.velocity).collect(),
            torque: points.iter().map(|point| point.torque).collect(),
            weight: relative_weights(points),
        }
    }

    pub(super) fn residuals(&self, values: &StribeckValues) -> DVector<f64> {
        let points = self.velocity.iter().zip(&self.torque).zip(&self.weight);
        DVector::from_iterator(
            self.velocity.len(),
            points.map(|((&velocity, torque), weight)| weight * (values.torque(velocity) - torque)),
        )
    }

    pub(super) fn jacobian(&self, values: &StribeckValues, free: &[usize]) -> DMatrix<f64> {
        let gradients: Vec<_> =
            self.velocity.iter().map(|&velocity| values.gradient(velocity)).collect();
        DMatrix::from_fn(gradients.len(), free.len(), |i, j| self.weight[i] * gradients[i][free[j]])
    }

    /// The Jacobian, with `f_s` tied to `f_c` where it is not free.
    pub(super) fn design(&self, values: &StribeckValues, free: &[usize]) -> DMatrix<f64> {
        let mut matrix = self.jacobian(values, free);
        if !free.contains(&F_S)
            && let Some(column) = free.iter().position(|&parameter| parameter == F_C)
        {
            for (i, (velocity, weight)) in self.velocity.iter().zip(&self.weight).enumerate() {
                matrix[(i, column)] = weight * velocity.signum();
            }
        }
        matrix
    }
}
