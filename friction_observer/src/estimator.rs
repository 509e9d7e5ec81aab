//! The whole estimator: which velocity, which technique, which model.

use friction_model::{AnyModel, ModelName, TimeStep};
use serde::{Deserialize, Serialize};

use crate::{Estimate, FrictionObserver, NominalDrive, ObserverError, Seen, Technique};

/// Everything an estimator is made of, but for its friction model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EstimatorOptions {
    /// Where the estimate comes from.
    pub technique: Technique,
    /// Error injection gain k of the observer on the measured velocity: `-k e` in each state's derivative (thesis section 5.2); zero for none.
    pub injection: f64,
    /// What is believed of the drive.
    pub drive: NominalDrive,
}

impl Default for EstimatorOptions {
    /// The observer on the measured velocity, without error injection, on the SRV-02.
    fn default() -> Self {
        Self { technique: Technique::default(), injection: 0.0, drive: NominalDrive::SRV02 }
    }
}

/// An estimator running at a fixed period.
#[derive(Debug, Clone)]
pub struct FrictionEstimator {
    options: EstimatorOptions,
    feedback: FrictionObserver,
    feedforward: FrictionObserver,
}

impl FrictionEstimator {
    /// An estimator at rest, called once every `dt`.
    ///
    /// # Errors
    /// [`ObserverError`] names the option that is out of range.
    pub fn new(model: &AnyModel, options: EstimatorOptions, dt: TimeStep) -> Result<Self, ObserverError> {
        options.technique.check()?;
        options.drive.check()?;
        let observer = FrictionObserver::new(model, dt);
        Ok(Self { options, feedback: observer.clone(), feedforward: observer })
    }

    /// The friction now. What is not a finite number is not believed, see [`FrictionObserver::observe`].
    #[inline]
    pub fn estimate(&mut self, seen: &Seen) -> Estimate {
        match self.options.technique {
            Technique::Feedback => self.feedback.observe(seen.velocity, seen.torque),
            Technique::Feedforward => self.feedforward.observe(seen.reference_velocity, seen.torque),
            Technique::Both { share } => {
                let seen_by = self.feedback.observe(seen.velocity, seen.torque);
                let asked = self.feedforward.observe(seen.reference_velocity, seen.torque);
                let torque = seen_by.torque + share * (asked.torque - seen_by.torque);
                Estimate { torque, residual: seen.torque.map(|measured| measured - torque), ..seen_by }
            }
        }
    }

    /// Back to rest.
    pub fn reset(&mut self) {
        self.feedback.reset();
        self.feedforward.reset();
    }

    /// The model that estimates.
    #[must_use]
    pub const fn model(&self) -> ModelName {
        self.feedback.model()
    }

    /// The options.
    #[must_use]
    pub const fn options(&self) -> &EstimatorOptions {
        &self.options
    }
}
