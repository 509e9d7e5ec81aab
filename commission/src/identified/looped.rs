//! The loop around the identified shaft.

use controller::{ControlMode, Controller, ControllerOptions, Feedback, Reference};
use experiment_runner::test_bed::TestBedError;
use experiment_runner::waveform::Waveform;
use friction_model::{AnyModel, TimeStep};
use friction_observer::{EstimatorOptions, FrictionEstimator, Seen};

use super::{Identified, Shaft};
use crate::CommissionError;

/// Controller, estimator and the model in it.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// The controller.
    pub controller: ControllerOptions,
    /// The estimator.
    pub estimator: EstimatorOptions,
    /// The model; its forces are volts.
    pub friction: AnyModel,
}

/// What a cycle came to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle {
    /// Reference less the encoder \[rad\].
    pub error: f64,
    /// Voltage \[V\].
    pub volts: f64,
}

/// A loop that runs.
#[derive(Debug, Clone)]
pub struct Looped {
    shaft: Shaft,
    controller: Controller,
    estimator: FrictionEstimator,
    encoder_step: f64,
    period: f64,
    cycle: u32,
    volts: f64,
    /// Position and velocity of the cycle before.
    before: f64,
}

impl Looped {
    /// The loop of `settings` around the shaft, which moves at `velocity` [rad/s].
    ///
    /// # Errors
    /// [`CommissionError`] for settings that cannot be.
    pub fn new(
        identified: &Identified,
        settings: &Settings,
        velocity: f64,
    ) -> Result<Self, CommissionError> {
        let period = identified.plant.period;
        let dt = TimeStep::new(period).map_err(TestBedError::from)?;
        let estimator = FrictionEstimator::new(&settings.friction, settings.estimator, dt)
            .map_err(TestBedError::from)?;
        Ok(Self {
            shaft: Shaft::new(*identified, velocity),
            controller: Controller::new(settings.controller)?,
            estimator,
            encoder_step: identified.plant.encoder_step,
            period,
            cycle: 0,
            volts: 0.0,
            before: 0.0,
        })
    }

    /// Time \[s\].
    #[must_use]
    pub fn time(&self) -> f64 {
        f64::from(self.cycle) * self.period
    }

    /// One cycle with the encoder's steps.
    pub fn step(&mut self, reference: &Reference) -> Cycle {
        let position = (self.shaft.position() / self.encoder_step).floor() * self.encoder_step;
        self.step_seeing(reference, position, 0.0)
    }

    /// One cycle without them: the encoder is off by `off` \[rad\], and `added` volts are put on.
    pub fn step_free(&mut self, reference: &Reference, off: f64, added: f64) -> Cycle {
        self.step_seeing(reference, self.shaft.position() + off, added)
    }

    fn step_seeing(&mut self, reference: &Reference, position: f64, added: f64) -> Cycle {
        let velocity = (position - self.before) / self.period;
        self.before = position;
        let options = self.controller.options();
        let estimate = self.estimator.estimate(&Seen {
            velocity,
            position,
            reference_velocity: reference.velocity,
            error: match options.mode {
                ControlMode::Position => position - reference.position,
                ControlMode::Velocity => velocity - reference.velocity,
            },
            voltage: self.volts,
            torque: None,
        });
        let believed = self.estimator.velocity();
        let fed = self.estimator.options().feeds_controller && believed.is_finite();
        let feedback = Feedback {
            position,
            velocity: if fed { believed } else { velocity },
            friction: estimate.torque,
            cycle: None,
        };
        self.volts = self.controller.step(reference, &feedback).total;
        self.shaft.step(self.volts + added);
        self.cycle += 1;
        Cycle { error: reference.position - position, volts: self.volts }
    }

    /// The highest speed of `task` from rest until `until` \[s\] [rad/s].
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub fn fastest(
        identified: &Identified,
        settings: &Settings,
        task: Waveform,
        until: f64,
    ) -> Result<f64, CommissionError> {
        let mut looped = Self::new(identified, settings, 0.0)?;
        let mut fastest: f64 = 0.0;
        while looped.time() < until {
            let now = looped.time();
            looped.step(&task.at(now));
            fastest = fastest.max(looped.shaft.velocity().abs());
        }
        Ok(fastest)
    }

    /// Does `task` from rest: the cycles from `from` seconds to `until`.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub fn on(
        identified: &Identified,
        settings: &Settings,
        task: Waveform,
        (from, until): (f64, f64),
    ) -> Result<Vec<Cycle>, CommissionError> {
        let mut looped = Self::new(identified, settings, 0.0)?;
        let mut cycles = Vec::new();
        while looped.time() < until {
            let now = looped.time();
            let cycle = looped.step(&task.at(now));
            if now >= from {
                cycles.push(cycle);
            }
        }
        Ok(cycles)
    }
}
