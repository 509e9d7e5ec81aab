//! Parameters of the node `controller`.

use ros_node::parameters::{Declaration, Declared, ParameterError, Values};

use crate::{ControllerOptions, ControllerParameters};

/// Every parameter of the node, for what the command line gives: of the velocity laws, the one that
/// it gives gains to is the default.
#[must_use]
pub fn declarations(given: &[String]) -> Vec<Declaration> {
    ControllerParameters::for_given(given.iter().map(String::as_str)).declarations()
}

/// What the parameters say, read and checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ControlSettings {
    pub(super) options: ControllerOptions,
    pub(super) reference_timeout: f64,
    pub(super) reference_deceleration: f64,
    /// Velocity that the drive reaches at the voltage limit \[rad/s\].
    pub(super) fastest: f64,
    pub(super) estimate_timeout: f64,
    pub(super) estimate_wait: f64,
}

impl ControlSettings {
    /// Reads and checks the parameters as a whole.
    ///
    /// # Errors
    /// [`ParameterError`] with the reason.
    pub(super) fn read(values: &Values) -> Result<Self, ParameterError> {
        let said = ControllerParameters::default().with(values);
        Ok(Self {
            options: said.options()?,
            reference_timeout: said.reference_timeout,
            reference_deceleration: said.reference_deceleration,
            fastest: said.drive.gain * said.voltage_limit,
            estimate_timeout: said.estimate_timeout,
            estimate_wait: said.estimate_wait,
        })
    }
}
