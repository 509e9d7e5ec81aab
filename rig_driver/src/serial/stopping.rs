//! What was told to stop has to say that it did. Pure: times and states come in.

use std::time::{Duration, Instant};

use rig_protocol::State;

/// Time between two requests for a change of state.
pub(super) const AGAIN: Duration = Duration::from_millis(10);
/// Time in which a stop has to be acknowledged by a measurement, and measurements that have to have
/// come in it: on a line that is silent nothing can be acknowledged, which is an error of its own.
pub(super) const PATIENCE: Duration = Duration::from_millis(100);
const MEASUREMENTS: u32 = 20;

/// A stop that the device was told, and has not acknowledged yet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stopping {
    /// By the emergency stop, which is acknowledged by the device's own latch.
    pub(super) emergency: bool,
    again: Instant,
    until: Instant,
    told: bool,
    heard: u32,
}

/// What is to be done about it now.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Next {
    /// Nothing.
    Wait,
    /// Say it again.
    Again,
    /// The device has acknowledged.
    Done,
}

impl Stopping {
    /// The device was told at `now`.
    pub(super) fn new(emergency: bool, now: Instant) -> Self {
        Self { emergency, again: now + AGAIN, until: now + PATIENCE, told: false, heard: 0 }
    }

    /// What is to be done at `now`, with what a measurement shows, if there is a new one.
    pub(super) fn next(&mut self, now: Instant, state: Option<State>) -> Next {
        self.heard = self.heard.saturating_add(state.is_some().into());
        let done = state.is_some_and(|state| match (self.emergency, state) {
            (true, state) => state == State::EmergencyStopped,
            (false, state) => state != State::Active,
        });
        if done {
            return Next::Done;
        }
        if now < self.again {
            return Next::Wait;
        }
        self.again = now + AGAIN;
        Next::Again
    }

    /// Whether the time is over; once.
    pub(super) fn overdue(&mut self, now: Instant) -> bool {
        let overdue = now >= self.until && self.heard >= MEASUREMENTS && !self.told;
        self.told |= overdue;
        overdue
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stop_is_said_again_every_10_ms_until_the_device_shows_it_and_told_once_when_it_does_not() {
        let begin = Instant::now();
        let at = |ms| begin + Duration::from_millis(ms);
        for (emergency, not_yet, done) in [
            (true, State::Inactive, State::EmergencyStopped),
            (true, State::Active, State::EmergencyStopped),
            (false, State::Active, State::Inactive),
            (false, State::Active, State::Fault),
        ] {
            let mut stopping = Stopping::new(emergency, begin);
            assert_eq!(stopping.next(at(1), Some(not_yet)), Next::Wait);
            assert_eq!(stopping.next(at(10), Some(not_yet)), Next::Again);
            assert_eq!(stopping.next(at(19), None), Next::Wait);
            assert_eq!(stopping.next(at(20), None), Next::Again);
            assert!(!stopping.overdue(at(100)), "nothing was heard that could have said so");
            for ms in 21..45 {
                stopping.next(at(ms), Some(not_yet));
            }
            assert!(!stopping.overdue(at(99)));
            assert!(stopping.overdue(at(100)) && !stopping.overdue(at(200)));
            assert_eq!(stopping.next(at(201), Some(not_yet)), Next::Again, "it goes on");
            assert_eq!(stopping.next(at(202), Some(done)), Next::Done);
        }
    }
}
