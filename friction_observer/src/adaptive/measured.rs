//! The friction torque that adaptation compares its model with.

use friction_model::{TimeStep, TorqueSource};

use super::Excitation;
use crate::finite::believed;
use crate::velocity_estimator::LowPass;
use crate::{DriveInverse, NominalDrive, ObserverError, Seen};

/// Refuses a source that an observer has not. It has two: the torque sensor, and voltage and
/// velocity through the nominal drive. An error of the drive's constants is learned as friction; in
/// volts it largely cancels, since the compensation leaves through the same constant.
///
/// # Errors
/// [`ObserverError::TorqueSource`].
pub(super) const fn check_source(source: TorqueSource) -> Result<(), ObserverError> {
    match source {
        TorqueSource::Sensor | TorqueSource::Voltage => Ok(()),
        TorqueSource::Current | TorqueSource::Driving => Err(ObserverError::TorqueSource(source)),
    }
}

/// Friction torque and velocity through one filter, and whether they can be learned from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    source: TorqueSource,
    inverse: DriveInverse,
    torque: LowPass,
    velocity: LowPass,
    excitation: Excitation,
    dt: f64,
    /// How long the excitation has been rich \[s\].
    rich_for: f64,
}

/// One cycle's smoothed readings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Friction torque \[N m\].
    pub torque: f64,
    /// Velocity \[rad/s\].
    pub velocity: f64,
    /// Whether friction can be learned from it.
    pub rich: bool,
}

impl Measured {
    /// A measurement from `source` through a filter of time constant `filter` \[s\], called once
    /// every `dt`.
    #[must_use]
    pub fn new(
        source: TorqueSource,
        excitation: Excitation,
        filter: f64,
        drive: &NominalDrive,
        dt: TimeStep,
    ) -> Self {
        let low_pass = LowPass::new(filter, dt).at_zero();
        let (inverse, dt) = (DriveInverse::new(drive, dt), dt.seconds());
        Self {
            source,
            inverse,
            torque: low_pass,
            velocity: low_pass,
            excitation,
            dt,
            rich_for: 0.0,
        }
    }

    /// Takes a cycle in. `velocity` is the estimated one, `model_torque` the model's torque at this
    /// moment. `None` if a reading is not finite.
    #[inline]
    pub fn take(&mut self, velocity: f64, seen: &Seen, model_torque: f64) -> Option<Sample> {
        let from_voltage = self.inverse.torque(velocity, seen.voltage);
        let raw = match self.source {
            TorqueSource::Voltage => from_voltage,
            TorqueSource::Sensor => seen.torque.and_then(believed),
            // Refused where the options are checked.
            TorqueSource::Current | TorqueSource::Driving => None,
        };
        let (Some(raw), Some(velocity)) = (raw, believed(velocity)) else {
            self.rich_for = 0.0;
            return None;
        };
        let (torque, velocity) = (self.torque.step(raw), self.velocity.step(velocity));
        let rich = self.excitation.is_rich(velocity, model_torque, seen.voltage);
        self.rich_for = if rich { (self.rich_for + self.dt).min(1e3) } else { 0.0 };
        Some(Sample { torque, velocity, rich: self.rich_for > self.excitation.hold })
    }

    /// Back to rest.
    pub fn reset(&mut self) {
        self.inverse.reset();
        (self.torque, self.velocity) = (self.torque.at_zero(), self.velocity.at_zero());
        self.rich_for = 0.0;
    }
}
