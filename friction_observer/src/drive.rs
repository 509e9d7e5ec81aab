//! What an estimator believes of the drive.

use serde::{Deserialize, Serialize};

use crate::ObserverError;
use crate::error::positive;

/// The linear drive `T w' + w = K (u - r F)`, as far as it is known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NominalDrive {
    /// Velocity gain K [rad/s per V], above zero.
    pub gain: f64,
    /// Time constant T [s], above zero.
    pub time_constant: f64,
    /// Voltage that overcomes 1 N m of friction, r = `R_a / (A K_m)` [V/(N m)], above zero.
    pub volts_per_newton_metre: f64,
}

impl NominalDrive {
    /// The SRV-02 with the thesis's time constant (chapter 6, appendix A).
    pub const SRV02: Self =
        Self { gain: 1.862_545, time_constant: 0.023_88, volts_per_newton_metre: 4.842_615 };

    /// Inertia at the load side, `J = r T / K` [kg m^2].
    #[must_use]
    pub fn inertia(&self) -> f64 {
        self.time_constant / (self.gain * self.volts_per_newton_metre)
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`ObserverError::OutOfRange`] names the field.
    pub fn check(&self) -> Result<(), ObserverError> {
        positive("gain", self.gain)?;
        positive("time_constant", self.time_constant)?;
        positive("volts_per_newton_metre", self.volts_per_newton_metre)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// K = 1/(A Km), r = Ra/(A Km), T = Ra J/(A Km)^2 of the data sheet: J = 2.64757e-3 kg m^2.
    #[test]
    fn the_srv02_is_consistent() {
        let back_emf = 70.0 * 0.00767;
        assert!((NominalDrive::SRV02.gain - 1.0 / back_emf).abs() < 1e-6);
        assert!((NominalDrive::SRV02.volts_per_newton_metre - 2.6 / back_emf).abs() < 1e-5);
        assert!((NominalDrive::SRV02.inertia() - 2.64757e-3).abs() < 1e-7);
    }
}
