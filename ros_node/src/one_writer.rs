//! Who may write: of everybody who publishes on a topic, one is obeyed.
//!
//! The one is told by the GUID that DDS writes into each message. On a network without DDS Security
//! a GUID can be forged: this keeps mistakes and strangers away, and makes them seen, but it
//! authenticates nobody. Who must be sure needs DDS Security, which signs messages.

use std::fmt;

/// Time in which somebody who was heard counts as still there \[ns\].
pub const RECENT: u64 = 500_000_000;
/// Writers that are remembered; two are enough to know that there are several.
const REMEMBERED: usize = 8;

/// A writer of DDS: its GUID, twelve bytes of its participant and four of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct WriterId(pub [u8; 16]);

impl WriterId {
    /// Whether it belongs to that participant.
    #[must_use]
    pub fn is_of(&self, participant: &[u8; 16]) -> bool {
        self.0[..12] == participant[..12]
    }
}

impl fmt::Display for WriterId {
    /// As `ros2 topic info -v` writes it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().enumerate().try_for_each(|(index, byte)| {
            let dot = if index == 0 { "" } else { "." };
            write!(f, "{dot}{byte:02x}")
        })
    }
}

/// What becomes of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// It counts. Told is whether its writer is another one than that of the message before.
    Taken {
        /// It is the first of its writer.
        first: bool,
    },
    /// Nobody is obeyed now.
    Closed,
    /// Another one is obeyed.
    Other(WriterId),
    /// Nobody is obeyed yet, because this one speaks too and none may be preferred.
    Contested(WriterId),
}

/// Keeps to one writer. It knows no clock: times are \[ns\] on any that only goes forwards.
#[derive(Debug, Clone)]
pub struct OneWriter {
    open: bool,
    owner: Option<Heard>,
    /// Silence of the one after which another may follow it \[ns\]; none for never.
    handover: Option<u64>,
    recent: [Option<Heard>; REMEMBERED],
}

#[derive(Debug, Clone, Copy)]
struct Heard {
    writer: WriterId,
    at: u64,
}

impl Heard {
    fn is_recent(&self, now: u64) -> bool {
        now.saturating_sub(self.at) < RECENT
    }
}

impl OneWriter {
    /// Obeys nobody until it is opened. After `handover` \[ns\] of silence another writer may
    /// follow the one that is obeyed; without it the one stays until [`close`](Self::close).
    #[must_use]
    pub const fn new(handover: Option<u64>) -> Self {
        Self { open: false, owner: None, handover, recent: [None; REMEMBERED] }
    }

    /// From now on that silence counts \[ns\].
    pub fn hand_over_after(&mut self, silence: u64) {
        self.handover = Some(silence);
    }

    /// Whether another may ever follow the one without [`close`](Self::close).
    #[must_use]
    pub const fn hands_over(&self) -> bool {
        self.handover.is_some()
    }

    /// Obeys the first that speaks from now on.
    ///
    /// # Errors
    /// Two writers that both spoke a moment ago: none may be preferred. It stays as it was.
    pub fn open(&mut self, now: u64) -> Result<(), (WriterId, WriterId)> {
        let two = {
            let mut heard = self.heard(now);
            heard.next().zip(heard.next())
        };
        if let Some(two) = two {
            return Err(two);
        }
        self.open_first();
        Ok(())
    }

    /// Obeys the first that speaks from now on, whoever spoke before.
    pub const fn open_first(&mut self) {
        self.recent = [None; REMEMBERED];
        self.open_contested();
    }

    /// Obeys the first that speaks from now on, once it is the only one that was heard for
    /// [`RECENT`].
    pub const fn open_contested(&mut self) {
        self.open = true;
        self.owner = None;
    }

    /// Obeys nobody.
    pub const fn close(&mut self) {
        self.open = false;
        self.owner = None;
    }

    /// The one has left: another may follow at once.
    pub fn let_go(&mut self) {
        if let Some(owner) = self.owner.take() {
            let its = |heard: &Heard| heard.writer == owner.writer;
            self.recent.iter_mut().for_each(|heard| *heard = heard.filter(|heard| !its(heard)));
        }
    }

    /// Whether anybody may be obeyed.
    #[must_use]
    pub const fn is_open(&self) -> bool {
        self.open
    }

    /// The one that is obeyed.
    #[must_use]
    pub fn owner(&self) -> Option<WriterId> {
        self.owner.map(|owner| owner.writer)
    }

    /// Those that were heard a moment ago, obeyed or not.
    pub fn heard(&self, now: u64) -> impl Iterator<Item = WriterId> {
        let recent = self.recent.iter().flatten().filter(move |heard| heard.is_recent(now));
        recent.map(|heard| heard.writer)
    }

    /// Takes notice of a message of `writer`.
    pub fn hear(&mut self, writer: WriterId, now: u64) -> Verdict {
        self.remember(writer, now);
        if !self.open {
            return Verdict::Closed;
        }
        let old = self.owner;
        if let Some(owner) = old {
            if owner.writer == writer {
                self.owner = Some(Heard { writer, at: now });
                return Verdict::Taken { first: false };
            }
            if self.handover.is_none_or(|silence| now.saturating_sub(owner.at) < silence) {
                return Verdict::Other(owner.writer);
            }
        }
        let is_rival = |heard: &&Heard| {
            let known = heard.writer == writer || old.is_some_and(|old| old.writer == heard.writer);
            !known && heard.is_recent(now)
        };
        if let Some(rival) = self.recent.iter().flatten().find(is_rival) {
            return Verdict::Contested(rival.writer);
        }
        self.owner = Some(Heard { writer, at: now });
        Verdict::Taken { first: true }
    }

    fn remember(&mut self, writer: WriterId, at: u64) {
        let same = |heard: &Option<Heard>| heard.is_some_and(|heard| heard.writer == writer);
        let place = self.recent.iter().position(same).unwrap_or_else(|| {
            // An empty place, else that of the one who was silent longest.
            let age = |heard: &Option<Heard>| heard.map_or(0, |heard| heard.at + 1);
            (0..REMEMBERED).min_by_key(|index| age(&self.recent[*index])).unwrap_or(0)
        });
        self.recent[place] = Some(Heard { writer, at });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: WriterId = WriterId([1; 16]);
    const B: WriterId = WriterId([2; 16]);
    const C: WriterId = WriterId([3; 16]);
    const MS: u64 = 1_000_000;

    #[test]
    fn a_writer_is_written_as_the_command_line_writes_it() {
        assert_eq!(A.to_string(), "01.".repeat(15) + "01");
    }

    #[test]
    fn a_stranger_that_comes_after_activation_gets_nothing_however_much_it_sends() {
        let mut one = OneWriter::new(None);
        assert_eq!(one.hear(A, 0), Verdict::Closed);
        one.open(MS).unwrap();
        for cycle in 1..5000 {
            assert_eq!(one.hear(A, cycle * MS), Verdict::Taken { first: cycle == 1 });
            assert_eq!(one.hear(B, cycle * MS), Verdict::Other(A));
        }
        assert_eq!(one.hear(B, 1_000_000 * MS), Verdict::Other(A), "nor when the one is silent");
    }

    #[test]
    fn of_two_that_speak_before_activation_none_is_preferred() {
        let mut one = OneWriter::new(None);
        one.hear(A, 0);
        one.hear(B, 400 * MS);
        assert_eq!(one.open(450 * MS), Err((A, B)));
        assert_eq!(one.hear(A, 460 * MS), Verdict::Closed, "it stays as it was");
        assert_eq!(one.open(899 * MS), Err((A, B)));
        assert_eq!(one.open(900 * MS), Ok(()), "B was silent for long enough");
    }

    #[test]
    fn a_reference_given_once_is_followed_by_another_given_once() {
        let mut one = OneWriter::new(Some(100 * MS));
        one.open_contested();
        assert_eq!(one.hear(A, 0), Verdict::Taken { first: true });
        assert_eq!(one.hear(B, 99 * MS), Verdict::Other(A));
        assert_eq!(one.hear(B, 100 * MS), Verdict::Taken { first: true });
        assert_eq!(one.hear(A, 101 * MS), Verdict::Other(B));
        one.let_go();
        assert_eq!(one.hear(C, 102 * MS), Verdict::Contested(A), "who is left speaks still");
        assert_eq!(one.hear(C, 700 * MS), Verdict::Taken { first: true });
    }

    #[test]
    fn a_stranger_does_not_inherit_while_somebody_else_speaks_too() {
        let mut one = OneWriter::new(Some(RECENT));
        one.open_contested();
        one.hear(A, 0);
        // A dies; B was there as a stranger, C is the one that A's successor is.
        for step in 5..200 {
            assert_eq!(
                one.hear(B, step * 10 * MS),
                if step < 50 { Verdict::Other(A) } else { Verdict::Contested(C) }
            );
            assert_eq!(
                one.hear(C, step * 10 * MS + 1),
                if step < 50 { Verdict::Other(A) } else { Verdict::Contested(B) }
            );
        }
    }

    #[derive(Debug, Clone, Copy)]
    enum Event {
        Hear(WriterId),
        Wait(u64),
        Open,
        Close,
    }

    const EVENTS: [Event; 7] = [
        Event::Hear(A),
        Event::Hear(B),
        Event::Hear(C),
        Event::Wait(300 * MS),
        Event::Wait(600 * MS),
        Event::Open,
        Event::Close,
    ];

    /// What holds after every step of every sequence.
    fn searched(
        one: &OneWriter,
        now: u64,
        taken: Option<(WriterId, u64)>,
        open: bool,
        left: u32,
    ) -> u64 {
        if left == 0 {
            return 1;
        }
        let mut ends = 0;
        for event in EVENTS {
            let (mut one, mut now, mut taken, mut open) = (one.clone(), now, taken, open);
            match event {
                Event::Wait(time) => now += time,
                Event::Open => {
                    let opened = one.open(now).is_ok();
                    if opened {
                        (open, taken) = (true, None);
                    }
                }
                Event::Close => {
                    one.close();
                    (open, taken) = (false, None);
                }
                Event::Hear(writer) => {
                    let verdict = one.hear(writer, now);
                    if let Verdict::Taken { first } = verdict {
                        assert!(open, "nobody is obeyed while it is closed");
                        match taken {
                            Some((before, _)) if before == writer => assert!(!first),
                            Some((_, at)) => {
                                assert!(
                                    first
                                        && one.handover.is_some_and(|silence| now - at >= silence)
                                );
                            }
                            None => assert!(first),
                        }
                        taken = Some((writer, now));
                    } else if let Some((before, _)) = taken {
                        assert_ne!(
                            before, writer,
                            "the one that is obeyed loses nothing: {verdict:?}"
                        );
                    }
                }
            }
            assert_eq!(one.owner(), taken.map(|(writer, _)| writer));
            ends += searched(&one, now, taken, open, left - 1);
        }
        ends
    }

    #[test]
    fn every_sequence_of_events_keeps_to_one_writer() {
        let depth = if std::env::var_os("FRICTION_FULL").is_some() { 8 } else { 6 };
        for handover in [None, Some(400 * MS)] {
            let ends = searched(&OneWriter::new(handover), 1, None, false, depth);
            assert_eq!(ends, 7u64.pow(depth));
        }
    }
}
