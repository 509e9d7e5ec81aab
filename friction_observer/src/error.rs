//! Errors of the observers.

use std::borrow::Cow;

use ::parameters::OutOfRange;
use friction_model::TorqueSource;

/// An option that cannot be.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ObserverError {
    /// A number out of its range.
    #[error("{name} must be {expected}, but is {value}; change it in the observer's parameters")]
    OutOfRange {
        /// The option.
        name: &'static str,
        /// What came.
        value: f64,
        /// What was expected.
        expected: Cow<'static, str>,
    },
    /// A source of the friction torque that observers have not.
    #[error("the friction torque of an observer comes from the `sensor` or the `voltage`, but `{}` was asked for", .0.name())]
    TorqueSource(TorqueSource),
    /// The Riccati equation of a Kalman filter has no usable solution.
    #[error(
        "no gain for the Kalman filter of the velocity: bring encoder_step, tachometer_noise, friction_walk and the drive's constants nearer to the defaults"
    )]
    NoGain,
}

impl From<OutOfRange> for ObserverError {
    fn from(wrong: OutOfRange) -> Self {
        Self::OutOfRange { name: wrong.name, value: wrong.value, expected: wrong.expected().into() }
    }
}

pub(crate) fn positive(name: &'static str, value: f64) -> Result<(), ObserverError> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(ObserverError::OutOfRange {
            name,
            value,
            expected: "a finite number above zero".into(),
        })
    }
}

pub(crate) fn within(
    name: &'static str,
    value: f64,
    range: std::ops::RangeInclusive<f64>,
    expected: &'static str,
) -> Result<(), ObserverError> {
    if range.contains(&value) {
        Ok(())
    } else {
        Err(ObserverError::OutOfRange { name, value, expected: expected.into() })
    }
}
