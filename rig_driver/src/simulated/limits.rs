//! Safety limits of a simulated rig.

use crate::safety::{MotorThermal, SafetyLimits, SensorChecks, Standstill};
use crate::{Channel, SimulationOptions};

impl SafetyLimits {
    /// Limits for a simulated rig: its own voltage limit, a speed its drive cannot reach by itself,
    /// its motor's constants, and checks of only those sensors that have ranges and noise.
    #[must_use]
    pub fn for_simulation(options: &SimulationOptions) -> Self {
        let Self { motor, sensors, standstill, .. } = Self::default();
        let drive = &options.drive;
        Self {
            voltage: options.voltage_limit,
            velocity: 1.2 * drive.gain() * options.voltage_limit,
            motor: motor.map(|motor| MotorThermal {
                armature_resistance: drive.armature_resistance,
                back_emf: drive.back_emf(),
                ..motor
            }),
            // Four time constants bring the fastest shaft below a fiftieth of its speed.
            standstill: standstill.map(|limits| Standstill {
                after: limits.after.max(4.0 * drive.time_constant()).min(10.0),
                ..limits
            }),
            sensors: SensorChecks {
                torque_range: Some(options.sensors.torque.range)
                    .filter(|range| range.is_finite())
                    .map(|range| range - 0.5 * options.sensors.torque.resolution),
                frozen_cycles: sensors.frozen_cycles.filter(|_| {
                    let dithered = |channel: &Channel| channel.noise > 0.3 * channel.resolution;
                    dithered(&options.sensors.tachometer) && dithered(&options.sensors.torque)
                }),
                ..sensors
            },
            ..Self::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limits_of_the_usual_simulation_are_valid() {
        SafetyLimits::for_simulation(&SimulationOptions::default()).check(1e-3).unwrap();
    }
}
