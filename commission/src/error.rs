//! What can end a commission.

use controller::ControllerError;
use experiment_runner::test_bed::TestBedError;
use files::OutputError;
use friction_ident::IdentError;
use parameters::ParameterError;
use rig_driver::RigError;
use rig_setup::RigSetupError;

use crate::Stage;

/// A commission that cannot begin, or cannot go on. The motor is at zero volts.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CommissionError {
    /// The rig cannot be opened, driven or understood.
    #[error(transparent)]
    Rig(#[from] RigSetupError),
    /// The line to the rig failed, and what was underway could not be repeated.
    #[error(
        "{said}; {why}. Check the cable, the rig's supply, and what else keeps this machine busy; `frictionlab commission --resume FOLDER` goes on with what is kept"
    )]
    LineLost {
        /// How it failed.
        said: String,
        /// Why it could not go on.
        why: String,
    },
    /// A result cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The folder, or what was asked for, cannot be used.
    #[error("{0}")]
    Asked(String),
    /// What was measured says nothing.
    #[error("{stage}: {source}; `frictionlab commission --resume FOLDER` measures this stage anew")]
    Identification {
        /// The stage.
        stage: Stage,
        /// What the fit says.
        source: IdentError,
    },
    /// Something that a stage needs was not found.
    #[error("{stage}: {why}")]
    Unusable {
        /// The stage.
        stage: Stage,
        /// What is missing, and what to do.
        why: String,
    },
    /// A loop cannot be put together.
    #[error(transparent)]
    Loop(#[from] TestBedError),
    /// Gains that cannot be.
    #[error(transparent)]
    Gains(#[from] ControllerError),
    /// What was found cannot be said in parameters.
    #[error(transparent)]
    Parameters(#[from] ParameterError),
    /// The rig time that was allowed is used up.
    #[error(
        "{stage}: the next step takes {needed:.0} s of rig time, and {left:.0} s of the allowed {allowed:.0} s are left; `--resume FOLDER --minutes N` with a larger N goes on"
    )]
    OutOfTime {
        /// The stage.
        stage: Stage,
        /// What the step takes \[s\].
        needed: f64,
        /// What is left \[s\].
        left: f64,
        /// What was allowed \[s\].
        allowed: f64,
    },
}

impl From<RigError> for CommissionError {
    fn from(error: RigError) -> Self {
        Self::Rig(error.into())
    }
}

impl CommissionError {
    /// Whether whoever asked for it can mend it; nothing has moved then.
    #[must_use]
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Rig(error) => error.is_bad_input(),
            Self::Output(error) => error.is_bad_input(),
            Self::Asked(_) => true,
            _ => false,
        }
    }

    /// Whether it is the line to the rig, or the time on this machine, that failed, and nothing
    /// about the motor: what was underway may be repeated.
    #[must_use]
    pub const fn is_of_the_line(&self) -> bool {
        match self {
            Self::Rig(error) => error.is_of_the_line(),
            Self::Loop(TestBedError::Rig(error)) => error.is_of_the_line(),
            _ => false,
        }
    }

    /// Whether the device holds the motor at zero volts until somebody clears that.
    #[must_use]
    pub const fn is_held(&self) -> bool {
        match self {
            Self::Rig(RigSetupError::Rig(error)) | Self::Loop(TestBedError::Rig(error)) => {
                error.is_held()
            }
            _ => false,
        }
    }

    /// Whether the user stopped it.
    #[must_use]
    pub const fn is_stopped(&self) -> bool {
        matches!(
            self,
            Self::Rig(RigSetupError::Stopped | RigSetupError::Rig(RigError::Stopped))
                | Self::Loop(TestBedError::Rig(RigError::Stopped))
        )
    }
}
