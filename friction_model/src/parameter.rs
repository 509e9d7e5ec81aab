//! Checks that every parameter passes before a model exists.

use crate::{ModelError, ModelName};

/// Checks the parameters of one model, naming it in the error.
#[derive(Clone, Copy)]
pub(crate) struct Check(pub(crate) ModelName);

impl Check {
    /// Finite and above zero.
    pub(crate) fn positive(
        self,
        parameter: &'static str,
        value: f64,
        unit: &'static str,
    ) -> Result<(), ModelError> {
        self.require(value > 0.0, parameter, value, unit, "a finite number above zero")
    }

    /// Finite and not below zero.
    pub(crate) fn non_negative(
        self,
        parameter: &'static str,
        value: f64,
        unit: &'static str,
    ) -> Result<(), ModelError> {
        self.require(value >= 0.0, parameter, value, unit, "a finite number, zero or more")
    }

    /// Any condition, described by `expected`. A value that is not finite never passes.
    pub(crate) fn require(
        self,
        holds: bool,
        parameter: &'static str,
        value: f64,
        unit: &'static str,
        expected: &'static str,
    ) -> Result<(), ModelError> {
        if holds && value.is_finite() {
            Ok(())
        } else {
            Err(ModelError::OutOfRange { model: self.0, parameter, value, unit, expected })
        }
    }
}
