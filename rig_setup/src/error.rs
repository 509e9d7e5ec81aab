//! What can end the setting up of a rig.

use parameters::ParameterError;
use parameters::file::FileError;
use rig_driver::RigError;

/// A rig that cannot be opened, driven or understood.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RigSetupError {
    /// The rig refused.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// A rig that is not driven here.
    #[error("{0}")]
    NotDriven(String),
    /// The nodes that are to drive the rig are missing or do not fit.
    #[error("{0}")]
    Nodes(String),
    /// The shaft does not move.
    #[error(
        "the shaft did not move {direction} up to {volts:.2} V: by the encoder it travelled {travelled} counts. Look at the motor's leads, the amplifier's enable and supply, \
         the encoder's plug; a stiff axis needs a higher voltage"
    )]
    DoesNotMove {
        /// At a positive or at a negative voltage.
        direction: &'static str,
        /// The highest magnitude that was tried \[V\].
        volts: f64,
        /// Travel by the encoder.
        travelled: i64,
    },
    /// The shaft turns by its tachometer, and the encoder does not count.
    #[error(
        "at {volts:.2} V the tachometer shows {velocity:.3} rad/s and the encoder does not count: the motor is at zero volts. Look at the encoder's plug and supply: turned by hand, its counts have to change"
    )]
    EncoderStands {
        /// The magnitude at which it was seen \[V\].
        volts: f64,
        /// What the tachometer showed [rad/s].
        velocity: f64,
    },
    /// The shaft moves where it should stand.
    #[error(
        "the shaft moved by {counts} counts at zero volts: something else turns it, or the encoder picks up noise; hold it still and start again"
    )]
    MovesAtRest {
        /// Travel by the encoder.
        counts: i64,
    },
    /// The encoder does not follow the voltage.
    #[error(
        "the encoder does not follow the voltage: at some voltages it counts up, at others of the same sign it counts down; look at its two lines and its supply"
    )]
    EncoderErratic,
    /// Readings from which nothing follows.
    #[error(
        "{what} cannot be worked out: the readings do not change enough; a higher voltage may help"
    )]
    Undetermined {
        /// What was to be found.
        what: &'static str,
    },
    /// The device is not the one of the rig profile.
    #[error(
        "the device on {rig} is not the one of the rig profile: {what}; nothing has moved. Calibrate this device, and write the profile for it"
    )]
    OtherDevice {
        /// Where it is.
        rig: String,
        /// In what it differs.
        what: String,
    },
    /// Stopped by the user.
    #[error("stopped; the motor is at zero volts and nothing was written")]
    Stopped,
}

impl RigSetupError {
    /// Whether it is the line to the rig that failed, and nothing about the motor; see
    /// [`RigError::is_of_the_line`].
    #[must_use]
    pub const fn is_of_the_line(&self) -> bool {
        matches!(self, Self::Rig(error) if error.is_of_the_line())
    }

    /// Whether whoever asked for it can mend it: another rig, another option, another profile.
    /// Nothing has moved then. A rig that is lost, or wired wrongly, is no such thing.
    #[must_use]
    pub const fn is_bad_input(&self) -> bool {
        match self {
            Self::Rig(error) => error.is_bad_input(),
            Self::NotDriven(_) | Self::Nodes(_) | Self::OtherDevice { .. } => true,
            Self::DoesNotMove { .. }
            | Self::EncoderStands { .. }
            | Self::MovesAtRest { .. }
            | Self::EncoderErratic
            | Self::Undetermined { .. }
            | Self::Stopped => false,
        }
    }
}

/// A section that cannot be had of a parameter file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SectionError {
    /// No ROS 2 parameter file.
    #[error(transparent)]
    File(#[from] FileError),
    /// It says nothing of the node.
    #[error("there is no node `rig_driver` in it")]
    NoNode,
    /// It says nothing of the section.
    #[error("`rig_driver` has no `{section}` in it")]
    NoSection {
        /// The section.
        section: &'static str,
    },
    /// It leaves out a value of the section.
    #[error("in `{section}`: `{name}` is missing")]
    Missing {
        /// The section.
        section: &'static str,
        /// The parameter.
        name: String,
    },
    /// A value is not what it should be, or a name is not known.
    #[error("in `rig_driver`: {0}")]
    Value(#[from] ParameterError),
}

impl SectionError {
    /// Whether there is nothing of the kind in the file.
    #[must_use]
    pub const fn is_missing(&self) -> bool {
        matches!(self, Self::NoNode | Self::NoSection { .. })
    }
}

/// A text that is no rig profile, or no calibration.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RigFileError {
    /// It cannot be read as such a file.
    #[error("{0}")]
    Unreadable(String),
    /// A section of a parameter file is missing, or cannot be read.
    #[error(transparent)]
    Parameters(#[from] SectionError),
    /// A rig profile without a calibration.
    #[error("it is a rig profile that has no calibration")]
    NoCalibration,
    /// A section of it cannot be.
    #[error("in `{section}`: {why}")]
    Section {
        /// The section.
        section: &'static str,
        /// What is wrong in it.
        why: String,
    },
}

impl RigFileError {
    /// Whether there is nothing of the kind in the text.
    #[must_use]
    pub const fn is_missing(&self) -> bool {
        matches!(self, Self::Parameters(error) if error.is_missing())
    }

    /// What is wrong in a section.
    pub(crate) fn section(section: &'static str, why: impl ToString) -> Self {
        Self::Section { section, why: why.to_string() }
    }
}

/// Why a rig whose line failed was not opened anew.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NotReopened(pub String);
