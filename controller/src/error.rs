//! What can be wrong with a controller's parameters.

use std::borrow::Cow;

use ::parameters::OutOfRange;

/// A gain, limit or specification a controller cannot be built from.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ControllerError {
    /// A number lies outside its range or is not finite.
    #[error("{name} must be {expected}, but is {value}; change it in the controller's parameters")]
    OutOfRange {
        /// The parameter.
        name: &'static str,
        /// What came.
        value: f64,
        /// What was expected.
        expected: Cow<'static, str>,
    },
    /// The specification asks for what this drive and this kind of controller cannot give.
    #[error("no {controller} meets the specification: {reason}")]
    Infeasible {
        /// The kind of controller.
        controller: &'static str,
        /// Why not, and what to ask for instead.
        reason: String,
    },
}

impl From<OutOfRange> for ControllerError {
    fn from(wrong: OutOfRange) -> Self {
        Self::OutOfRange { name: wrong.name, value: wrong.value, expected: wrong.expected().into() }
    }
}

/// Requires a finite number above zero.
pub(crate) fn positive(name: &'static str, value: f64) -> Result<(), ControllerError> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(ControllerError::OutOfRange {
            name,
            value,
            expected: "a finite number above zero".into(),
        })
    }
}

/// Requires a finite number, zero or more.
pub(crate) fn non_negative(name: &'static str, value: f64) -> Result<(), ControllerError> {
    if value >= 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(ControllerError::OutOfRange {
            name,
            value,
            expected: "a finite number, zero or more".into(),
        })
    }
}
