//! What a simulated rig is made of.

use friction_model::Motor;
use serde::{Deserialize, Serialize};

use crate::safety::SafetyLimits;
use crate::{FrictionCoupling, FrictionDrift, HIGHEST_VOLTAGE, RigError, Sensors, VOLTAGE_RANGE};

/// Everything a simulated rig is made of, but for its friction model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SimulationOptions {
    /// The geared motor.
    pub drive: Motor,
    /// How friction enters the drive.
    pub friction_coupling: FrictionCoupling,
    /// Sensors and converters.
    pub sensors: Sensors,
    /// Largest magnitude of the motor voltage \[V\], above zero and at most `voltage_range`.
    pub voltage_limit: f64,
    /// Largest magnitude that the rig's amplifier can put out \[V\], above zero and at most
    /// [`HIGHEST_VOLTAGE`].
    #[serde(default = "usual_range")]
    pub voltage_range: f64,
    /// Period of the control cycle \[s\], above zero and at most 10 ms.
    pub period: f64,
    /// Integration steps a period.
    pub substeps: u32,
    /// Seed of the sensors' noise.
    pub seed: u64,
    /// How the friction drifts; not at all if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction_drift: Option<FrictionDrift>,
    /// Limits of the driver's safety layer around the rig; none to go without, as offline runs do,
    /// where nobody can be hurt.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub safety: Option<SafetyLimits>,
}

/// The range of a rig whose description leaves it out.
const fn usual_range() -> f64 {
    VOLTAGE_RANGE
}

impl Default for SimulationOptions {
    /// The SRV-02 with the thesis's time constant at 1 kHz, two integration steps a period, +-6 V
    /// (the motor's nominal voltage).
    fn default() -> Self {
        Self {
            drive: Motor::SRV02,
            friction_coupling: FrictionCoupling::Physical,
            sensors: Sensors::default(),
            voltage_limit: 6.0,
            voltage_range: VOLTAGE_RANGE,
            period: 1e-3,
            substeps: 2,
            seed: 1,
            friction_drift: None,
            safety: None,
        }
    }
}

impl SimulationOptions {
    /// Checks every field.
    ///
    /// # Errors
    /// [`RigError`] names the field.
    pub fn check(&self) -> Result<(), RigError> {
        self.drive.check()?;
        self.sensors.check()?;
        self.friction_drift.map_or(Ok(()), |drift| drift.check())?;
        let error = |name, value, expected: &'static str| {
            Err(RigError::OutOfRange { name, value, expected: expected.into() })
        };
        if !(self.voltage_range > 0.0 && self.voltage_range <= HIGHEST_VOLTAGE) {
            return error("voltage_range", self.voltage_range, "above 0 and at most 60 V");
        }
        if !(self.voltage_limit > 0.0 && self.voltage_limit.is_finite()) {
            return error("voltage_limit", self.voltage_limit, "a finite number above 0");
        }
        if self.voltage_limit > self.voltage_range {
            return Err(RigError::BeyondRange {
                limit: self.voltage_limit,
                range: self.voltage_range,
            });
        }
        if !(self.period > 0.0 && self.period <= 0.01) {
            return error("period", self.period, "above 0 and at most 0.01 s");
        }
        if self.substeps == 0 || self.substeps > 10_000 {
            return error("substeps", f64::from(self.substeps), "from 1 to 10000");
        }
        Ok(())
    }
}
