//! Friction estimates on their way to the joint states that they answer.

use std::collections::VecDeque;

use ros_node::stamps::{Answers, Given};

use super::friction::Friction;

/// Estimates that wait for their joint state at most: the two come on different ways.
const WAITING: usize = 64;

/// Keeps the newest estimate that answers a joint state which was seen. What answers none does not
/// count. It neither locks nor allocates.
#[derive(Debug)]
pub(super) struct Estimates {
    seen: Given,
    /// They came before their joint state.
    waiting: VecDeque<Friction>,
    newest: Friction,
    /// Estimates of no joint state.
    strange: u64,
}

impl Estimates {
    /// Remembers that many joint states.
    pub(super) fn new(joints: usize) -> Self {
        Self {
            seen: Given::new(joints),
            waiting: VecDeque::with_capacity(WAITING),
            newest: Friction::default(),
            strange: 0,
        }
    }

    /// Forgets everything but the count.
    pub(super) fn clear(&mut self) {
        self.seen.clear();
        self.waiting.clear();
        self.newest = Friction::default();
    }

    /// A joint state has come.
    pub(super) fn see(&mut self, stamp_ns: u64) {
        self.seen.note(stamp_ns);
        for _ in 0..self.waiting.len() {
            if let Some(friction) = self.waiting.pop_front() {
                self.take(friction);
            }
        }
    }

    /// An estimate has come.
    pub(super) fn take(&mut self, friction: Friction) {
        match self.seen.judge(friction.stamp_ns) {
            Answers::Known if friction.stamp_ns >= self.newest.stamp_ns => self.newest = friction,
            Answers::Known => {}
            // Its joint state may be on its way.
            Answers::Future => {
                if self.waiting.len() == WAITING {
                    self.waiting.pop_front();
                    self.strange += 1;
                }
                self.waiting.push_back(friction);
            }
            Answers::Unknown | Answers::Old => self.strange += 1,
        }
    }

    /// The newest that counts; with a stamp of zero if there is none.
    pub(super) const fn newest(&self) -> Friction {
        self.newest
    }

    /// How many answered no joint state since it was asked last.
    pub(super) fn strange(&mut self) -> u64 {
        std::mem::take(&mut self.strange)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1_000_000;

    fn friction(stamp_ns: u64) -> Friction {
        Friction { stamp_ns, torque: 0.3 }
    }

    #[test]
    fn an_estimate_counts_for_the_joint_state_that_it_answers_whichever_comes_first() {
        let mut estimates = Estimates::new(100);
        for cycle in 1..1000 {
            let (before, after) = if cycle % 3 == 0 { (true, false) } else { (false, true) };
            if before {
                estimates.take(friction(cycle * MS));
                assert_ne!(estimates.newest().stamp_ns, cycle * MS, "not before its joint state");
            }
            estimates.see(cycle * MS);
            if after {
                estimates.take(friction(cycle * MS));
            }
            assert_eq!(estimates.newest().stamp_ns, cycle * MS);
        }
        assert_eq!(estimates.strange(), 0, "the observer loses nothing");
    }

    #[test]
    fn an_estimate_of_no_joint_state_never_counts() {
        let mut estimates = Estimates::new(100);
        estimates.see(10 * MS);
        for stamp in [0, 9 * MS, 10 * MS + 1, 11 * MS - 1, u64::MAX] {
            estimates.take(friction(stamp));
        }
        estimates.see(11 * MS);
        estimates.see(12 * MS);
        assert_eq!(estimates.newest(), Friction::default());
        assert_eq!(estimates.strange(), 4, "the one of the far future waits still");
        // However many of the future come, the right one finds its place.
        (0..10_000).for_each(|more| estimates.take(friction(u64::MAX - more)));
        estimates.see(13 * MS);
        estimates.take(friction(13 * MS));
        assert_eq!(estimates.newest().stamp_ns, 13 * MS);
    }
}
