//! What can end a run.

use std::path::PathBuf;

use friction_ident::IdentError;
use rig_driver::RigError;

use crate::bag::BagError;
use crate::output::OutputError;
use crate::test_bed::TestBedError;

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
    Steady(#[from] crate::constant_velocity::SteadyError),
    /// The bag could not be written.
    #[error(transparent)]
    Bag(#[from] BagError),
    /// A result could not be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The steady points give no Stribeck curve.
    #[error("no Stribeck curve fits the points of this run: {0}")]
    Identification(#[from] IdentError),
    /// The friction torque cannot be worked out of a run.
    #[error("no friction torque from this run: {0}")]
    Torque(IdentError),
    /// The output folder holds something already.
    #[error("the output folder {} is not empty: its results would be mixed with those of this run; choose another with --out DIR", .0.display())]
    NotEmpty(PathBuf),
    /// A model was asked for whose parameters nobody knows.
    #[error(transparent)]
    Model(#[from] friction_model::ModelError),
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
}
