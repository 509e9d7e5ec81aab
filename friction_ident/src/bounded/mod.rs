//! Nonlinear least squares within bounds: Levenberg and Marquardt with projection.
//!
//! Each step solves `(J^T J + mu D) d = -J^T r` over the unknowns that no bound holds (those at a
//! bound whose gradient points outwards are left out), cuts the step to the bounds, and accepts it
//! if the sum of squares falls. `D` is the largest diagonal of `J^T J` seen so far (Moré 1978),
//! `mu` follows the gain ratio (Nielsen 1999). The Jacobian is the problem's own, or forward
//! differences; between accepted steps it may be carried on by Broyden's rank-one update (1965),
//! which saves most of the evaluations where one is expensive.

mod search;
#[cfg(test)]
mod tests;

use nalgebra::{DMatrix, DVector};

pub(crate) use search::lowest;
pub use search::minimise;

/// A sum of squares to be made small.
pub trait Residuals {
    /// Residuals.
    fn len(&self) -> usize;

    /// Whether there is none at all.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Writes the residuals at `x` into `out`, which is as long as [`len`](Self::len). False where
    /// `x` is not allowed; `out` does not count then.
    fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool;

    /// Writes the derivatives of the residuals, one column an unknown, where they are known in
    /// closed form; `residuals` are those at `x`. False leaves them to forward differences.
    fn jacobian(&mut self, _x: &[f64], _residuals: &[f64], _jacobian: &mut DMatrix<f64>) -> bool {
        false
    }
}

/// Where an unknown may lie and how large it usually is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// Lowest value; may be minus infinity.
    pub low: f64,
    /// Highest value; may be infinite.
    pub high: f64,
    /// A usual magnitude, above zero: forward differences never step less than its square root of
    /// the rounding.
    pub scale: f64,
    /// Longest step, above zero; may be infinite. A step that is longer is shortened as a whole.
    pub reach: f64,
}

impl Bound {
    /// Any number, about as large as `scale`.
    pub const fn free(scale: f64) -> Self {
        Self::within(f64::NEG_INFINITY, f64::INFINITY, scale)
    }

    /// From `low` to `high`, about as large as `scale`.
    pub const fn within(low: f64, high: f64, scale: f64) -> Self {
        Self { low, high, scale, reach: f64::INFINITY }
    }

    /// The same with a longest step.
    #[must_use]
    pub const fn reaching(self, reach: f64) -> Self {
        Self { reach, ..self }
    }

    fn clip(&self, value: f64) -> f64 {
        value.max(self.low).min(self.high)
    }
}

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patience {
    /// Relative fall of the sum of squares that no longer counts.
    pub sum: f64,
    /// Relative step that no longer counts.
    pub step: f64,
    /// Jacobians at most.
    pub iterations: usize,
    /// Carry the Jacobian on by Broyden's update between accepted steps.
    pub broyden: bool,
}

impl Default for Patience {
    /// To about the rounding, 100 Jacobians, no updates.
    fn default() -> Self {
        Self { sum: 1e-14, step: 1e-12, iterations: 100, broyden: false }
    }
}

/// Why the search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// No step improves any more by what counts.
    Converged,
    /// The iterations are used up; the best point found is kept.
    OutOfPatience,
    /// The watcher asked for it; the best point found is kept.
    Stopped,
}

/// The best point found.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// The unknowns.
    pub x: Vec<f64>,
    /// The residuals there.
    pub residuals: DVector<f64>,
    /// Their derivatives there.
    pub jacobian: DMatrix<f64>,
    /// Unknowns that a bound holds.
    pub held: Vec<bool>,
    /// Sum of squares.
    pub sum: f64,
    /// How often the residuals were computed, those for differences included.
    pub evaluations: usize,
    /// Why the search ended.
    pub ending: Ending,
}

/// Sum of squares and evaluations so far, for whoever watches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Jacobians so far.
    pub iteration: usize,
    /// Least sum of squares so far.
    pub sum: f64,
}
