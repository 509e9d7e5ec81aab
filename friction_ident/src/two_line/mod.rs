//! Two straight lines through steady points, by linear least squares in two regions.
//!
//! In each region the friction is linear in its parameters, `F = Phi^T xi` with `Phi = [a, b]` and
//! `xi = [sgn v, v]` (thesis eq. 2.14). The lines must meet where the regions do, at the switch
//! speed, or friction would jump.
//!
//! The least sum of squares is found by scanning the breakpoint over the measured speeds (Hudson
//! 1966). With the break between two neighbouring speeds the regions are fitted apart; if those
//! lines meet between the two speeds, that is the best curve with this break. Otherwise the best
//! one near by bends at a measured speed itself, and is linear in three parameters there. Each
//! region keeps at least three speeds, since two always lie on a line. A second line that would
//! fall is held level (`b2 = 0`): falling on, it would push at high speeds.
//!
//! Standard errors come from the scatter around the lines, the points of each region taken for
//! known: right for points that scatter about two lines. A Stribeck curve is no two lines, and its
//! bend counts as scatter here. The best lines through it are not its tangents either: they bend
//! later and start lower, so that `a1` is below the breakaway level unless most points are slow.

use friction_model::{FrictionModel, TwoLine, TwoLineParameters};
use serde::Serialize;

use crate::statistics::student_95;

mod fit;
#[cfg(test)]
mod tests;

pub use fit::fit_two_line;

/// A fitted two-line model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TwoLineFit {
    /// The model with the best parameters.
    pub model: TwoLine,
    /// Standard errors of `a1`, `b1`, `a2`, `b2`; none for a `b2` that is held at zero.
    pub standard_errors: [Option<f64>; 4],
    /// Standard error of the switch speed \[rad/s or m/s\].
    pub switch_speed_error: f64,
    /// Mean square of the residual, sum of squares over the number of points \[(N m)^2 or N^2\].
    pub mse: f64,
    /// Points fitted.
    pub points: usize,
    /// Points minus free parameters.
    pub degrees_of_freedom: usize,
    /// Slowest and fastest measured speed.
    pub speeds: (f64, f64),
}

impl TwoLineFit {
    /// The best parameters.
    pub fn parameters(&self) -> &TwoLineParameters {
        self.model.parameters()
    }

    /// Friction of the fitted lines at a velocity, zero at zero.
    pub fn torque(&self, velocity: f64) -> f64 {
        self.model.steady_state(velocity)
    }

    /// The 95 % intervals of `a1`, `b1`, `a2`, `b2`; none for a `b2` that is held at zero.
    pub fn intervals(&self) -> [Option<(f64, f64)>; 4] {
        let TwoLineParameters { a1, b1, a2, b2 } = *self.parameters();
        let values = [a1, b1, a2, b2];
        let factor = student_95(self.degrees_of_freedom);
        std::array::from_fn(|i| {
            self.standard_errors[i]
                .map(|error| (values[i] - factor * error, values[i] + factor * error))
        })
    }

    /// The 95 % interval of the switch speed.
    pub fn switch_speed_interval(&self) -> (f64, f64) {
        let half = student_95(self.degrees_of_freedom) * self.switch_speed_error;
        (self.model.switch_speed() - half, self.model.switch_speed() + half)
    }
}
