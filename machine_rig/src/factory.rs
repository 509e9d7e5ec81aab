//! How a machine is opened: `machine:FILE`.

use std::path::{Path, absolute};

use rig_driver::back_end::{BackEnd, Listed, Place, PlaceError};
use rig_driver::registry::{RigDescription, RigSetup, SensorsPresent};
use rig_driver::safety::{MotorThermal, SafetyLimits, SensorChecks};
use rig_driver::{Miswired, Rig, RigError, RigFactory};

use crate::simulated::Simulated;
use crate::{Machine, MachineError, MachineRig, Thermal, shelf};

/// Machines by the files that describe them.
#[derive(Debug, Clone, Copy, Default)]
pub struct MachineFactory;

impl RigFactory for MachineFactory {
    fn name(&self) -> &'static str {
        "machine"
    }

    fn about(&self) -> &'static str {
        "a simulated rig that a file describes"
    }

    fn place(&self) -> Place {
        Place::Required { what: "FILE", example: "pendulum.yaml" }
    }

    fn normal(&self, place: &str) -> Result<String, PlaceError> {
        let path = absolute(Path::new(place)).map_err(|error| PlaceError(error.to_string()))?;
        Ok(path.display().to_string())
    }

    fn is_simulated(&self) -> bool {
        true
    }

    fn listed(&self) -> Vec<Listed> {
        Vec::new()
    }

    fn open(&self, place: Option<&str>, setup: &RigSetup) -> Result<BackEnd, RigError> {
        let file = place.unwrap_or_default();
        let refused = |error: MachineError| match error {
            MachineError::Rig(error) => error,
            error => RigError::Description(error.to_string()),
        };
        let machine = Machine::read(Path::new(file)).map_err(refused)?;
        let voltage = SafetyLimits::voltage_within(
            setup.limits.voltage.or(machine.limits.voltage),
            machine.voltage_range,
        )?;
        let limits = machine.limits_of(voltage).map_err(refused)?;
        let wiring = setup.wiring.or(machine.wiring().map_err(refused)?);
        let sensors =
            SensorsPresent { torque: machine.sensed.torque, current: machine.sensed.current };
        let about = Some(format!("{}, simulated", machine.name));
        let description = Some(RigDescription {
            name: machine.name.clone(),
            firmware: None,
            period: machine.period,
            voltage_range: machine.voltage_range,
            counts_per_turn: f64::from(machine.sensors.encoder_counts_per_turn),
            scales: None,
        });
        let (simulated, again) = shelf::at(file, || Simulated::new(machine).map_err(refused))?;
        let rig: Box<dyn Rig + Send> = Box::new(MachineRig::open(simulated, again, voltage));
        let rig = match wiring {
            Some(wiring) => Box::new(Miswired::new(rig, wiring)),
            None => rig,
        };
        Ok(BackEnd { rig, limits, sensors, about, description })
    }
}

impl Machine {
    /// What the safety layer allows on it, at most `voltage`.
    fn limits_of(&self, voltage: f64) -> Result<SafetyLimits, MachineError> {
        let options = self.options()?;
        let usual = SafetyLimits::for_simulation(&options);
        let sensors = SensorChecks {
            agreement: usual.sensors.agreement.filter(|_| self.sensed.tachometer),
            torque_range: usual.sensors.torque_range.filter(|_| self.sensed.torque),
            frozen_cycles: usual
                .sensors
                .frozen_cycles
                .filter(|_| self.sensed.tachometer && self.sensed.torque),
        };
        let motor = usual.motor.map(|motor| match self.thermal {
            None => motor,
            Some(Thermal { continuous, time_constant }) => MotorThermal {
                thermal_resistance: (motor.limit - motor.ambient) * self.motor.armature_resistance
                    / (continuous * continuous),
                time_constant,
                ..motor
            },
        });
        // The safety layer knows the speed as it is told.
        let motor = motor
            .map(|motor| MotorThermal { back_emf: motor.back_emf / self.position_scale, ..motor });
        let usual = SafetyLimits { sensors, motor, ..usual };
        Ok(SafetyLimits { voltage, ..self.limits.on(usual, self.voltage_range, true)? })
    }
}
