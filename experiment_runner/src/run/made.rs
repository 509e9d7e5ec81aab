//! What becomes of a job.

use super::recorder::Kept;

/// What became of a job.
pub(crate) struct Made<R> {
    /// Start of its run [ns since the Unix epoch].
    pub start_ns: u64,
    /// What goes into the bag.
    pub kept: Kept,
    /// What it gave.
    pub result: R,
    /// Whether it was done before the run was stopped: the bag of that time has its cycles.
    pub replayed: bool,
}
