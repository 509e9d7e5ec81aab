//! A stop in the middle of a run, for tests: after so many jobs of whatever experiment.

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};

thread_local!(static LEFT: Cell<Option<usize>> = const { Cell::new(None) });

/// Stops the next run of this thread once `jobs` are delivered, or not at all.
pub fn set(jobs: Option<usize>) {
    LEFT.set(jobs);
}

/// Jobs that are left until the stop.
pub fn left() -> Option<usize> {
    LEFT.get()
}

pub(super) fn count(cancel: &AtomicBool) {
    if let Some(left) = LEFT.get() {
        LEFT.set(Some(left.saturating_sub(1)));
        if left <= 1 {
            cancel.store(true, Ordering::Relaxed);
        }
    }
}
