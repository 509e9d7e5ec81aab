//! What can be wrong with a model's parameters.

use core::fmt;

use crate::{ModelName, Range, Unit};

/// A parameter or a step that a model cannot be built with.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// A parameter lies outside its range or is not a finite number.
    #[error("{model}.{parameter} must be {expected}, but is {value}{unit}; change it in the parameter file", unit = Spaced(*unit))]
    OutOfRange {
        /// The model.
        model: &'static str,
        /// The parameter's name in files.
        parameter: &'static str,
        /// What came.
        value: f64,
        /// Unit of the value.
        unit: Unit,
        /// What was expected.
        expected: Range,
    },
    /// Lists that describe the same elements have different lengths, or too many or no elements.
    #[error(
        "{model}: {parameter} has {given} elements, but {expected} are expected; every list of the model must describe the same elements"
    )]
    Elements {
        /// The model.
        model: &'static str,
        /// The list's name in files.
        parameter: &'static str,
        /// How many came.
        given: usize,
        /// How many were expected.
        expected: usize,
    },
    /// The period of the fixed-step form lies outside (0, 10 ms].
    #[error(
        "the fixed step must lie in (0, 0.01] s, but is {0} s; run the loop at 100 Hz or faster"
    )]
    TimeStep(f64),
    /// With these parameters a number of the model is not finite somewhere it may be driven.
    #[error(
        "{model}: with these parameters the {quantity} is {value} at a velocity of {velocity}, but every number must stay finite up to 1e6; the parameters lie too far apart, look for one in another unit"
    )]
    NotFinite {
        /// The model.
        model: &'static str,
        /// What is not finite.
        quantity: &'static str,
        /// What came.
        value: f64,
        /// At which velocity \[m/s or rad/s\].
        velocity: f64,
    },
    /// The two directions of an asymmetric contact are of different models.
    #[error(
        "an asymmetric contact needs the same model in both directions, but got {forward} and {backward}"
    )]
    TwoModels {
        /// Model of the forward direction.
        forward: ModelName,
        /// Model of the backward direction.
        backward: ModelName,
    },
    /// A model of that name does not exist.
    #[cfg(feature = "std")]
    #[error("there is no friction model `{0}`; expected one of: {names}", names = ModelName::list())]
    UnknownModel(String),
}

/// A unit with a space before it, nothing for pure numbers.
struct Spaced(Unit);

impl fmt::Display for Spaced {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0.rotary() {
            "" => Ok(()),
            unit => write!(f, " {unit}"),
        }
    }
}
