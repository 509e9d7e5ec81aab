//! What can be wrong with a rig.

use crate::SensorError;
use crate::quanser::QuanserError;
use crate::safety::{FaultReport, Refused, State};

/// A rig that cannot be built, or a command it refuses.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RigError {
    /// A parameter of the drive or the simulation lies outside its range.
    #[error("{name} must be {expected}, but is {value}; change it in the rig's parameters")]
    OutOfRange {
        /// The parameter.
        name: &'static str,
        /// What came.
        value: f64,
        /// What was expected.
        expected: &'static str,
    },
    /// A voltage limit that the rig cannot put out.
    #[error(
        "the voltage limit must be at most {range:.4} V, the voltage range of this rig by its own description, but is {limit} V; lower `voltage_limit`"
    )]
    BeyondRange {
        /// The limit that was asked for [V].
        limit: f64,
        /// The rig's range [V].
        range: f64,
    },
    /// A sensor's parameter lies outside its range.
    #[error(transparent)]
    Sensor(#[from] SensorError),
    /// A voltage that is not a finite number was refused: zero volts are applied and the fault is latched.
    #[error(
        "a motor voltage must be a finite number, but was {0}: zero volts are applied and a fault is latched; clear it once the controller is mended"
    )]
    VoltageNotFinite(f64),
    /// The serial line or the device on it.
    #[cfg(feature = "serial")]
    #[error(transparent)]
    Serial(#[from] crate::serial::SerialError),
    /// The Quanser card or its library.
    #[error(transparent)]
    Quanser(#[from] QuanserError),
    /// The safety layer latched a fault; the motor is at zero volts.
    #[error("the driver stopped the motor: {0}")]
    Safety(FaultReport),
    /// The motor is to move, but the driver is not active.
    #[error("the driver is {0} and the motor stays at zero volts; configure, activate or clear it first")]
    NotActive(State),
    /// A run has the rig; there is one shaft, and one run at a time.
    #[error("another run has the rig; wait until it is over")]
    Lent,
    /// Whoever drives was told to stop.
    #[error("stopped; the motor is at zero volts")]
    Stopped,
    /// The rig is driven elsewhere, and what was said there ends the run.
    #[error("{0}")]
    Elsewhere(String),
    /// A transition that the state does not allow.
    #[error(transparent)]
    Refused(Refused),
}
