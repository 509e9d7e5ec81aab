//! What an estimator is made of.

use friction_model::Scheme;
use serde::{Deserialize, Serialize};

use crate::error::within;
use crate::{NominalDrive, ObserverError, Technique, VelocitySource};

/// Everything an estimator is made of, but for its friction model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EstimatorOptions {
    /// Where the estimate comes from.
    pub technique: Technique,
    /// Error injection gain k of the observer on the measured velocity: `-k e` in each state's
    /// derivative (thesis section 5.2); zero for none, from -1e3 to 1e3. Techniques without such an
    /// observer ignore it.
    pub injection: f64,
    /// Share of the model's friction at the reference's velocity that techniques without a model
    /// have beside their own estimate, from 0 to 1; the others ignore it.
    #[serde(default, skip_serializing_if = "is_none")]
    pub ahead: f64,
    /// How the velocity between two cycles is taken.
    #[serde(default, skip_serializing_if = "is_held")]
    pub scheme: Scheme,
    /// Which velocity the estimator believes.
    #[serde(default)]
    pub velocity: VelocitySource,
    /// Whether the velocity controller is given the estimator's velocity too, in place of the
    /// tachometer's.
    #[serde(default)]
    pub feeds_controller: bool,
    /// What is believed of the drive.
    pub drive: NominalDrive,
}

/// Files of runs say nothing of the scheme that the thesis has.
fn is_held(scheme: &Scheme) -> bool {
    *scheme == Scheme::Held
}

/// Nor of an estimate without a share of the model's.
fn is_none(ahead: &f64) -> bool {
    *ahead == 0.0
}

impl Default for EstimatorOptions {
    /// The observer on the velocity of the tachometer, without error injection, on the SRV-02. Each
    /// velocity is held for a cycle, as in the thesis.
    fn default() -> Self {
        Self {
            technique: Technique::default(),
            injection: 0.0,
            ahead: 0.0,
            scheme: Scheme::Held,
            velocity: VelocitySource::default(),
            feeds_controller: false,
            drive: NominalDrive::SRV02,
        }
    }
}

impl EstimatorOptions {
    /// Checks every field.
    ///
    /// # Errors
    /// [`ObserverError`] names the option that is out of range.
    pub fn check(&self) -> Result<(), ObserverError> {
        self.technique.check()?;
        within("injection", self.injection, -1e3..=1e3, "from -1e3 to 1e3")?;
        within("ahead", self.ahead, 0.0..=1.0, "from 0 to 1")?;
        self.velocity.check()?;
        Ok(self.drive.check()?)
    }
}
