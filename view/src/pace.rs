//! How far one viewer may be behind.
//!
//! A viewer that reads slower than messages come leaves them in the buffers between: the system holds
//! megabytes of them at each end. What is shown would be seconds old, and an answer, of an emergency
//! stop too, would come as late. So marks go along with what is sent, as pings; by the protocol
//! (RFC 6455, section 5.5.3) each comes back once it was reached. Messages wait, and the oldest of
//! them are lost, while too much is under way.

use std::sync::atomic::{AtomicU64, Ordering};

/// Bytes under way at most, but for the last message and for answers.
const UNDER_WAY: u64 = 256 << 10;
/// Bytes between two marks.
const BETWEEN: u64 = 32 << 10;

/// What was sent to one viewer, and what of it has come there \[bytes\].
#[derive(Debug, Default)]
pub(crate) struct Pace {
    sent: AtomicU64,
    marked: AtomicU64,
    arrived: AtomicU64,
}

impl Pace {
    /// So much more is sent. True where a mark is due.
    pub(crate) fn sent(&self, bytes: usize) -> bool {
        let more = u64::try_from(bytes).unwrap_or(u64::MAX);
        let sent = self.sent.fetch_add(more, Ordering::Relaxed).saturating_add(more);
        sent.saturating_sub(self.marked.load(Ordering::Relaxed)) >= BETWEEN
    }

    /// The next mark.
    pub(crate) fn mark(&self) -> [u8; 8] {
        let sent = self.sent.load(Ordering::Relaxed);
        self.marked.store(sent, Ordering::Relaxed);
        sent.to_le_bytes()
    }

    /// A mark came back. One that was never sent means nothing.
    pub(crate) fn came_back(&self, mark: &[u8]) {
        if let Ok(mark) = mark.try_into().map(u64::from_le_bytes)
            && mark <= self.marked.load(Ordering::Relaxed)
        {
            self.arrived.fetch_max(mark, Ordering::Relaxed);
        }
    }

    /// Whether messages may go out.
    pub(crate) fn is_open(&self) -> bool {
        let arrived = self.arrived.load(Ordering::Relaxed);
        self.sent.load(Ordering::Relaxed).saturating_sub(arrived) < UNDER_WAY
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_wait_until_a_mark_comes_back() {
        let pace = Pace::default();
        assert!(!pace.sent(1000));
        assert!(pace.sent(BETWEEN as usize));
        let mark = pace.mark();
        assert!(!pace.sent(1000));
        assert!(pace.is_open());
        assert!(pace.sent(UNDER_WAY as usize));
        assert!(!pace.is_open());
        pace.came_back(&mark);
        assert!(!pace.is_open());
        pace.came_back(&pace.mark());
        assert!(pace.is_open());
    }

    #[test]
    fn a_mark_that_was_never_sent_opens_nothing() {
        let pace = Pace::default();
        pace.sent(UNDER_WAY as usize);
        for mark in [&u64::MAX.to_le_bytes()[..], b"", b"123456789", &UNDER_WAY.to_le_bytes()] {
            pace.came_back(mark);
            assert!(!pace.is_open(), "{mark:?}");
        }
    }
}
