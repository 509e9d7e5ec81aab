//! What an estimator believes of the drive.

use ::parameters::{ValueRange, parameters};
use friction_model::Motor;
use serde::{Deserialize, Serialize};

parameters! {
    /// The linear drive `T w' + w = K (u - r F)`, as far as it is known; `r` is `R_a / (A K_m)`.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct NominalDrive {
        gain: f64, "Velocity gain K that is believed of the drive", unit("rad/s per V"),
            range(ValueRange::POSITIVE);
        time_constant: f64, "Time constant T that is believed of the drive", unit("s"),
            range(ValueRange::POSITIVE);
        volts_per_newton_metre: f64, "Voltage that overcomes 1 N m of friction",
            unit("V/(N m)"), range(ValueRange::POSITIVE);
    }
}

impl NominalDrive {
    /// The SRV-02 with the thesis's time constant (chapter 6, appendix A).
    pub const SRV02: Self = Self::of(&Motor::SRV02);

    /// The drive that `motor` makes.
    #[must_use]
    pub const fn of(motor: &Motor) -> Self {
        Self {
            gain: motor.gain(),
            time_constant: motor.time_constant(),
            volts_per_newton_metre: motor.volts_per_newton_metre(),
        }
    }

    /// Inertia at the load side, `J = r T / K` \[kg m^2\].
    #[must_use]
    pub fn inertia(&self) -> f64 {
        self.time_constant / (self.gain * self.volts_per_newton_metre)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_drive_has_the_inertia_of_its_motor() {
        let error = NominalDrive::SRV02.inertia() / Motor::SRV02.inertia - 1.0;
        assert!(error.abs() < 1e-14, "{error}");
    }
}
