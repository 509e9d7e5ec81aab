//! What is recorded of a run, and the friction torque in it by the chosen source.

use friction_ident::{
    ChannelDeviations, DriveConstants, DriveSignals, FrictionTorque, IdentError, TorqueSource,
    Uncertain, friction_torque,
};
use friction_model::Motor;
use rig_driver::Sensors;
use serde::{Deserialize, Serialize};

use crate::cycle::CycleSample;

/// How the friction torque is read: from which channel, with which constants of the drive.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TorqueReading {
    /// Where the torque is from.
    pub source: TorqueSource,
    /// The drive as far as it is known.
    pub drive: DriveConstants,
    /// Scatter of one sample of each channel.
    pub deviations: ChannelDeviations,
}

impl TorqueReading {
    /// The reading of a rig with this motor and these sensors. `relative_errors` are the standard
    /// errors of the torque constant, the armature resistance and the inertia as fractions of their
    /// values.
    #[must_use]
    pub fn new(
        source: TorqueSource,
        motor: &Motor,
        sensors: &Sensors,
        relative_errors: [f64; 3],
    ) -> Self {
        let [k, r, j] = relative_errors;
        Self {
            source,
            drive: DriveConstants {
                torque_constant: Uncertain::relative(motor.back_emf(), k),
                armature_resistance: Uncertain::relative(motor.armature_resistance, r),
                inertia: Uncertain::relative(motor.inertia, j),
            },
            deviations: ChannelDeviations {
                torque: sensors.torque.deviation(),
                velocity: sensors.tachometer.deviation(),
                // The rig reports what the converter really put out.
                voltage: 0.0,
                current: sensors.current.deviation(),
            },
        }
    }

    /// Standard errors that data sheets of small servo motors leave, as fractions: torque constant
    /// 1 %, resistance 2 %, inertia 2 %.
    pub const RELATIVE_ERRORS: [f64; 3] = [0.01, 0.02, 0.02];

    /// Friction torque of the channels.
    ///
    /// # Errors
    /// [`IdentError`] where the channels are too short or the constants out of range.
    pub fn friction(&self, channels: &Channels) -> Result<FrictionTorque, IdentError> {
        let signals = DriveSignals {
            time_step: channels.period,
            velocity: &channels.velocity,
            torque: &channels.torque,
            voltage: &channels.voltage,
            current: &channels.current,
        };
        friction_torque(self.source, &signals, &self.drive, &self.deviations)
    }
}

/// The channels of one run, one value a cycle.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Channels {
    /// Period of the cycle \[s\].
    pub period: f64,
    /// Time \[s\].
    pub time: Vec<f64>,
    /// Position from the encoder \[rad\].
    pub encoder: Vec<f64>,
    /// Position from the potentiometer \[rad\].
    pub potentiometer: Vec<f64>,
    /// Velocity from the tachometer [rad/s].
    pub velocity: Vec<f64>,
    /// Voltage applied in the cycle before \[V\].
    pub voltage: Vec<f64>,
    /// Mean current of the cycle before \[A\]; empty on a rig that does not measure it.
    pub current: Vec<f64>,
    /// Torque sensor [N m].
    pub torque: Vec<f64>,
}

impl Channels {
    /// Empty channels of a loop with this period \[s\].
    #[must_use]
    pub fn new(period: f64) -> Self {
        Self { period, ..Self::default() }
    }

    /// Takes a cycle in.
    pub fn add(&mut self, sample: &CycleSample) {
        let seen = &sample.measurement;
        self.time.push(seen.time);
        self.encoder.push(seen.encoder_position);
        self.potentiometer.push(seen.potentiometer_position);
        self.velocity.push(seen.tachometer_velocity);
        self.voltage.push(seen.voltage_applied);
        self.current.extend(seen.motor_current);
        self.torque.push(seen.torque);
    }
}

/// Means of `size` samples each; what is left over at the end is dropped.
#[must_use]
pub fn block_means(values: &[f64], size: usize) -> Vec<f64> {
    let size = size.max(1);
    values.chunks_exact(size).map(|block| block.iter().sum::<f64>() / size as f64).collect()
}
