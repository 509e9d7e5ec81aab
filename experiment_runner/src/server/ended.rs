//! An experiment that was started, and how it ended.

use std::path::PathBuf;
use std::sync::Arc;

use crate::run::{RunError, RunResults};

/// An experiment that was started.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Started {
    /// Name of the run: the last part of its folder.
    pub run_id: String,
    /// Name of the experiment.
    pub experiment: &'static str,
    /// Where the results go, absolute.
    pub folder: PathBuf,
}

/// How an experiment ended.
#[derive(Debug)]
pub struct Ended {
    /// Which.
    pub started: Started,
    /// What was found, also if it was stopped; or why it failed.
    pub results: Result<RunResults, Arc<RunError>>,
}
