//! What can be wrong with a file that is to tell a drive.

use friction_model::MotorError;
use parameters::file::FileError;
use rig_setup::{RigFileError, SectionError};

/// A text that does not tell the drive.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DriveFileError {
    /// A ROS 2 parameter file with a mistake.
    #[error(transparent)]
    File(#[from] FileError),
    /// No YAML.
    #[error("{0}")]
    Yaml(String),
    /// A parameter file without the drive, or with a mistake in it.
    #[error(transparent)]
    Section(#[from] SectionError),
    /// A rig profile with a mistake.
    #[error(transparent)]
    Profile(#[from] RigFileError),
    /// A rig profile without a drive.
    #[error("this rig profile has no drive")]
    NoDrive,
    /// A rig profile without the motor's constants.
    #[error(
        "the drive of this rig profile has gain and time constant alone; the motor's constants are needed, which its identification finds with a torque sensor or is given"
    )]
    NoMotor,
    /// Constants that no motor has.
    #[error("in `drive`: {0}")]
    Motor(#[from] MotorError),
    /// Neither the motor's constants nor gain and time constant.
    #[error(
        "expected the motor's constants (/rig_driver: ros__parameters: drive:) or `gain` [rad/s per V] and `time_constant` [s]"
    )]
    Nothing,
    /// A number that no drive has.
    #[error("the drive's numbers must be finite and above zero, but one is {0}")]
    Number(f64),
}
