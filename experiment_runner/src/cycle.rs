//! One control cycle, whole: what the recorder, the publishers and the report are fed with.

use controller::{Command, ControlMode, Reference};
use friction_observer::Estimate;
use rig_driver::{Measurement, Truth};

/// Everything one pass of the loop saw and decided.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CycleSample {
    /// Time of the measurement: nanoseconds since the Unix epoch.
    pub stamp_ns: u64,
    /// What the rig measured.
    pub measurement: Measurement,
    /// Where the axis should be.
    pub reference: Reference,
    /// What the observer thought of it.
    pub estimate: Estimate,
    /// What the controller decided.
    pub command: Command,
    /// What only a simulation knows.
    pub truth: Option<Truth>,
}

impl CycleSample {
    /// The cycle after this one, in which nothing was decided: `measurement` with the motor at zero
    /// volts.
    #[must_use]
    pub fn followed_by(self, measurement: Measurement) -> Self {
        let elapsed = ((measurement.time - self.measurement.time).max(0.0) * 1e9).round() as u64;
        let command = Command { mode: self.command.mode, ..Command::default() };
        Self { stamp_ns: self.stamp_ns + elapsed, measurement, command, truth: None, ..self }
    }

    /// Reference minus response, of the shaft itself where the rig is simulated, else as measured
    /// [rad/s or rad, by mode].
    #[must_use]
    pub fn error(&self) -> f64 {
        match (self.truth, self.command.mode) {
            (Some(truth), ControlMode::Velocity) => self.reference.velocity - truth.velocity,
            (Some(truth), ControlMode::Position) => self.reference.position - truth.position,
            (None, _) => self.command.error,
        }
    }
}
