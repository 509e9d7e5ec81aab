//! Ends against which a shaft runs.
//!
//! At either end the shaft meets a stiff, damped spring that pushes and never pulls.

use serde::{Deserialize, Serialize};

/// Where the shaft is stopped \[rad\], by its true position; it begins at zero.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stops {
    /// Lower end, below zero.
    pub low: f64,
    /// Upper end, above zero.
    pub high: f64,
}

/// Frequency at which the shaft would bounce on a stop \[Hz\], and its share of critical damping.
const FREQUENCY: f64 = 80.0;
const DAMPING: f64 = 0.4;

impl Stops {
    /// Torque on a shaft of that inertia at that position and velocity [N m].
    pub(crate) fn torque(&self, inertia: f64, position: f64, velocity: f64) -> f64 {
        let beyond = self.beyond(position);
        let stiff = std::f64::consts::TAU * FREQUENCY;
        let torque = -inertia * (stiff * stiff * beyond + 2.0 * DAMPING * stiff * velocity);
        // A stop does not pull.
        if beyond > 0.0 {
            torque.min(0.0)
        } else if beyond < 0.0 {
            torque.max(0.0)
        } else {
            0.0
        }
    }

    /// How far a position is beyond an end \[rad\].
    pub(crate) fn beyond(&self, position: f64) -> f64 {
        position - position.clamp(self.low, self.high)
    }

    /// Whether they can be.
    pub(crate) fn is_sound(&self) -> bool {
        self.low < 0.0 && self.high > 0.0 && self.low.is_finite() && self.high.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shaft_that_runs_into_a_stop_comes_back_slower_and_is_let_go() {
        let stops = Stops { low: -1.0, high: 0.5 };
        assert_eq!(stops.torque(1e-3, 0.4, 9.0), 0.0);
        let (mut x, mut v, h) = (0.49, 3.0, 1e-5);
        let mut farthest = 0.0_f64;
        for _ in 0..20_000 {
            v += h * stops.torque(1e-3, x, v) / 1e-3;
            x += h * v;
            farthest = farthest.max(x);
        }
        assert!(farthest < 0.51 && v < 0.0 && v > -1.5, "{farthest} {v}");
    }
}
