//! Whether the motor may move, as far as the node's life cycle is concerned.

use std::sync::atomic::{AtomicU8, Ordering::SeqCst};

const RESTS: u8 = 0;
const MOVES: u8 = 1;
const LEFT: u8 = 2;

/// Given by the node when it activates, taken when it does anything else; the control thread reads
/// it before every voltage.
#[derive(Debug, Default)]
pub(crate) struct Permission(AtomicU8);

impl Permission {
    /// Gives it. False after the node has [left](Self::leave).
    pub(crate) fn give(&self) -> bool {
        self.0.compare_exchange(RESTS, MOVES, SeqCst, SeqCst) != Err(LEFT)
    }

    /// Takes it back.
    pub(crate) fn take(&self) {
        // Already at rest, or left.
        let _ = self.0.compare_exchange(MOVES, RESTS, SeqCst, SeqCst);
    }

    /// Takes it back for good: the node ends.
    pub(crate) fn leave(&self) {
        self.0.store(LEFT, SeqCst);
    }

    pub(crate) fn is_given(&self) -> bool {
        self.0.load(SeqCst) == MOVES
    }

    pub(crate) fn has_left(&self) -> bool {
        self.0.load(SeqCst) == LEFT
    }

    #[cfg(test)]
    pub(crate) fn copy(&self) -> Self {
        Self(AtomicU8::new(self.word()))
    }

    #[cfg(test)]
    pub(crate) fn word(&self) -> u8 {
        self.0.load(SeqCst)
    }
}
