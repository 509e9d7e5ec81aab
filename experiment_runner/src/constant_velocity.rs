//! Experiment 1: friction at constant velocity.
//!
//! The shaft runs at each velocity of the grid under the velocity controller without compensation.
//! After the first seconds the friction torque is that of the steady sliding characteristic; its
//! mean over the rest of the point, against the mean velocity, is one point of the Stribeck curve.

use controller::ControlMode;
use friction_ident::statistics::RunningSample;
use friction_ident::{IdentError, SteadyPoint, TorqueSource};
use rig_driver::RigError;
use serde::{Deserialize, Serialize};

use crate::characterise::{Channels, TorqueReading};
use crate::control_loop::RunningLoop;
use crate::cycle::CycleSample;
use crate::protocol::ConstantVelocityProtocol;
use crate::waveform::Waveform;

/// One point of one repetition.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SteadyRun {
    /// Set, from 0.
    pub set: u32,
    /// Repetition within the set, from 0.
    pub repetition: u32,
    /// Velocity asked for [rad/s].
    pub reference: f64,
    /// Mean velocity, the slope of the encoder's position [rad/s].
    pub velocity: f64,
    /// Mean friction torque [N m].
    pub torque: f64,
    /// Standard deviation of one torque sample [N m].
    pub torque_deviation: f64,
    /// Standard deviation of the mean torque by the drive's constants [N m]; zero with a torque
    /// sensor.
    #[serde(default)]
    pub torque_systematic: f64,
    /// Mean voltage \[V\].
    #[serde(default)]
    pub voltage: f64,
    /// Mean current \[A\], where the rig measures it.
    #[serde(default)]
    pub current: Option<f64>,
    /// Samples that counted.
    pub samples: u32,
}

impl SteadyRun {
    /// The point for identification.
    #[must_use]
    pub fn point(&self) -> SteadyPoint {
        SteadyPoint::new(self.velocity, self.torque)
    }
}

/// A point that could not be driven or read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SteadyError {
    /// The rig refused a command.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// There is no friction torque in the recording.
    #[error(transparent)]
    Torque(#[from] IdentError),
}

/// One point to be driven.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyJob {
    /// Set, from 0.
    pub set: u32,
    /// Repetition within the set, from 0.
    pub repetition: u32,
    /// Velocity asked for [rad/s].
    pub velocity: f64,
}

impl SteadyJob {
    /// All points of the protocol in the order in which a rig drives them.
    #[must_use]
    pub fn all(protocol: &ConstantVelocityProtocol) -> Vec<Self> {
        let mut jobs = Vec::new();
        for set in 0..protocol.sets {
            for repetition in 0..protocol.repetitions {
                jobs.extend(protocol.velocities.iter().map(|&velocity| Self {
                    set,
                    repetition,
                    velocity,
                }));
            }
        }
        jobs
    }

    /// The reference of the point.
    #[must_use]
    pub const fn reference(&self) -> Waveform {
        Waveform::ConstantVelocity { velocity: self.velocity }
    }

    /// What is regulated.
    pub const MODE: ControlMode = ControlMode::Velocity;

    /// Drives the point on a loop that is at rest, showing every cycle to `record`. The torque is
    /// read as `reading` says.
    ///
    /// # Errors
    /// [`SteadyError`] if the rig refuses a command, or the torque cannot be worked out.
    pub fn run(
        &self,
        protocol: &ConstantVelocityProtocol,
        reading: &TorqueReading,
        mut control: impl RunningLoop,
        mut record: impl FnMut(&CycleSample),
    ) -> Result<SteadyRun, SteadyError> {
        let period = control.period();
        let cycles = (protocol.duration / period).round() as u64;
        let first = (protocol.drop_first / period).round() as u64;
        let end = cycles - (protocol.drop_last / period).round() as u64;
        let mut torque = RunningSample::default();
        let mut torque_systematic = 0.0;
        let mut channels = Channels::new(period);
        let (mut voltage, mut current) = (RunningSample::default(), RunningSample::default());
        let mut slope = Slope::default();
        for cycle in 0..cycles {
            let sample = control.step()?;
            record(&sample);
            if cycle >= first && cycle < end {
                if reading.source == TorqueSource::Sensor {
                    torque.add(sample.measurement.torque);
                } else {
                    channels.add(&sample);
                }
                voltage.add(sample.measurement.voltage_applied);
                sample.measurement.motor_current.iter().for_each(|&amperes| current.add(amperes));
                slope.add(
                    sample.measurement.time - protocol.drop_first,
                    sample.measurement.encoder_position,
                );
            }
        }
        if reading.source != TorqueSource::Sensor {
            let friction = reading.friction(&channels)?;
            friction.torque.iter().for_each(|&value| torque.add(value));
            let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
            torque_systematic = friction.propagate(mean);
        }
        Ok(SteadyRun {
            set: self.set,
            repetition: self.repetition,
            reference: self.velocity,
            velocity: slope.value(),
            torque: torque.mean,
            torque_deviation: torque.deviation(),
            torque_systematic,
            voltage: voltage.mean,
            current: (current.count == voltage.count && current.count > 0).then_some(current.mean),
            samples: torque.count,
        })
    }
}

/// Least-squares slope of a line.
#[derive(Debug, Clone, Copy, Default)]
struct Slope {
    n: f64,
    t: f64,
    y: f64,
    tt: f64,
    ty: f64,
}

impl Slope {
    fn add(&mut self, t: f64, y: f64) {
        self.n += 1.0;
        self.t += t;
        self.y += y;
        self.tt += t * t;
        self.ty += t * y;
    }

    fn value(&self) -> f64 {
        (self.n * self.ty - self.t * self.y) / (self.n * self.tt - self.t * self.t)
    }
}

#[cfg(test)]
mod tests {
    use friction_model::{AnyModel, ModelName};
    use rig_driver::{Sensors, SimulationOptions};

    use super::*;
    use crate::test_bed::TestBed;

    fn run(sensors: Sensors, velocity: f64) -> SteadyRun {
        let bed = TestBed {
            estimator: Default::default(),
            simulation: SimulationOptions { sensors, ..Default::default() },
            friction: AnyModel::test_bed(ModelName::Proposed),
            controller: Default::default(),
        };
        let job = SteadyJob { set: 0, repetition: 0, velocity };
        let control =
            bed.control_loop(SteadyJob::MODE, job.reference(), &bed.friction, None, 5, 0).unwrap();
        let reading = TorqueReading::new(
            TorqueSource::Sensor,
            &bed.simulation.drive,
            &bed.simulation.sensors,
            TorqueReading::RELATIVE_ERRORS,
        );
        job.run(&ConstantVelocityProtocol::default(), &reading, control, |_| {}).unwrap()
    }

    /// With ideal sensors every point lies on the plant's characteristic.
    #[test]
    fn points_lie_on_the_stribeck_curve() {
        for velocity in [0.03, 0.15, 0.5, 4.0] {
            let seen = run(Sensors::ideal(), velocity);
            let expected = AnyModel::test_bed(ModelName::Proposed).steady_state(seen.velocity);
            assert!((seen.torque - expected).abs() < 1e-8, "{seen:?}, not {expected}");
            assert_eq!(seen.samples, 10_500);
            // The lag compensator leaves 1 % of the reference and its share of the friction.
            assert!(seen.velocity < velocity && seen.velocity > 0.98 * velocity - 0.02);
        }
    }

    /// With the test bed's sensors the mean is as good as 10500 samples of its noise allow.
    #[test]
    fn sensor_noise_averages_out() {
        let seen = run(Sensors::default(), 1.0);
        let sample = (0.0061f64.powi(2) + (46.0 / 4096.0f64).powi(2) / 12.0).sqrt();
        assert!((seen.torque_deviation / sample - 1.0).abs() < 0.05, "{seen:?}");
        let expected = AnyModel::test_bed(ModelName::Proposed).steady_state(seen.velocity);
        assert!(
            (seen.torque - expected).abs() < 5.0 * sample / 10_500f64.sqrt() + 2e-5,
            "{seen:?}, not {expected}"
        );
    }
}
