//! A sine of velocity or of position, followed with and without compensation.

use controller::ControlMode;

use crate::protocol::TrackingProtocol;
use crate::run::experiment::{Experiment, Progressed, Running};
use crate::run::sorted::TrackedTask;
use crate::run::{RunError, RunOptions};

/// The experiment, of the quantity that is regulated.
#[derive(Debug, Clone, Copy)]
pub struct Tracking(pub ControlMode);

impl Tracking {
    const fn of<'a>(&self, options: &'a RunOptions) -> &'a TrackingProtocol {
        match self.0 {
            ControlMode::Velocity => &options.velocity_tracking,
            ControlMode::Position => &options.position_tracking,
        }
    }
}

impl Experiment for Tracking {
    fn name(&self) -> &'static str {
        match self.0 {
            ControlMode::Velocity => "velocity-tracking",
            ControlMode::Position => "position-tracking",
        }
    }

    fn about(&self) -> &'static str {
        match self.0 {
            ControlMode::Velocity => "Follow a sine of velocity with and without compensation",
            ControlMode::Position => "Follow a sine of position with and without compensation",
        }
    }

    fn rig_seconds(&self, options: &RunOptions) -> f64 {
        self.of(options).rig_seconds(options.arms())
    }

    fn shorten(&self, options: &mut RunOptions) {
        self.repeat(options, 1);
    }

    fn repeat(&self, options: &mut RunOptions, repetitions: u32) {
        match self.0 {
            ControlMode::Velocity => options.velocity_tracking.repetitions = repetitions,
            ControlMode::Position => options.position_tracking.repetitions = repetitions,
        }
    }

    fn reads_torque(&self) -> bool {
        false
    }

    fn carry_out(&self, running: &mut Running<'_, '_>) -> Result<Progressed, RunError> {
        let (name, stream) = match self.0 {
            ControlMode::Velocity => ("velocity tracking", 1 << 32),
            ControlMode::Position => ("position tracking", 2 << 32),
        };
        running.compare(TrackedTask {
            name: name.to_owned(),
            protocol: self.of(running.options()).clone(),
            stream,
            compared: false,
        })
    }
}
