//! What can be wrong with a variable of the environment.

/// An environment variable of ROS has a value that is none of its own.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "the environment variable {name} must be {expected}, but is `{value}`; set it right or unset it"
)]
pub struct EnvironmentError {
    /// The variable.
    pub name: &'static str,
    /// What it may be.
    pub expected: &'static str,
    /// What it is.
    pub value: String,
}
