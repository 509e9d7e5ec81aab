//! How friction torque enters the simulated drive.

use friction_model::Motor;
use serde::{Deserialize, Serialize};

/// How friction torque enters the simulated drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FrictionCoupling {
    /// As a torque: 1 N m takes R_a / (A K_m) = 4.8426 V to overcome on the SRV-02.
    #[default]
    Physical,
    /// As the thesis's own simulations behave: N m subtracted from volts, 1 V per N m.
    NewtonMetreAsVolt,
}

impl FrictionCoupling {
    /// Voltage that overcomes 1 N m of friction on `motor` [V/(N m)].
    #[must_use]
    pub const fn volts_per_newton_metre(self, motor: &Motor) -> f64 {
        match self {
            Self::Physical => motor.volts_per_newton_metre(),
            Self::NewtonMetreAsVolt => 1.0,
        }
    }
}
