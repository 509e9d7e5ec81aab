//! What a study compares, and on which bench.

use controller::{ControllerOptions, DerivativeOn};
use experiment_runner::compensation::Arm;
use experiment_runner::test_bed::{TestBed, TestBedError, nominal_drive};
use friction_model::{AnyModel, ModelError, ModelName};
use friction_observer::EstimatorOptions;
use rig_driver::{FrictionCoupling, RigError, Sensors, SimulationOptions};
use serde::{Deserialize, Serialize};

use super::{BeliefErrors, Task};

/// What is compared, how often, under which errors.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyOptions {
    /// The tasks.
    pub tasks: Vec<Task>,
    /// Friction of the plants, with the test bed's parameters.
    pub plants: Vec<ModelName>,
    /// What compensates; the first must be [`Arm::None`].
    pub arms: Vec<Arm>,
    /// Draws.
    pub draws: u32,
    /// Errors of the beliefs.
    pub errors: BeliefErrors,
    /// Units and sensors.
    pub setting: Setting,
    /// Threads; the figures do not depend on it.
    pub workers: usize,
}

/// A study that cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// A set of parameters that a model does not accept.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A loop that cannot be put together.
    #[error(transparent)]
    Bed(#[from] TestBedError),
    /// The rig refused a voltage.
    #[error(transparent)]
    Rig(#[from] RigError),
}

impl StudyError {
    /// Whether whoever asked for the study can mend it.
    #[must_use]
    pub const fn is_bad_input(&self) -> bool {
        match self {
            Self::Model(_) => true,
            Self::Bed(error) => error.is_bad_input(),
            Self::Rig(error) => error.is_bad_input(),
        }
    }
}

/// Units and sensors of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Setting {
    /// Friction as a torque, sensors with noise and steps, the derivative of the measurement
    #[default]
    Physical,
    /// As the thesis's own simulations behave: friction in N m taken off the volts, ideal sensors,
    /// the derivative of the error
    Thesis,
}

/// The bench of a study: the thesis's gains, no plant inverse.
#[must_use]
pub fn bench(setting: Setting) -> TestBed {
    let mut simulation = SimulationOptions::default();
    let mut controller = ControllerOptions::default();
    if setting == Setting::Thesis {
        simulation.sensors = Sensors::ideal();
        simulation.friction_coupling = FrictionCoupling::NewtonMetreAsVolt;
        simulation.voltage_limit = 10.0;
        (controller.derivative_on, controller.derivative_filter) = (DerivativeOn::Error, 0.0);
    }
    let drive = nominal_drive(&simulation.drive, simulation.friction_coupling);
    controller.compensation.volts_per_newton_metre = drive.volts_per_newton_metre;
    TestBed {
        simulation,
        friction: AnyModel::test_bed(ModelName::Proposed),
        controller,
        estimator: EstimatorOptions { drive, ..EstimatorOptions::default() },
    }
}
