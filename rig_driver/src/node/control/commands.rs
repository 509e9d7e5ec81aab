//! Commands that came over the network: when each was made, and whether it counts.

use std::time::Duration;

use ros_node::stamps::{Answers, Given};

/// Age from which a command without a stamp no longer counts as made when it comes.
pub(in crate::node) const WAITED: Duration = Duration::from_millis(100);

/// A voltage that somebody asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::node) struct VoltageCommand {
    /// Time of the measurement it answers to [ns since the epoch]; zero if it says none: then it
    /// was made when it came.
    pub(in crate::node) stamp_ns: u64,
    /// Volts.
    pub(in crate::node) volts: f64,
    /// When it came, by the clock of the deadlines [ns]. It may have waited in the queue since: a
    /// process that is stopped takes it out when it goes on.
    pub(in crate::node) came_ns: u64,
}

/// The time of a cycle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moment {
    /// By the clock of the deadlines [ns].
    pub(super) start_ns: u64,
    /// Since the epoch [ns].
    pub(super) stamp_ns: u64,
    /// Since the thread began [s].
    pub(super) now: f64,
}

impl Moment {
    /// How long ago a command came \[ns\].
    fn waited(&self, command: &VoltageCommand) -> u64 {
        self.start_ns.saturating_sub(command.came_ns)
    }

    /// Of a time since the epoch [ns], since the thread began [s].
    pub(super) fn since_start(&self, ns: u64) -> f64 {
        self.now + (ns as i128 - i128::from(self.stamp_ns)) as f64 * 1e-9
    }
}

/// What becomes of a command of the one who may command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fate {
    /// It goes to the supervisor.
    Counts {
        /// When it was made [ns since the epoch].
        made_ns: u64,
    },
    /// A voltage that is no number: the one who commands has lost its mind, whatever the stamp. The
    /// supervisor holds the motor.
    NoNumber,
    /// Too old to count at all.
    Stale,
    /// It answers a measurement that was not made yet.
    Future,
    /// It answers a measurement that there never was.
    Unknown,
    /// Commands come in memory.
    Outside,
}

/// What becomes of a command, given the stamps of the measurements; those before `oldest` [ns]
/// are too old. Without a stamp it was made when it came, and is too old after [`WAITED`].
pub(super) fn fate(command: &VoltageCommand, given: &Given, moment: Moment, oldest: u64) -> Fate {
    if !command.volts.is_finite() {
        return Fate::NoNumber;
    }
    if command.stamp_ns == 0 {
        let waited = moment.waited(command);
        let made_ns = moment.stamp_ns.saturating_sub(waited);
        let old = made_ns < oldest || Duration::from_nanos(waited) > WAITED;
        return if old { Fate::Stale } else { Fate::Counts { made_ns } };
    }
    match given.judge(command.stamp_ns) {
        Answers::Future => Fate::Future,
        Answers::Old => Fate::Stale,
        _ if command.stamp_ns < oldest => Fate::Stale,
        Answers::Unknown => Fate::Unknown,
        Answers::Known => Fate::Counts { made_ns: command.stamp_ns },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_counts_if_it_answers_a_measurement_that_was_made_a_moment_ago() {
        const MS: u64 = 1_000_000;
        const NOW: u64 = 1_700_000_000_000 * MS;
        let mut given = Given::new(502);
        (0..600).rev().for_each(|cycle| given.note(NOW - cycle * MS));
        let moment = Moment { start_ns: 9_000 * MS, stamp_ns: NOW, now: 8.0 };
        let command = |stamp_ns, volts| VoltageCommand { stamp_ns, volts, came_ns: 8_999 * MS };
        let at = |stamp_ns| fate(&command(stamp_ns, 6.0), &given, moment, NOW - 500 * MS);
        let counts = |made_ns| Fate::Counts { made_ns };
        for made_ns in [NOW, NOW - 7 * MS, NOW - 500 * MS] {
            assert_eq!(at(made_ns), counts(made_ns));
        }
        assert_eq!(at(0), counts(NOW - MS), "when it came");
        // A stranger's clock, a nanosecond ahead or ten seconds.
        assert_eq!([at(NOW + 1), at(NOW + 10_000 * MS), at(u64::MAX)], [Fate::Future; 3]);
        assert_eq!([at(NOW - 1), at(NOW - 7 * MS + 1)], [Fate::Unknown; 2]);
        assert_eq!([at(1), at(NOW - 501 * MS), at(NOW - 60_000 * MS)], [Fate::Stale; 3]);
        for volts in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let (of, oldest) = (command(u64::MAX, volts), 0);
            assert_eq!(fate(&of, &given, moment, oldest), Fate::NoNumber);
        }
    }

    /// A process that was stopped (SIGSTOP) takes what waited in its queue out when it goes on.
    #[test]
    fn a_command_without_a_stamp_was_made_when_it_came_whenever_it_is_taken_out() {
        const MS: u64 = 1_000_000;
        const NOW: u64 = 1_700_000_000_000 * MS;
        let given = Given::new(502);
        let after = |waited, lost| {
            let moment = Moment { start_ns: 9_000 * MS, stamp_ns: NOW, now: 8.0 };
            let came_ns = moment.start_ns - waited;
            let command = VoltageCommand { stamp_ns: 0, volts: 3.0, came_ns };
            fate(&command, &given, moment, NOW - lost)
        };
        let made = |made_ns| Fate::Counts { made_ns };
        assert_eq!(after(MS, 500 * MS), made(NOW - MS));
        assert_eq!(after(100 * MS, 500 * MS), made(NOW - 100 * MS));
        for waited in [101 * MS, 500 * MS, 8_000 * MS] {
            assert_eq!(after(waited, 500 * MS), Fate::Stale, "{waited} ns");
        }
        assert_eq!(after(21 * MS, 20 * MS), Fate::Stale, "older than `command_lost`");
    }
}
