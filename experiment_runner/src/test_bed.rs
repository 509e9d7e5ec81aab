//! The simulated laboratory bench: which rig, under which friction, compensated by which model.

use controller::design::LinearDrive;
use controller::{Compensation, ControlMode, Controller, ControllerError, ControllerOptions};
use friction_model::{AnyModel, ModelError, TimeStep};
use friction_observer::FrictionObserver;
use rig_driver::{RigError, SimulationOptions};
use serde::{Deserialize, Serialize};

use crate::control_loop::ControlLoop;
use crate::profile::Excitation;
use crate::waveform::Waveform;

/// A simulated rig and the friction it really has.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TestBed {
    /// The rig.
    pub simulation: SimulationOptions,
    /// The friction of the plant: unknown to observers and controllers.
    pub friction: AnyModel,
    /// Gains and options of the controller; mode, period, limit and compensation are set for each run.
    pub controller: ControllerOptions,
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
    /// The observer's model.
    #[error(transparent)]
    Model(#[from] ModelError),
}

impl TestBed {
    /// A loop on this bench that starts at rest.
    ///
    /// The observer runs `observer` in any case; its estimate enters the command only if `compensate` is set. `seed` is that of
    /// the sensors' noise, `start_ns` the stamp of cycle 0.
    ///
    /// # Errors
    /// [`TestBedError`] names the parameter that is out of range.
    pub fn control_loop(
        &self,
        mode: ControlMode,
        reference: Waveform,
        observer: &AnyModel,
        compensate: bool,
        seed: u64,
        start_ns: u64,
    ) -> Result<ControlLoop, TestBedError> {
        let simulation = SimulationOptions { seed, ..self.simulation };
        let period = simulation.period;
        let options = ControllerOptions {
            mode,
            period,
            compensation: Compensation { enabled: compensate, ..self.controller.compensation },
            voltage_limit: simulation.voltage_limit,
            ..self.controller
        };
        Ok(ControlLoop::new(
            simulation.build(self.friction)?,
            FrictionObserver::new(observer, TimeStep::new(period)?),
            Controller::new(options)?,
            reference,
            start_ns,
        ))
    }

    /// A loop that starts at rest and is driven by `excitation`; nothing compensates. With `feed_forward` the reference
    /// also goes through the inverse of the drive.
    ///
    /// # Errors
    /// As for [`control_loop`](Self::control_loop).
    pub fn excited_loop(
        &self,
        excitation: Excitation,
        feed_forward: bool,
        observer: &AnyModel,
        seed: u64,
        start_ns: u64,
    ) -> Result<ControlLoop, TestBedError> {
        let drive = &self.simulation.drive;
        let inverse = LinearDrive { gain: drive.gain(), time_constant: drive.time_constant() };
        let mut bed = *self;
        if feed_forward {
            bed.controller.inverse = Some(inverse);
        }
        let unused = Waveform::ConstantVelocity { velocity: 0.0 };
        let control = bed.control_loop(excitation.mode(), unused, observer, false, seed, start_ns)?;
        Ok(control.excited(excitation))
    }
}
