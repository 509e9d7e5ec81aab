//! Which stamps can be true.

use std::collections::VecDeque;

/// What a stamp says of the message that carries it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answers {
    /// It answers a message that was sent, not too long ago.
    Known,
    /// It is later than everything that was sent: the answer cannot have been asked for yet.
    Future,
    /// Nothing of that time was sent.
    Unknown,
    /// It may have been sent, but longer ago than is remembered.
    Old,
}

/// Stamps that were given out, so that an answer can be told from an invention. Noting and judging
/// neither lock nor allocate.
#[derive(Debug, Clone)]
pub struct Given {
    stamps: VecDeque<u64>,
    most: usize,
}

impl Given {
    /// Remembers the last `most`, at least one.
    #[must_use]
    pub fn new(most: usize) -> Self {
        let most = most.max(1);
        Self { stamps: VecDeque::with_capacity(most), most }
    }

    /// A stamp was given out, later than all before. One that is not is forgotten.
    pub fn note(&mut self, stamp_ns: u64) {
        if self.stamps.back().is_some_and(|last| *last >= stamp_ns) {
            return;
        }
        if self.stamps.len() == self.most {
            self.stamps.pop_front();
        }
        self.stamps.push_back(stamp_ns);
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.stamps.clear();
    }

    /// What a stamp is.
    #[must_use]
    pub fn judge(&self, stamp_ns: u64) -> Answers {
        match (self.stamps.front(), self.stamps.back()) {
            (_, None) => Answers::Unknown,
            (_, Some(last)) if stamp_ns > *last => Answers::Future,
            (Some(first), _) if stamp_ns < *first => Answers::Old,
            _ if self.stamps.binary_search(&stamp_ns).is_ok() => Answers::Known,
            _ => Answers::Unknown,
        }
    }
}

/// How far stamps may run ahead of the time that passed, because messages wait and come together
/// \[ns\].
const AHEAD: u64 = 100_000_000;
/// What two machines' clocks may drift apart, as a share of the time that passed: 1/1000.
const DRIFT: u64 = 1000;

/// Whether a stamp can follow those before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Follows {
    /// It can.
    Fits,
    /// It is not later than the one before.
    Backwards,
    /// More time went by in it than on the clock.
    Future,
}

/// A moment and the stamp that belongs to it \[ns\]: of the messages so far, that of the one which
/// took the shortest way.
#[derive(Debug, Clone, Copy)]
struct Anchor {
    at: u64,
    stamp: u64,
}

impl Anchor {
    /// Whether a stamp at `now` is not ahead of the time that passed; if so the anchor goes with
    /// it.
    fn fits(&mut self, stamp_ns: u64, now: u64) -> bool {
        let passed = now.saturating_sub(self.at);
        let (due, drift) = (self.stamp.saturating_add(passed), passed / DRIFT);
        if stamp_ns > due.saturating_add(AHEAD + drift) {
            return false;
        }
        // It took a shorter way; or clocks have drifted.
        if stamp_ns.saturating_add(drift.min(AHEAD / 2)) >= due {
            *self = Self { at: now, stamp: stamp_ns };
        }
        true
    }
}

/// Stamps that seemed too early, and only such, for so long: then the ones before were late, as
/// when a program that starts is held up \[ns\].
const HEALS: u64 = 500_000_000;

/// Stamps of one sender, which go forwards as time does. It needs no common clock: what counts is
/// how much time passes.
#[derive(Debug, Clone, Copy, Default)]
pub struct Forwards {
    last: Option<u64>,
    anchor: Option<Anchor>,
    early: Option<Early>,
}

/// Stamps that are ahead of the others, but go forwards among themselves.
#[derive(Debug, Clone, Copy)]
struct Early {
    since: u64,
    last: u64,
    anchor: Anchor,
}

impl Forwards {
    /// Begins with the next stamp, whatever it is.
    pub const fn reset(&mut self) {
        (self.last, self.anchor, self.early) = (None, None, None);
    }

    /// Judges a stamp that came at `now` \[ns on a clock that only goes forwards\], and keeps it if
    /// it fits.
    pub fn take(&mut self, stamp_ns: u64, now: u64) -> Follows {
        if self.last.is_some_and(|last| stamp_ns <= last) {
            return Follows::Backwards;
        }
        let new = Anchor { at: now, stamp: stamp_ns };
        if !self.anchor.get_or_insert(new).fits(stamp_ns, now) && !self.heals(new) {
            return Follows::Future;
        }
        (self.last, self.early) = (Some(stamp_ns), None);
        Follows::Fits
    }

    /// Notices an early stamp; whether the early ones are the right ones.
    fn heals(&mut self, new: Anchor) -> bool {
        let Anchor { at: now, stamp } = new;
        if let Some(early) = &mut self.early
            && stamp > early.last
            && early.anchor.fits(stamp, now)
        {
            early.last = stamp;
            let healed = now.saturating_sub(early.since) >= HEALS;
            if healed {
                self.anchor = Some(early.anchor);
            }
            return healed;
        }
        self.early = Some(Early { since: now, last: stamp, anchor: new });
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1_000_000;

    #[test]
    fn only_stamps_that_were_given_out_are_known() {
        let mut given = Given::new(500);
        assert_eq!(given.judge(7), Answers::Unknown);
        for cycle in 0..2000 {
            given.note(1_000 * MS + cycle * MS);
        }
        let last = 1_000 * MS + 1999 * MS;
        assert_eq!(given.judge(last), Answers::Known);
        assert_eq!(given.judge(last + 1), Answers::Future);
        assert_eq!(given.judge(u64::MAX), Answers::Future);
        assert_eq!(given.judge(last - 1), Answers::Unknown);
        assert_eq!(given.judge(last - 499 * MS), Answers::Known);
        assert_eq!(given.judge(last - 500 * MS), Answers::Old);
        given.note(5);
        assert_eq!(given.judge(last), Answers::Known, "time does not run backwards");
    }

    #[test]
    fn noting_allocates_nothing_more() {
        let mut given = Given::new(3);
        let room = given.stamps.capacity();
        (1..100).for_each(|stamp| given.note(stamp));
        assert_eq!((given.stamps.capacity(), given.stamps.len()), (room, 3));
    }

    #[test]
    fn stamps_go_forwards_as_time_does() {
        let mut stamps = Forwards::default();
        // Whatever the sender's clock says, also one without a clock.
        assert_eq!(stamps.take(5, 1_000_000 * MS), Follows::Fits);
        assert_eq!(stamps.take(5 + MS, 1_000_001 * MS), Follows::Fits);
        assert_eq!(stamps.take(5 + MS, 1_000_001 * MS), Follows::Backwards);
        assert_eq!(stamps.take(5, 1_000_001 * MS), Follows::Backwards);
        assert_eq!(stamps.take(10_000 * MS, 1_000_002 * MS), Follows::Future);
        assert_eq!(stamps.take(u64::MAX, 1_000_002 * MS), Follows::Future);
        // Held up for 90 ms, then all at once.
        for cycle in 2..92 {
            assert_eq!(stamps.take(5 + cycle * MS, 1_000_092 * MS), Follows::Fits, "{cycle}");
        }
    }

    #[test]
    fn a_first_message_that_came_late_does_not_make_the_next_ones_too_early() {
        let mut stamps = Forwards::default();
        assert_eq!(stamps.take(1000 * MS, 1080 * MS), Follows::Fits);
        for cycle in 1..5000 {
            assert_eq!(stamps.take((1000 + cycle) * MS, (1000 + cycle) * MS + 1), Follows::Fits);
        }
        assert_eq!(stamps.take(6110 * MS, 6001 * MS), Follows::Future);
    }

    #[test]
    fn a_program_that_was_held_up_when_it_started_hears_again() {
        let mut stamps = Forwards::default();
        // The first message waited for 3 s; those between are lost.
        assert_eq!(stamps.take(1000 * MS, 4000 * MS), Follows::Fits);
        for cycle in 0..500 {
            assert_eq!(stamps.take((4000 + cycle) * MS, (4000 + cycle) * MS), Follows::Future);
        }
        for cycle in 500..2000 {
            assert_eq!(stamps.take((4000 + cycle) * MS, (4000 + cycle) * MS), Follows::Fits);
        }
    }

    #[test]
    fn somebody_who_forges_the_sender_gets_nothing_while_the_sender_speaks() {
        let mut stamps = Forwards::default();
        for cycle in 1..5000 {
            assert_eq!(stamps.take(cycle * MS, cycle * MS), Follows::Fits);
            assert_eq!(stamps.take((cycle + 10_000) * MS, cycle * MS), Follows::Future);
        }
    }

    #[test]
    fn clocks_that_drift_apart_are_followed_for_days() {
        for (gains, held_up) in [(1.0002, 0), (0.9998, 0), (1.0002, 3 * MS), (0.9998, 3 * MS)] {
            let mut stamps = Forwards::default();
            // A day in steps of ten seconds.
            for step in 0..8640u64 {
                let now = step * 10_000 * MS;
                let stamp = 77 + (now as f64 * gains) as u64;
                let late = if step % 3 == 0 { held_up } else { 0 };
                assert_eq!(stamps.take(stamp, now + late), Follows::Fits, "{gains} {step}");
            }
        }
    }
}
