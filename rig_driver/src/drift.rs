//! Friction that drifts while the rig runs, as lubricant warms up or wears.

use serde::{Deserialize, Serialize};

use crate::RigError;

/// A factor on the friction torque that goes from 1 to `1 + change`, linearly in time, and stays
/// there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionDrift {
    /// Relative change at the end, from -0.9 to 9: 0.3 for 30 % more friction.
    pub change: f64,
    /// When it begins \[s\], zero or more.
    pub start: f64,
    /// How long it takes \[s\], above zero.
    pub duration: f64,
}

impl FrictionDrift {
    /// The factor at `time` \[s\].
    #[inline]
    #[must_use]
    pub fn factor(&self, time: f64) -> f64 {
        1.0 + self.change * ((time - self.start) / self.duration).clamp(0.0, 1.0)
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`RigError::OutOfRange`] names the field.
    pub fn check(&self) -> Result<(), RigError> {
        let error = |name, value, expected: &'static str| {
            Err(RigError::OutOfRange { name, value, expected: expected.into() })
        };
        if !(-0.9..=9.0).contains(&self.change) {
            return error("friction_drift.change", self.change, "from -0.9 to 9");
        }
        if !(self.start >= 0.0 && self.start.is_finite()) {
            return error("friction_drift.start", self.start, "a finite time, zero or more");
        }
        if !(self.duration > 0.0 && self.duration.is_finite()) {
            return error("friction_drift.duration", self.duration, "a finite time above zero");
        }
        Ok(())
    }
}
