//! What is known of a motor beforehand.

use serde::Serialize;

/// A number with its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Known {
    /// The number.
    pub value: f64,
    /// Its standard error; zero where it is exact.
    pub standard_error: f64,
}

impl Known {
    /// A number without an error.
    pub const fn exact(value: f64) -> Self {
        Self { value, standard_error: 0.0 }
    }

    fn relative_variance(&self) -> f64 {
        (self.standard_error / self.value).powi(2)
    }
}

/// How volts are turned into torque.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Calibration {
    /// The motor's constants: A K_m \[N m/A] and R_a \[Ohm]. They also tell back-EMF from viscous
    /// friction.
    Motor {
        /// Gear ratio times torque constant.
        torque_constant: Known,
        /// Armature resistance.
        resistance: Known,
    },
    /// Force or torque per volt \[N/V or N m/V], of a current-controlled or otherwise calibrated
    /// drive.
    ForcePerVolt(Known),
}

impl Calibration {
    /// Force or torque per volt at rest \[N/V or N m/V], errors propagated.
    pub fn force_per_volt(&self) -> Known {
        match self {
            Self::ForcePerVolt(known) => *known,
            Self::Motor { torque_constant, resistance } => {
                let value = torque_constant.value / resistance.value;
                let relative = torque_constant.relative_variance() + resistance.relative_variance();
                Known { value, standard_error: value.abs() * relative.sqrt() }
            }
        }
    }
}
