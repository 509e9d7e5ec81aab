//! How the rig is named, found and opened: `flywheel` or `flywheel:INERTIA`.

use rig_driver::RigError;
use rig_driver::registry::{
    BackEnd, Listed, Place, PlaceError, RigFactory, RigSetup, SensorsPresent,
};
use rig_driver::safety::{SafetyLimits, SensorChecks};

use crate::flywheel::Flywheel;

/// Flywheels, by their inertia [kg m^2].
#[derive(Debug, Clone, Copy)]
pub struct FlywheelFactory;

/// The inertia that a text says [kg m^2].
fn inertia(text: &str) -> Result<f64, PlaceError> {
    let value = text.parse().ok().filter(|value| (1e-4..=1.0).contains(value));
    value.ok_or_else(|| {
        PlaceError(format!("expected an inertia from 0.0001 to 1 kg m^2, but `{text}` came"))
    })
}

impl RigFactory for FlywheelFactory {
    fn name(&self) -> &'static str {
        "flywheel"
    }

    fn about(&self) -> &'static str {
        "a flywheel on an ideal motor"
    }

    fn place(&self) -> Place {
        Place::Optional { what: "INERTIA", usual: "0.004" }
    }

    fn normal(&self, place: &str) -> Result<String, PlaceError> {
        inertia(place).map(|value| value.to_string())
    }

    /// Its time goes on by one period with each voltage: it waits for whoever drives it.
    fn is_simulated(&self) -> bool {
        true
    }

    fn listed(&self) -> Vec<Listed> {
        vec![Listed::ready("flywheel", "always there")]
    }

    fn open(&self, place: Option<&str>, _: &RigSetup) -> Result<BackEnd, RigError> {
        let value = inertia(place.unwrap_or_default())
            .map_err(|error| RigError::Elsewhere(error.to_string()))?;
        // No torque sensor, and readings without noise: what cannot be checked is left out.
        let usual = SafetyLimits::default();
        let sensors = SensorChecks { torque_range: None, frozen_cycles: None, ..usual.sensors };
        Ok(BackEnd {
            rig: Box::new(Flywheel::new(value)),
            limits: SafetyLimits { voltage: 5.0, sensors, ..usual },
            sensors: SensorsPresent { torque: false, current: false },
            about: Some(format!("flywheel of {value} kg m^2")),
            description: None,
        })
    }
}
