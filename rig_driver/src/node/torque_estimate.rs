//! Where the effort in `/joint_states` comes from: the torque sensor, or what voltage or current
//! leave unexplained.

use friction_model::{Motor, TorqueSource};

use crate::Measurement;

/// The friction torque, cycle by cycle. Reconstructed, it goes through a low-pass filter, since it
/// differentiates the velocity.
#[derive(Debug, Clone)]
pub(super) struct TorqueEstimate {
    source: TorqueSource,
    drive: Motor,
    period: f64,
    /// Share of a new value in the filtered one.
    share: f64,
    velocity_before: Option<f64>,
    filtered: f64,
}

impl TorqueEstimate {
    /// `filter` is the time constant of the filter \[s\].
    pub(super) fn new(source: TorqueSource, drive: Motor, period: f64, filter: f64) -> Self {
        Self {
            source,
            drive,
            period,
            share: period / (period + filter),
            velocity_before: None,
            filtered: 0.0,
        }
    }

    /// The friction torque [N m] of the cycle that ended with this measurement.
    pub(super) fn torque(&mut self, seen: &Measurement) -> f64 {
        let velocity = seen.tachometer_velocity;
        let before = self.velocity_before.replace(velocity);
        let back_emf = self.drive.back_emf();
        let driving = match self.source {
            TorqueSource::Sensor | TorqueSource::Driving => return seen.torque,
            TorqueSource::Voltage => {
                let mean = 0.5 * (velocity + before.unwrap_or(velocity));
                (seen.voltage_applied - back_emf * mean) * back_emf / self.drive.armature_resistance
            }
            TorqueSource::Current => back_emf * seen.motor_current.unwrap_or(f64::NAN),
        };
        let acceleration = before.map_or(0.0, |before| (velocity - before) / self.period);
        let raw = driving - self.drive.inertia * acceleration;
        if !raw.is_finite() {
            return f64::NAN;
        }
        self.filtered += self.share * (raw - self.filtered);
        self.filtered
    }
}

#[cfg(test)]
mod tests {
    use friction_model::Proposed;

    use super::*;
    use crate::{Rig, Sensors, SimulatedRig, SimulationOptions};

    /// On a rig with ideal sensors both ways lead to the friction that the plant has, once the
    /// filter has settled.
    #[test]
    fn voltage_and_current_give_the_friction_back() {
        let options = SimulationOptions { sensors: Sensors::ideal(), ..Default::default() };
        for source in [TorqueSource::Voltage, TorqueSource::Current] {
            let mut rig = SimulatedRig::new(options, Proposed::test_bed()).unwrap();
            let mut estimate = TorqueEstimate::new(source, options.drive, options.period, 0.01);
            let (mut torque, mut truth) = (0.0, 0.0);
            for k in 0..3000 {
                let seen = rig.measure();
                torque = estimate.torque(&seen);
                truth = seen.torque;
                rig.apply(2.0 + 0.2 * (0.003 * f64::from(k)).sin()).unwrap();
            }
            assert!(
                truth > 0.05 && (torque - truth).abs() < 0.002,
                "{source:?}: {torque}, not {truth}"
            );
        }
    }
}
