//! Training of a network of radial basis functions on steady points, by linear least squares.
//!
//! `F(v) = sgn(v) [w_0 + sum_i w_i exp(-(|v| - c_i)^2 / (2 b_i^2))]`, odd in the velocity.
//!
//! The centres `c_i` are placed first ([`Centres`]) and each width is the distance between the
//! neighbours: half the distance from the one to the other within, the distance to the only one at
//! the ends. What is left is linear in the weights. Bells that overlap resemble each other, so a
//! small ridge keeps their weights from growing against each other: the sum of squares of the
//! residual plus `ridge` times the sum of squares of the weights is least. It is solved as one
//! stacked problem, not by normal equations, which would square the condition.
//!
//! Centres spaced logarithmically suit friction, which bends at low speeds and is straight at high
//! ones: on the test bed's Stribeck curve they need half the bells of uniform ones. The network
//! knows nothing outside the points: see [`friction_model::RbfNetwork`].

use friction_model::{Elements, FrictionModel, RbfNetwork, RbfNetworkParameters};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use crate::steady_point::{Needed, check_points, relative_weights};
use crate::{IdentError, SteadyPoint, least_squares};

#[cfg(test)]
mod tests;

/// Where the bells stand.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "spacing", rename_all = "snake_case")]
pub enum Centres {
    /// At zero, and from `smallest` to `largest` by a constant factor.
    Logarithmic {
        /// First centre above zero \[rad/s or m/s\].
        smallest: f64,
        /// Last centre \[rad/s or m/s\].
        largest: f64,
    },
    /// From zero to `largest` by a constant distance.
    Uniform {
        /// Last centre \[rad/s or m/s\].
        largest: f64,
    },
}

impl Centres {
    /// `count` centres, at least three.
    fn place(self, count: usize) -> Vec<f64> {
        match self {
            Self::Logarithmic { smallest, largest } => {
                let factor = |i: usize| (largest / smallest).powf(i as f64 / (count - 2) as f64);
                std::iter::once(0.0).chain((0..count - 1).map(|i| smallest * factor(i))).collect()
            }
            Self::Uniform { largest } => {
                (0..count).map(|i| largest * (i as f64 / (count - 1) as f64)).collect()
            }
        }
    }

    fn check(self) -> Result<(), IdentError> {
        let (smallest, largest) = match self {
            Self::Logarithmic { smallest, largest } => (smallest, largest),
            Self::Uniform { largest } => (f64::MIN_POSITIVE, largest),
        };
        let placed = smallest > 0.0 && largest > smallest && largest.is_finite();
        if placed { Ok(()) } else { Err(IdentError::CentreSpan { smallest, largest }) }
    }
}

/// Shape of the network.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RbfOptions {
    /// Number of bells, 3 to 32.
    pub count: usize,
    /// Where they stand.
    pub centres: Centres,
    /// Weight of the ridge, above zero. The bells are pure numbers up to one, and so is this.
    pub ridge: f64,
}

impl Default for RbfOptions {
    /// Ten bells for the speeds of the thesis's test bed, at zero and from 0.05 to 4 rad/s.
    fn default() -> Self {
        Self {
            count: 10,
            centres: Centres::Logarithmic { smallest: 0.05, largest: 4.0 },
            ridge: 1e-10,
        }
    }
}

/// A trained network.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RbfFit {
    /// The network.
    pub network: RbfNetwork,
    /// Mean square of the residual, sum of squares over the number of points \[(N m)^2 or N^2\].
    pub mse: f64,
    /// Points used.
    pub points: usize,
    /// Slowest and fastest measured speed; elsewhere the network extrapolates.
    pub speeds: (f64, f64),
}

impl RbfFit {
    /// Friction of the network at a velocity.
    pub fn torque(&self, velocity: f64) -> f64 {
        self.network.steady_state(velocity)
    }
}

/// Trains a network on steady points of either sign of velocity. Points at rest count for nothing.
///
/// # Errors
/// [`IdentError::CentreCount`], [`IdentError::CentreSpan`] and [`IdentError::Ridge`] for impossible
/// options; [`IdentError::TooFewSamples`] and [`IdentError::TooFewSpeeds`] for fewer points or
/// speeds than there are weights, [`IdentError::NotFinite`], [`IdentError::StandardDeviation`],
/// [`IdentError::MixedDeviations`], [`IdentError::ZeroForce`]; [`IdentError::NotAModel`] for
/// torques that drive instead of braking at standstill or far beyond the last centre,
/// [`IdentError::NoConvergence`] for a ridge too small to tell the bells apart.
pub fn train_rbf_network(
    points: &[SteadyPoint],
    options: &RbfOptions,
) -> Result<RbfFit, IdentError> {
    let RbfOptions { count, centres, ridge } = *options;
    if !(3..=32).contains(&count) {
        return Err(IdentError::CentreCount(count));
    }
    centres.check()?;
    if !(ridge > 0.0 && ridge.is_finite()) {
        return Err(IdentError::Ridge(ridge));
    }
    let needed = Needed {
        what: "a network of radial basis functions",
        points: count + 1,
        speeds: count + 1,
        lower: Some("the number of centres"),
    };
    let speeds = check_points(points, &needed)?;
    let moving: Vec<_> = points.iter().copied().filter(|point| point.velocity != 0.0).collect();
    let weights = relative_weights(&moving);
    let centres = centres.place(count);
    let widths = distances(&centres);

    // Below the points one row for each weight: the ridge.
    let (rows, columns) = (moving.len(), count + 1);
    let bell = |speed: f64, i: usize| (-0.5 * ((speed - centres[i]) / widths[i]).powi(2)).exp();
    let matrix = DMatrix::from_fn(rows + columns, columns, |row, column| {
        if row >= rows {
            return if row - rows == column { ridge.sqrt() } else { 0.0 };
        }
        weights[row] * if column == 0 { 1.0 } else { bell(moving[row].velocity.abs(), column - 1) }
    });
    let torque = DVector::from_fn(rows + columns, |row, _| {
        moving.get(row).map_or(0.0, |point| weights[row] * point.torque * point.velocity.signum())
    });
    let solution = least_squares::solve(&matrix, &torque).map_err(|_| {
        IdentError::NoConvergence("the bells resemble each other: raise the ridge".to_owned())
    })?;

    let list =
        |numbers: &[f64]| Elements::from_fn(count, |i| numbers.get(i).copied().unwrap_or(0.0));
    let network = RbfNetwork::try_from(RbfNetworkParameters {
        w0: solution.x[0],
        weights: list(&solution.x.as_slice()[1..]),
        centres: list(&centres),
        widths: list(&widths),
    })?;
    let squares =
        moving.iter().map(|point| (network.steady_state(point.velocity) - point.torque).powi(2));
    let mse = squares.sum::<f64>() / rows as f64;
    Ok(RbfFit { network, mse, points: rows, speeds })
}

/// The distance between the neighbours of each centre, halved where it has two.
fn distances(centres: &[f64]) -> Vec<f64> {
    let last = centres.len() - 1;
    (0..=last)
        .map(|i| {
            let (below, above) = (i.saturating_sub(1), (i + 1).min(last));
            (centres[above] - centres[below]) / (above - below) as f64
        })
        .collect()
}
