//! The emergency stop as a latch: one word that people press and that everything which moves the
//! motor reads.

use std::sync::{
    Arc,
    atomic::{AtomicU64, Ordering::SeqCst},
};

/// An emergency stop. It is pressed before anything else is done, read before every voltage and
/// around every transition, and cleared only after it was seen at zero volts. Clones are one.
/// Nothing here waits or locks.
///
/// Presses are counted, so that one that comes while another is being cleared is not cleared with
/// it. Every access is sequentially consistent: what can happen is any order of the accesses and
/// nothing else, and a test goes through all of them.
#[derive(Debug, Clone, Default)]
pub struct StopLatch(Arc<Counts>);

#[derive(Debug, Default)]
struct Counts {
    pressed: AtomicU64,
    /// The newest press that was seen with the motor at zero volts.
    seen: AtomicU64,
    /// The newest press that was cleared.
    cleared: AtomicU64,
}

impl StopLatch {
    /// Presses it. Returns the number of this press.
    pub fn press(&self) -> u64 {
        self.0.pressed.fetch_add(1, SeqCst) + 1
    }

    /// The newest press; zero if there was none.
    #[must_use]
    pub fn newest(&self) -> u64 {
        self.0.pressed.load(SeqCst)
    }

    /// Whether a press holds the motor.
    #[must_use]
    pub fn is_set(&self) -> bool {
        // What is cleared never passes what was pressed: read in this order a doubt counts as set.
        let cleared = self.0.cleared.load(SeqCst);
        self.newest() > cleared
    }

    /// Notes that the motor is at zero volts because of `press`, or of a newer one, and stays
    /// there.
    pub fn note_seen(&self, press: u64) {
        self.0.seen.fetch_max(press, SeqCst);
    }

    /// Whether the motor was at zero volts after `press`.
    #[must_use]
    pub fn was_seen(&self, press: u64) -> bool {
        self.0.seen.load(SeqCst) >= press
    }

    /// Clears every press up to `press`, which must have been seen. Returns whether none holds the
    /// motor any more.
    #[must_use]
    pub fn clear(&self, press: u64) -> bool {
        if self.was_seen(press) {
            self.0.cleared.fetch_max(press, SeqCst);
        }
        !self.is_set()
    }

    /// Another latch in the same state, for tests that try what may come next.
    #[cfg(test)]
    pub(crate) fn copy(&self) -> Self {
        let [pressed, seen, cleared] = self.counts().map(AtomicU64::new);
        Self(Arc::new(Counts { pressed, seen, cleared }))
    }

    #[cfg(test)]
    pub(crate) fn counts(&self) -> [u64; 3] {
        [&self.0.pressed, &self.0.seen, &self.0.cleared].map(|count| count.load(SeqCst))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_holds_until_what_was_pressed_was_seen_and_cleared() {
        let latch = StopLatch::default();
        assert!(!latch.is_set());
        let press = latch.clone().press();
        assert!(latch.is_set(), "clones are one");
        assert!(!latch.clear(press), "not seen at zero volts yet");
        latch.note_seen(press);
        let second = latch.press();
        assert!(!latch.clear(press), "the second press is not cleared with the first");
        assert!(!latch.was_seen(second));
        latch.note_seen(second);
        assert!(latch.clear(second) && !latch.is_set());
    }
}
