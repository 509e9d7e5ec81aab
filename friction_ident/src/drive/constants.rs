//! What is known of a motor beforehand.

use serde::Serialize;

use crate::Uncertain;

/// How volts are turned into torque.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Calibration {
    /// The motor's constants: A K_m \[N m/A\] and R_a \[Ohm\]. They also tell back-EMF from viscous
    /// friction.
    Motor {
        /// Gear ratio times torque constant.
        torque_constant: Uncertain,
        /// Armature resistance.
        resistance: Uncertain,
    },
    /// Force or torque per volt \[N/V or N m/V\], of a current-controlled or otherwise calibrated
    /// drive.
    ForcePerVolt(Uncertain),
}

impl Calibration {
    /// Force or torque per volt at rest \[N/V or N m/V\], errors propagated.
    pub fn force_per_volt(&self) -> Uncertain {
        match self {
            Self::ForcePerVolt(known) => *known,
            Self::Motor { torque_constant, resistance } => {
                let value = torque_constant.value / resistance.value;
                let variance = |of: &Uncertain| (of.standard_error / of.value).powi(2);
                let relative = variance(torque_constant) + variance(resistance);
                Uncertain { value, standard_error: value.abs() * relative.sqrt() }
            }
        }
    }
}
