//! The geared DC servo: a first-order drive with friction.
//!
//! ```text
//! J_eq w' = (A K_m / R_a) (u - A K_m w) - F            (thesis appendix A)
//! T w' + w = K (u - (R_a / (A K_m)) F),   K = 1 / (A K_m),   T = R_a J_eq / (A K_m)^2
//! ```
//!
//! All quantities at the load side of the gear: position [rad], velocity `w` [rad/s], friction `F`
//! [N m].

use serde::{Deserialize, Serialize};

use crate::RigError;

/// Parameters of a drive as files carry them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveParameters {
    /// Motor torque constant, equal to the back-EMF constant, K_m [N m/A], above zero.
    pub motor_constant: f64,
    /// Gear ratio A from motor to load, above zero.
    pub gear_ratio: f64,
    /// Armature resistance R_a [ohm], above zero.
    pub armature_resistance: f64,
    /// Inertia at the load side J_eq [kg m^2], above zero.
    pub inertia: f64,
}

/// Which of the thesis's two time constants of the SRV-02 is meant: its chapter 6 and its appendix
/// A disagree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TimeConstant {
    /// T = 0.02388 s, with which the thesis designed its controllers; it needs `J_eq` = 2.6476e-3
    /// kg m^2.
    #[default]
    Thesis,
    /// T = 0.01734 s, from the data sheet's inertias: `J_eq = J_l + A^2 J_m` = 1.92288e-3 kg m^2.
    Datasheet,
}

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

/// A drive with valid parameters.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "DriveParameters", into = "DriveParameters")]
pub struct Drive {
    parameters: DriveParameters,
}

impl Drive {
    /// The Quanser SRV-02 of the thesis's test bed.
    #[must_use]
    pub fn srv02(time_constant: TimeConstant) -> Self {
        let (motor_constant, gear_ratio, armature_resistance) = (0.007_67, 70.0, 2.6);
        let inertia = match time_constant {
            TimeConstant::Datasheet => 2.6583e-5 + gear_ratio * gear_ratio * 3.87e-7,
            TimeConstant::Thesis => {
                let back_emf: f64 = gear_ratio * motor_constant;
                0.02388 * back_emf * back_emf / armature_resistance
            }
        };
        Self {
            parameters: DriveParameters {
                motor_constant,
                gear_ratio,
                armature_resistance,
                inertia,
            },
        }
    }

    /// The parameters.
    #[must_use]
    pub const fn parameters(&self) -> &DriveParameters {
        &self.parameters
    }

    /// Velocity gain K [rad/s per V].
    #[must_use]
    pub fn gain(&self) -> f64 {
        1.0 / self.back_emf()
    }

    /// Time constant T [s].
    #[must_use]
    pub fn time_constant(&self) -> f64 {
        self.parameters.armature_resistance * self.parameters.inertia / self.back_emf().powi(2)
    }

    /// Voltage that overcomes 1 N m at the load, R_a / (A K_m) [V/(N m)].
    #[must_use]
    pub fn volts_per_newton_metre(&self) -> f64 {
        self.parameters.armature_resistance / self.back_emf()
    }

    /// Voltage that overcomes 1 N m of friction under `coupling` [V/(N m)].
    #[must_use]
    pub fn friction_volts(&self, coupling: FrictionCoupling) -> f64 {
        match coupling {
            FrictionCoupling::Physical => self.volts_per_newton_metre(),
            FrictionCoupling::NewtonMetreAsVolt => 1.0,
        }
    }

    /// Back-EMF constant at the load, A K_m [V s/rad].
    #[must_use]
    pub fn back_emf(&self) -> f64 {
        self.parameters.gear_ratio * self.parameters.motor_constant
    }
}

impl TryFrom<DriveParameters> for Drive {
    type Error = RigError;

    fn try_from(p: DriveParameters) -> Result<Self, RigError> {
        for (name, value) in [
            ("motor_constant", p.motor_constant),
            ("gear_ratio", p.gear_ratio),
            ("armature_resistance", p.armature_resistance),
            ("inertia", p.inertia),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(RigError::OutOfRange {
                    name,
                    value,
                    expected: "a finite number above zero",
                });
            }
        }
        Ok(Self { parameters: p })
    }
}

impl From<Drive> for DriveParameters {
    fn from(drive: Drive) -> Self {
        drive.parameters
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srv02_has_the_printed_constants() {
        let thesis = Drive::srv02(TimeConstant::Thesis);
        assert!((thesis.gain() - 1.86254).abs() < 1e-5);
        assert!((thesis.volts_per_newton_metre() - 4.8426).abs() < 1e-4);
        assert!((thesis.time_constant() - 0.02388).abs() < 1e-15);
        assert!((thesis.parameters().inertia - 2.64757e-3).abs() < 1e-6);
        let datasheet = Drive::srv02(TimeConstant::Datasheet);
        assert!((datasheet.parameters().inertia - 1.92288e-3).abs() < 1e-8);
        assert!((datasheet.time_constant() - 0.017344).abs() < 1e-6);
    }

    #[test]
    fn a_negative_inertia_is_refused() {
        let wrong =
            DriveParameters { inertia: -1e-3, ..*Drive::srv02(TimeConstant::Thesis).parameters() };
        let message = Drive::try_from(wrong).unwrap_err().to_string();
        assert!(message.contains("inertia") && message.contains("-0.001"), "{message}");
    }
}
