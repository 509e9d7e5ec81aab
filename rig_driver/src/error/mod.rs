//! What can be wrong with a rig.

mod quanser;
#[cfg(feature = "serial")]
mod serial;

use std::borrow::Cow;

use friction_model::MotorError;
use parameters::OutOfRange;

use crate::SensorError;
use crate::fault::{Fault, FaultReport};
use crate::lifecycle::{Refused, State};

pub use quanser::QuanserError;
#[cfg(feature = "serial")]
pub use serial::SerialError;

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
        expected: Cow<'static, str>,
    },
    /// A voltage limit that the rig cannot put out.
    #[error(
        "voltage_limit must be at most {range} V, the voltage range of this rig by its own description, but is {limit} V"
    )]
    BeyondRange {
        /// The limit that was asked for \[V\].
        limit: f64,
        /// The rig's range \[V\].
        range: f64,
    },
    /// A constant of the motor cannot be.
    #[error(transparent)]
    Motor(#[from] MotorError),
    /// A sensor's parameter lies outside its range.
    #[error(transparent)]
    Sensor(#[from] SensorError),
    /// A voltage that is not a finite number was refused: zero volts are applied and the fault is
    /// latched.
    #[error(
        "a motor voltage must be a finite number, but was {0}: zero volts are applied and a fault is latched; clear it once the controller is mended"
    )]
    VoltageNotFinite(f64),
    /// The serial line or the device on it.
    #[cfg(feature = "serial")]
    #[error(transparent)]
    Serial(#[from] SerialError),
    /// The Quanser card or its library.
    #[error(transparent)]
    Quanser(#[from] QuanserError),
    /// The safety layer latched a fault; the motor is at zero volts.
    #[error("the driver stopped the motor: {0}")]
    Safety(FaultReport),
    /// The motor is to move, but the driver is not active.
    #[error(
        "the driver is {0} and the motor stays at zero volts; configure, activate or clear it first"
    )]
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
    /// The file that describes a rig is wrong.
    #[error("{0}")]
    Description(String),
    /// The line to the rig is gone.
    #[error("the line to the rig is gone: look at its cable and its supply")]
    LineGone,
    /// A transition that the state does not allow.
    #[error(transparent)]
    Refused(Refused),
}

impl From<OutOfRange> for RigError {
    fn from(wrong: OutOfRange) -> Self {
        Self::OutOfRange { name: wrong.name, value: wrong.value, expected: wrong.expected().into() }
    }
}

impl RigError {
    /// Whether it is the line to the rig, or the time on this machine, that failed, and nothing
    /// about the motor: an explicit sequence may open the rig anew and begin again. Speed, travel,
    /// heat, sensors, an emergency stop, another host and whatever is unknown are no such thing.
    #[must_use]
    pub const fn is_of_the_line(&self) -> bool {
        match self {
            #[cfg(feature = "serial")]
            Self::Serial(error) => error.is_of_the_line(),
            Self::LineGone => true,
            Self::Safety(report) => {
                matches!(
                    report.fault,
                    Fault::CommandLost | Fault::CycleLost | Fault::CommandsRefused
                )
            }
            _ => false,
        }
    }

    /// Whether the device holds the motor at zero volts by a latch of its own, its emergency stop or a
    /// fault of it, until somebody clears that.
    #[must_use]
    pub const fn is_held(&self) -> bool {
        match self {
            #[cfg(feature = "serial")]
            Self::Serial(SerialError::NotActive { state, .. }) => {
                matches!(state, rig_protocol::State::Fault | rig_protocol::State::EmergencyStopped)
            }
            _ => false,
        }
    }

    /// Whether whoever asked for it can mend it: a parameter out of range, an address behind which
    /// there is no such rig. A rig that is lost, faulted or taken is no such thing.
    #[must_use]
    pub const fn is_bad_input(&self) -> bool {
        match self {
            Self::OutOfRange { .. }
            | Self::BeyondRange { .. }
            | Self::Motor(_)
            | Self::Sensor(_)
            | Self::Description(_) => true,
            #[cfg(feature = "serial")]
            Self::Serial(error) => error.is_bad_input(),
            Self::Quanser(error) => error.is_bad_input(),
            Self::VoltageNotFinite(_)
            | Self::Safety(_)
            | Self::NotActive(_)
            | Self::Lent
            | Self::Stopped
            | Self::Elsewhere(_)
            | Self::LineGone
            | Self::Refused(_) => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::safety::FAULTS;

    #[test]
    fn what_is_about_the_motor_is_not_of_the_line() {
        let of = |fault| {
            RigError::Safety(FaultReport { fault, time: 0.0, value: 0.0, limit: 0.0 })
                .is_of_the_line()
        };
        let line = [Fault::CommandLost, Fault::CycleLost, Fault::CommandsRefused];
        for fault in FAULTS.map(|rule| rule.fault) {
            assert_eq!(of(fault), line.contains(&fault), "{fault:?}");
        }
        assert!(
            !RigError::Stopped.is_of_the_line()
                && !RigError::NotActive(State::Faulted).is_of_the_line()
        );
    }
}
