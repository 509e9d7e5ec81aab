//! The request to the control thread that is under way: done, or given up, but never both.

use std::sync::atomic::{AtomicU64, Ordering::SeqCst};

/// Numbers requests. At most one is under way: whoever asks holds the lock of the queue.
#[derive(Debug, Default)]
pub(crate) struct Desk {
    last: AtomicU64,
    /// The one that waits; zero if none does, because it was begun or given up.
    waits: AtomicU64,
}

impl Desk {
    /// Numbers a request that is about to be sent.
    pub(crate) fn number(&self) -> u64 {
        let number = self.last.fetch_add(1, SeqCst) + 1;
        self.waits.store(number, SeqCst);
        number
    }

    /// The control thread is about to do it. False if it was given up: then it is not to be done.
    pub(crate) fn begin(&self, number: u64) -> bool {
        self.waits.compare_exchange(number, 0, SeqCst, SeqCst).is_ok()
    }

    /// Nobody waits for it any more. True if it will not be done; false if it has begun.
    pub(crate) fn give_up(&self, number: u64) -> bool {
        self.waits.compare_exchange(number, 0, SeqCst, SeqCst).is_ok()
    }

    #[cfg(test)]
    pub(crate) fn copy(&self) -> Self {
        let [last, waits] = self.numbers().map(AtomicU64::new);
        Self { last, waits }
    }

    #[cfg(test)]
    pub(crate) fn numbers(&self) -> [u64; 2] {
        [self.last.load(SeqCst), self.waits.load(SeqCst)]
    }
}
