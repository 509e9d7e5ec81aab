//! The drive without friction, as designs see it.

use ::parameters::{ValueRange, parameters};
use friction_model::Motor;
use serde::{Deserialize, Serialize};

parameters! {
    /// The linear drive from volts to velocity: `T w' + w = K u` (thesis chapter 6 and appendix A).
    #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
    pub struct LinearDrive {
        gain: f64, "Velocity gain K of the drive, for its inverse", unit("rad/s per V"),
            range(ValueRange::POSITIVE);
        time_constant: f64, "Time constant T of the drive, for its inverse", unit("s"),
            range(ValueRange::POSITIVE);
    }
}

impl LinearDrive {
    /// The SRV-02 as the thesis rounds it for its designs: K = 1.863 rad/s per V, T = 0.02388 s.
    pub const THESIS: Self = Self { gain: 1.863, time_constant: 0.02388 };

    /// The drive that `motor` makes.
    #[must_use]
    pub const fn of(motor: &Motor) -> Self {
        Self { gain: motor.gain(), time_constant: motor.time_constant() }
    }

    /// `|K / (j w T + 1)|` at `w` \[rad/s\].
    #[must_use]
    pub fn magnitude(&self, w: f64) -> f64 {
        self.gain / (1.0 + (w * self.time_constant).powi(2)).sqrt()
    }
}
