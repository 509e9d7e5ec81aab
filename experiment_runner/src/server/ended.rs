//! An experiment that was started, and how it ended.

use std::path::PathBuf;
use std::sync::Arc;

use crate::errand::{Carried, Ending};
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
    /// What came of it.
    pub came: Came,
}

/// What came of an experiment, or of work beside experiments.
#[derive(Debug, Clone)]
pub enum Came {
    /// What an experiment found, also if it was stopped; or why it failed.
    Run(Box<Result<RunResults, Arc<RunError>>>),
    /// What came of other work.
    Errand(Carried),
}

impl Ended {
    /// Whether it did not fail.
    #[must_use]
    pub fn is_done(&self) -> bool {
        match &self.came {
            Came::Run(results) => results.is_ok(),
            Came::Errand(carried) => carried.ending == Ending::Complete,
        }
    }

    /// What an experiment found; none of other work, or where it failed.
    #[must_use]
    pub fn results(&self) -> Option<&RunResults> {
        match &self.came {
            Came::Run(results) => results.as_ref().as_ref().ok(),
            Came::Errand(_) => None,
        }
    }
}
