//! The geared DC motor that turns an axis, and where the friction torque on it is taken from.
//!
//! ```text
//! J_eq w' = (A K_m / R_a) (u - A K_m w) - F            (thesis appendix A)
//! T w' + w = K (u - (R_a / (A K_m)) F),   K = 1 / (A K_m),   T = R_a J_eq / (A K_m)^2
//! ```
//!
//! All quantities at the load side of the gear: velocity `w` \[rad/s\], friction `F` \[N m\],
//! voltage `u` \[V\].

/// The constants of a geared DC motor with its load. Everybody who knows the motor knows it by
/// these: the simulated plant, observers, controllers, identification and the safety layer.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Motor {
    /// Torque constant, equal to the back-EMF constant, K_m \[N m/A\], above zero.
    pub motor_constant: f64,
    /// Gear ratio A from motor to load, above zero.
    pub gear_ratio: f64,
    /// Armature resistance R_a \[ohm\], above zero.
    pub armature_resistance: f64,
    /// Inertia at the load side J_eq \[kg m^2\], above zero.
    pub inertia: f64,
}

/// A constant of a motor that cannot be.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "{name} must be a finite number above zero, but is {value}; change it in the drive's parameters"
)]
pub struct MotorError {
    /// The constant.
    pub name: &'static str,
    /// What came.
    pub value: f64,
}

impl Motor {
    /// The Quanser SRV-02 of the 2017 thesis's test bed with the time constant of its chapter 6,
    /// T = 0.02388 s, for which it designed its controllers: J_eq = 2.6476e-3 kg m^2.
    pub const SRV02: Self = Self::srv02(0.023_88 * SRV02_BACK_EMF * SRV02_BACK_EMF / 2.6);

    /// The same with the inertias of the data sheet, which the thesis's appendix A has:
    /// `J_eq = J_l + A^2 J_m` = 1.92288e-3 kg m^2, T = 0.01734 s.
    pub const SRV02_DATASHEET: Self = Self::srv02(2.6583e-5 + 70.0 * 70.0 * 3.87e-7);

    const fn srv02(inertia: f64) -> Self {
        Self { motor_constant: 0.007_67, gear_ratio: 70.0, armature_resistance: 2.6, inertia }
    }

    /// Back-EMF constant at the load, A K_m \[V s/rad\].
    #[must_use]
    pub const fn back_emf(&self) -> f64 {
        self.gear_ratio * self.motor_constant
    }

    /// Velocity gain K \[rad/s per V\].
    #[must_use]
    pub const fn gain(&self) -> f64 {
        1.0 / self.back_emf()
    }

    /// Time constant T \[s\].
    #[must_use]
    pub const fn time_constant(&self) -> f64 {
        self.armature_resistance * self.inertia / (self.back_emf() * self.back_emf())
    }

    /// Voltage that overcomes 1 N m at the load, R_a / (A K_m) \[V/(N m)\].
    #[must_use]
    pub const fn volts_per_newton_metre(&self) -> f64 {
        self.armature_resistance / self.back_emf()
    }

    /// Torque that drives the load \[N m\] at `voltage` \[V\] and `velocity` \[rad/s\].
    #[must_use]
    pub const fn driving_torque(&self, voltage: f64, velocity: f64) -> f64 {
        let constant = self.back_emf();
        constant / self.armature_resistance * (voltage - constant * velocity)
    }

    /// Checks every constant.
    ///
    /// # Errors
    /// [`MotorError`] names the one that is not above zero.
    pub fn check(&self) -> Result<(), MotorError> {
        for (name, value) in [
            ("motor_constant", self.motor_constant),
            ("gear_ratio", self.gear_ratio),
            ("armature_resistance", self.armature_resistance),
            ("inertia", self.inertia),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(MotorError { name, value });
            }
        }
        Ok(())
    }
}

/// A K_m of the SRV-02 \[V s/rad\].
const SRV02_BACK_EMF: f64 = 70.0 * 0.007_67;

/// Where the friction torque is taken from. Who takes it from some of these only says so.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Default,
    strum::Display,
    strum::EnumString,
    strum::IntoStaticStr,
    strum::VariantArray,
)]
#[strum(serialize_all = "snake_case")]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum TorqueSource {
    /// A torque sensor.
    #[default]
    Sensor,
    /// The motor's voltage and velocity: `F = (A K_m / R_a) (u - A K_m w) - J w'`.
    Voltage,
    /// The motor's current and velocity: `F = A K_m i - J w'`.
    Current,
    /// A recorded force or torque T that drives the axis, and the velocity: `F = T - J w'`.
    Driving,
}

impl TorqueSource {
    /// All of them.
    pub const ALL: &'static [Self] = <Self as strum::VariantArray>::VARIANTS;

    /// Name in files and tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// In words.
    #[must_use]
    pub const fn describe(self) -> &'static str {
        match self {
            Self::Sensor => "the torque or force column",
            Self::Voltage => "the motor's voltage and speed, less inertia times acceleration",
            Self::Current => "the motor's current, less inertia times acceleration",
            Self::Driving => "the driving force less inertia times acceleration",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_srv02_has_the_printed_constants() {
        let thesis = Motor::SRV02;
        assert!((thesis.gain() - 1.86254).abs() < 1e-5);
        assert!((thesis.volts_per_newton_metre() - 4.8426).abs() < 1e-4);
        assert!((thesis.time_constant() - 0.02388).abs() < 1e-15);
        assert!((thesis.inertia - 2.64757e-3).abs() < 1e-6);
        let datasheet = Motor::SRV02_DATASHEET;
        assert!((datasheet.inertia - 1.92288e-3).abs() < 1e-8);
        assert!((datasheet.time_constant() - 0.017344).abs() < 1e-6);
    }

    #[test]
    fn the_driving_torque_is_none_at_the_speed_that_the_voltage_holds() {
        let motor = Motor::SRV02;
        assert!(motor.driving_torque(6.0, 6.0 * motor.gain()).abs() < 1e-12);
        let standing = motor.driving_torque(1.0, 0.0);
        assert!((standing - 1.0 / motor.volts_per_newton_metre()).abs() < 1e-12);
    }

    #[test]
    fn a_constant_that_cannot_be_is_refused_by_name() {
        Motor::SRV02.check().unwrap();
        for wrong in [-1e-3, 0.0, f64::NAN, f64::INFINITY] {
            let error = Motor { inertia: wrong, ..Motor::SRV02 }.check().unwrap_err();
            assert_eq!(error.name, "inertia");
        }
    }

    #[test]
    fn torque_sources_are_found_by_their_names() {
        let names = ["sensor", "voltage", "current", "driving"];
        for (source, name) in TorqueSource::ALL.iter().zip(names) {
            assert_eq!((source.name(), name.parse()), (name, Ok(*source)));
        }
        assert!("feeling".parse::<TorqueSource>().is_err());
    }
}
