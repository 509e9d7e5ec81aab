//! The whole estimator: which velocity, which technique, which model.

use friction_model::{AnyModel, ModelName, TimeStep};

use crate::change::Change;
use crate::running::{Adapted, Running};
use crate::{Estimate, EstimatorOptions, ObserverError, Seen};

/// An estimator running at a fixed period.
#[derive(Debug, Clone)]
pub struct FrictionEstimator {
    options: EstimatorOptions,
    dt: TimeStep,
    running: Running,
    change: Option<Change>,
    /// Velocity and torque of the last cycle.
    velocity: f64,
    torque: f64,
}

impl FrictionEstimator {
    /// How long the estimate takes to go over after a [`change`](Self::change) \[s\].
    pub const FADE: f64 = 0.1;

    /// An estimator at rest, called once every `dt`.
    ///
    /// # Errors
    /// [`ObserverError`] names the option that is out of range.
    pub fn new(
        model: &AnyModel,
        options: EstimatorOptions,
        dt: TimeStep,
    ) -> Result<Self, ObserverError> {
        let running = Running::new(model, &options, dt)?;
        Ok(Self { options, dt, running, change: None, velocity: 0.0, torque: 0.0 })
    }

    /// The friction now. What is not a finite number is not believed, see
    /// [`crate::FrictionObserver::observe`].
    #[inline]
    pub fn estimate(&mut self, seen: &Seen) -> Estimate {
        let (velocity, mut estimate) = self.running.estimate(seen);
        if let Some(change) = &mut self.change
            && !change.mix(seen, &mut estimate)
        {
            self.change = None;
        }
        (self.velocity, self.torque) = (velocity, estimate.torque);
        estimate
    }

    /// Goes over to another model or other options. What estimated before goes on beside the new
    /// one and fades out, linearly in [`FADE`](Self::FADE) seconds; the torque does not jump. A
    /// change during another one fades from the last torque. What an adaptation had learned is not
    /// carried over.
    ///
    /// # Errors
    /// [`ObserverError`] names the option that is out of range; the estimator goes on as it was
    /// then.
    pub fn change(
        &mut self,
        model: &AnyModel,
        options: EstimatorOptions,
    ) -> Result<(), ObserverError> {
        let next = Running::new(model, &options, self.dt)?;
        let cycles = Self::FADE / self.dt.seconds();
        let before = std::mem::replace(&mut self.running, next);
        self.change = Some(match self.change {
            None => Change::away_from(before, cycles),
            Some(_) => Change::away_from_torque(self.torque, cycles),
        });
        self.options = options;
        Ok(())
    }

    /// Back to rest. What an adaptation has learned stays; a change under way is over.
    pub fn reset(&mut self) {
        self.running.reset();
        self.change = None;
        (self.velocity, self.torque) = (0.0, 0.0);
    }

    /// The velocity that the estimator believed in the last cycle \[rad/s\]; zero before the first,
    /// not a number while there was none to believe.
    #[must_use]
    pub const fn velocity(&self) -> f64 {
        self.velocity
    }

    /// What an adaptation has come to.
    #[must_use]
    pub fn adapted(&self) -> Adapted {
        self.running.adapted()
    }

    /// The model that it was made with.
    #[must_use]
    pub const fn model(&self) -> ModelName {
        self.running.model()
    }

    /// The options.
    #[must_use]
    pub const fn options(&self) -> &EstimatorOptions {
        &self.options
    }
}
