//! What can be wrong with a model's parameters.

use crate::ModelName;

/// A parameter or a step that a model cannot be built with.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// A parameter lies outside its range or is not a finite number.
    #[error("{model}.{parameter} must be {expected}, but is {value}{unit}; change it in the parameter file", unit = unit_suffix(unit))]
    OutOfRange {
        /// The model.
        model: ModelName,
        /// The parameter's name in files.
        parameter: &'static str,
        /// What came.
        value: f64,
        /// Unit of the value, empty for none.
        unit: &'static str,
        /// What was expected.
        expected: &'static str,
    },
    /// The period of the fixed-step form lies outside (0, 10 ms].
    #[error("the fixed step must lie in (0, 0.01] s, but is {0} s; run the loop at 100 Hz or faster")]
    TimeStep(f64),
    /// A model of that name does not exist.
    #[error("there is no friction model `{0}`; expected one of: {names}", names = ModelName::list())]
    UnknownModel(String),
}

fn unit_suffix(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}
