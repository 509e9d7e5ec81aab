//! What can end a run.

use std::path::PathBuf;

use friction_ident::IdentError;
use rig_driver::RigError;

use crate::constant_velocity::SteadyError;
use crate::test_bed::TestBedError;
use files::OutputError;
use recording::bag::BagError;
use rig_setup::RigSetupError;

/// A run that could not be started or finished.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// Rig, observer or controller could not be put together.
    #[error(transparent)]
    TestBed(#[from] TestBedError),
    /// The rig refused a command.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// A constant velocity could not be driven or read.
    #[error(transparent)]
    Steady(#[from] SteadyError),
    /// The line to the rig failed and did not come back.
    #[error("{said}; {why}")]
    NotBack {
        /// How it failed.
        said: String,
        /// Why it could not go on.
        why: String,
    },
    /// The rig could not be opened.
    #[error("{0}")]
    Setup(#[from] RigSetupError),
    /// Experiments were to read a sensor that the rig does not have.
    #[error("this rig has no {sensor}; from its {instead} the friction torque can be worked out")]
    NoSensor {
        /// What is missing.
        sensor: &'static str,
        /// What can be used in its place.
        instead: &'static str,
    },
    /// A protocol asks for more voltage than there is: a cut excitation would not be the one that
    /// was asked for.
    #[error(
        "the protocol drive-excitation asks for {asked} V, but the voltage limit is {limit} V: lower it in a protocol of your own, or raise the limit if the rig stands it"
    )]
    ExcitedTooFar {
        /// The highest voltage of the protocol \[V\].
        asked: f64,
        /// The limit \[V\].
        limit: f64,
    },
    /// The bag could not be written.
    #[error(transparent)]
    Bag(#[from] BagError),
    /// A result could not be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The steady points give no Stribeck curve.
    #[error("no Stribeck curve fits the points of this run: {0}")]
    Identification(IdentError),
    /// The friction torque cannot be worked out of a run.
    #[error("no friction torque from this run: {0}")]
    Torque(IdentError),
    /// A model was asked for whose parameters nobody knows.
    #[error(transparent)]
    Model(#[from] friction_model::ModelError),
    /// A run that was stopped cannot go on.
    #[error("the run in {folder} cannot be resumed: {why}")]
    Resume {
        /// Its folder.
        folder: PathBuf,
        /// Why not.
        why: String,
    },
    /// Results could not be put into words.
    #[error(
        "the results cannot be written as {what}: {detail}; this is a mistake in the program, please report it"
    )]
    Describe {
        /// Which form.
        what: &'static str,
        /// What the library says.
        detail: String,
    },
    /// A run that had begun failed: nothing that was asked for is at fault any more.
    #[error(transparent)]
    Underway(Box<Self>),
}

impl RunError {
    /// What the rig said, where it was the rig that ended the run.
    #[must_use]
    pub const fn of_rig(&self) -> Option<&RigError> {
        match self {
            Self::Rig(error)
            | Self::Steady(SteadyError::Rig(error))
            | Self::TestBed(TestBedError::Rig(error)) => Some(error),
            Self::Underway(error) => error.of_rig(),
            _ => None,
        }
    }

    /// Whether whoever asked for the run can mend it. Nothing has moved then and nothing was
    /// written. A rig that is lost, a full disk or points that no curve fits are no such thing.
    #[must_use]
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::TestBed(error) => error.is_bad_input(),
            Self::Rig(error) | Self::Steady(SteadyError::Rig(error)) => error.is_bad_input(),
            Self::Setup(error) => error.is_bad_input(),
            Self::Bag(error) => error.is_bad_input(),
            Self::Output(error) => error.is_bad_input(),
            Self::NoSensor { .. }
            | Self::ExcitedTooFar { .. }
            | Self::Model(_)
            | Self::Resume { .. } => true,
            Self::Steady(SteadyError::Torque(_))
            | Self::NotBack { .. }
            | Self::Identification(_)
            | Self::Torque(_)
            | Self::Describe { .. }
            | Self::Underway(_) => false,
        }
    }

    /// The same, of a run that had begun.
    pub(super) fn underway(self) -> Self {
        Self::Underway(Box::new(self))
    }
}

#[cfg(test)]
mod tests {
    use std::io::ErrorKind;

    use super::*;

    #[test]
    fn what_fails_once_a_run_has_begun_is_nobodys_input() {
        let missing = || OutputError::Write {
            path: "runs/all-1/run.json".into(),
            source: ErrorKind::NotFound.into(),
        };
        let refused = RunError::from(missing());
        assert!(refused.is_bad_input());
        let lost = refused.underway();
        assert!(!lost.is_bad_input());
        assert_eq!(lost.to_string(), RunError::from(missing()).to_string());
        assert!(RunError::from(RigError::Stopped).underway().of_rig().is_some());
    }
}
