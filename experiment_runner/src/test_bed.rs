//! The simulated laboratory bench: which rig, under which friction, compensated by which model.

use controller::design::LinearDrive;
use controller::{
    Compensation, ControlMode, Controller, ControllerError, ControllerOptions, PlantInverse,
};
use friction_model::{AnyModel, ModelError, Motor, TimeStep};
use friction_observer::{EstimatorOptions, FrictionEstimator, NominalDrive, ObserverError};
use rig_driver::{FrictionCoupling, Rig, RigError, SimulationOptions};
use serde::{Deserialize, Serialize};

use crate::compensation::Means;
use crate::control_loop::ControlLoop;
use crate::protocol::InverseUse;
use crate::waveform::Waveform;

/// A simulated rig and the friction it really has.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TestBed {
    /// The rig.
    pub simulation: SimulationOptions,
    /// The friction of the plant: unknown to observers and controllers.
    pub friction: AnyModel,
    /// Gains and options of the controller; mode, period, limit and compensation are set for each
    /// run.
    pub controller: ControllerOptions,
    /// What the estimator believes and listens to; its technique is set for each run.
    pub estimator: EstimatorOptions,
}

/// What an estimator believes of `motor` if it knows it exactly.
#[must_use]
pub const fn nominal_drive(motor: &Motor, coupling: FrictionCoupling) -> NominalDrive {
    let volts_per_newton_metre = coupling.volts_per_newton_metre(motor);
    NominalDrive { volts_per_newton_metre, ..NominalDrive::of(motor) }
}

/// A loop that cannot be put together.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TestBedError {
    /// The rig.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// The controller.
    #[error(transparent)]
    Controller(#[from] ControllerError),
    /// The estimator.
    #[error(transparent)]
    Observer(#[from] ObserverError),
    /// The observer's model.
    #[error(transparent)]
    Model(#[from] ModelError),
}

impl TestBedError {
    /// Whether whoever set the bench up can mend it.
    #[must_use]
    pub const fn is_bad_input(&self) -> bool {
        match self {
            Self::Rig(error) => error.is_bad_input(),
            Self::Controller(_) | Self::Observer(_) | Self::Model(_) => true,
        }
    }
}

impl TestBed {
    /// The same bench with `inverse` of its drive, exactly known, in the feed-forward path.
    #[must_use]
    pub fn with_inverse(mut self, inverse: InverseUse) -> Self {
        let drive = LinearDrive::of(&self.simulation.drive);
        self.controller.inverse = match inverse {
            InverseUse::Off => PlantInverse::Off,
            InverseUse::Gain => PlantInverse::Gain(drive),
            InverseUse::Whole => PlantInverse::Whole(drive),
        };
        self
    }

    /// A loop on this bench that starts at rest.
    ///
    /// An estimator over `observer` runs in any case; its estimate enters the command only by some
    /// `means`. `seed` is that of the sensors' noise, `start_ns` the stamp of cycle 0.
    ///
    /// # Errors
    /// [`TestBedError`] names the parameter that is out of range.
    pub fn control_loop(
        &self,
        mode: ControlMode,
        reference: Waveform,
        observer: &AnyModel,
        means: Option<Means>,
        seed: u64,
        start_ns: u64,
    ) -> Result<ControlLoop, TestBedError> {
        let rig = SimulationOptions { seed, ..self.simulation }.build(self.friction)?;
        self.loop_around(rig, mode, reference, observer, means, start_ns)
    }

    /// The same loop around another rig, a real one: what this bench says of estimator and
    /// controller, at `rig`'s own period and within the bench's voltage limit.
    ///
    /// # Errors
    /// As for [`control_loop`](Self::control_loop).
    pub fn loop_around(
        &self,
        rig: Box<dyn Rig + Send>,
        mode: ControlMode,
        reference: Waveform,
        observer: &AnyModel,
        means: Option<Means>,
        start_ns: u64,
    ) -> Result<ControlLoop, TestBedError> {
        let period = rig.period();
        let (options, estimator) = self.settings(mode, means, period);
        Ok(ControlLoop::new(
            rig,
            FrictionEstimator::new(observer, estimator, TimeStep::new(period)?)?,
            Controller::new(options)?,
            reference,
            start_ns,
        ))
    }

    /// What controller and estimator are set to for one run at `period` \[s\].
    #[must_use]
    pub fn settings(
        &self,
        mode: ControlMode,
        means: Option<Means>,
        period: f64,
    ) -> (ControllerOptions, EstimatorOptions) {
        let mut options = ControllerOptions {
            mode,
            period,
            compensation: Compensation { enabled: false, ..self.controller.compensation },
            voltage_limit: self.simulation.voltage_limit,
            ..self.controller
        };
        let mut estimator = self.estimator;
        if let Some(means) = means {
            means.configure(&mut estimator, &mut options);
        }
        (options, estimator)
    }

    /// The same bench, with the whole inverse of its drive in the feed-forward path if
    /// `fed_forward`.
    #[must_use]
    pub fn fed_forward(self, fed_forward: bool) -> Self {
        if fed_forward { self.with_inverse(InverseUse::Whole) } else { self }
    }
}
