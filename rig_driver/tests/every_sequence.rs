//! Every sequence of events, up to a length, driven through the supervisor: requests, faults,
//! commands of every kind, cycles in time, late and lost, readings good and bad. Nothing is drawn
//! at random and nothing is left out.
//!
//! Beside the supervisor goes a second set of books, written from the promises and not from its
//! code. After every event the voltage is compared with what the books allow.

use rig_driver::Measurement;
use rig_driver::safety::{Fault, Request, SafetyLimits, SafetySupervisor, State, Travel};

const PERIOD: f64 = 1e-3;

fn limits() -> SafetyLimits {
    SafetyLimits {
        travel: Some(Travel { min: -2.0, max: 3.0, margin: 0.1 }),
        // The model of the winding has tests of its own; here it would only cost time.
        motor: None,
        ..SafetyLimits::default()
    }
}

/// What can happen. `Cycle`s carry the time since the cycle before and a reading; the others happen
/// between two cycles.
#[derive(Debug, Clone, Copy)]
enum Happening {
    Asked(Request),
    /// The back end reports a fault between two cycles.
    BackEndFault,
    Command(Stamp, f64),
    Cycle(f64, Reading),
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Stamp {
    Now,
    /// Older than commands may be.
    Old,
    /// Later than now.
    Ahead,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Reading {
    Good,
    NotANumber,
    BackEndFault,
    /// Outside the travel, within the margin.
    AtTheEnd,
    /// Beyond the margin.
    BeyondTheEnd,
}

impl Reading {
    /// Whether it has to latch a fault.
    const fn is_bad(self) -> bool {
        matches!(self, Self::NotANumber | Self::BackEndFault | Self::BeyondTheEnd)
    }
}

const HAPPENINGS: [Happening; 22] = {
    use Happening::{Asked, Command, Cycle};
    [
        Asked(Request::Configure),
        Asked(Request::CleanUp),
        Asked(Request::Activate),
        Asked(Request::Deactivate),
        Asked(Request::EmergencyStop),
        Asked(Request::Clear),
        Asked(Request::ShutDown),
        Happening::BackEndFault,
        Command(Stamp::Now, 1.5),
        Command(Stamp::Now, -50.0),
        Command(Stamp::Now, f64::NAN),
        Command(Stamp::Old, 1.0),
        Command(Stamp::Ahead, 2.0),
        Cycle(PERIOD, Reading::Good),
        Cycle(0.015, Reading::Good),
        Cycle(0.03, Reading::Good),
        Cycle(0.6, Reading::Good),
        Cycle(-PERIOD, Reading::Good),
        Cycle(PERIOD, Reading::NotANumber),
        Cycle(PERIOD, Reading::BackEndFault),
        Cycle(PERIOD, Reading::AtTheEnd),
        Cycle(PERIOD, Reading::BeyondTheEnd),
    ]
};

/// The promises' own books.
#[derive(Debug, Clone, Copy)]
struct Books {
    now: f64,
    /// No cycle has been: nobody knows how long ago the one before was.
    fresh: bool,
    cycle: u64,
    state: State,
    /// Stamp of the newest command since the activation.
    newest: Option<f64>,
    /// The cycle before was late.
    late: bool,
    at_the_end: bool,
    before: f64,
}

impl Books {
    fn happened(&mut self, happening: Happening, accepted: bool) {
        let may_fault = matches!(self.state, State::Inactive | State::Active | State::Faulted);
        let state = self.state;
        match happening {
            Happening::Asked(request) if accepted => {
                self.state = match request {
                    Request::Configure | Request::Deactivate => State::Inactive,
                    Request::CleanUp => State::Unconfigured,
                    Request::Activate => State::Active,
                    Request::EmergencyStop => State::EmergencyStopped,
                    Request::Clear if state == State::Faulted => State::Inactive,
                    Request::Clear => State::Unconfigured,
                    Request::ShutDown => State::Finalized,
                };
            }
            Happening::Asked(_) => {}
            Happening::BackEndFault => {
                if may_fault {
                    self.state = State::Faulted;
                }
            }
            Happening::Command(stamp, volts) => {
                if !volts.is_finite() && may_fault {
                    self.state = State::Faulted;
                } else if state == State::Active {
                    let stamp = if stamp == Stamp::Old { self.now - 0.021 } else { self.now };
                    self.newest = Some(self.newest.map_or(stamp, |before| before.max(stamp)));
                }
            }
            Happening::Cycle(gap, reading) => {
                // The first cycle comes after none.
                let told = self.now + gap;
                let gap = if self.fresh { 0.0 } else { gap };
                self.now = if self.fresh { told } else { self.now.max(told) };
                self.fresh = false;
                self.late = gap > 0.02;
                let watching = !matches!(state, State::Unconfigured | State::Finalized);
                if watching {
                    self.at_the_end = matches!(reading, Reading::AtTheEnd | Reading::BeyondTheEnd);
                }
                if may_fault && (reading.is_bad() || !(0.0..=0.5).contains(&gap)) {
                    self.state = State::Faulted;
                }
                if self.state == State::Active
                    && self.newest.is_some_and(|stamp| self.now - stamp > 0.5)
                {
                    self.state = State::Faulted;
                }
            }
        }
        if self.state != State::Active {
            self.newest = None;
        }
    }

    /// What is to hold of a voltage now.
    fn hold(&mut self, volts: f64, path: &[Happening]) {
        assert!(volts.is_finite() && volts.abs() <= 6.0, "{volts} V after {path:?}");
        if volts != 0.0 {
            assert_eq!(self.state, State::Active, "{volts} V after {path:?}");
            let newest =
                self.newest.unwrap_or_else(|| panic!("{volts} V without a command after {path:?}"));
            assert!(self.now - newest <= 0.02, "{volts} V by an old command after {path:?}");
            assert!(!self.late, "{volts} V after a late cycle: {path:?}");
            assert!(volts < 0.0 || !self.at_the_end, "{volts} V out of the travel after {path:?}");
            let from = if volts * self.before > 0.0 { self.before.abs() } else { 0.0 };
            assert!(
                volts.abs() <= from + 2.0 + 1e-12,
                "{volts} V after {} V: {path:?}",
                self.before
            );
        }
        self.before = volts;
    }
}

struct Search {
    events: u64,
    driven: u64,
    path: Vec<Happening>,
}

impl Search {
    /// One event, then every sequence of `left` more.
    fn follow(&mut self, supervisor: &SafetySupervisor, books: Books, left: u32) {
        for happening in HAPPENINGS {
            let (mut supervisor, mut books) = (supervisor.clone(), books);
            self.path.push(happening);
            self.events += 1;
            let before = supervisor.state();
            let accepted = happen(&mut supervisor, &mut books, happening);
            books.happened(happening, accepted);
            let volts = supervisor.output();
            // The state is the books' own, whatever the path: a latched fault never leaves by
            // itself, a stop holds until it is cleared.
            assert_eq!(supervisor.state(), books.state, "from {before} after {:?}", self.path);
            if matches!(before, State::Faulted | State::EmergencyStopped)
                && supervisor.state() != before
            {
                assert!(
                    matches!(happening, Happening::Asked(_)),
                    "{before} left by itself: {:?}",
                    self.path
                );
            }
            if before == State::EmergencyStopped {
                assert_ne!(
                    supervisor.state(),
                    State::Inactive,
                    "cleared without configure: {:?}",
                    self.path
                );
            }
            if books.state == State::Active && before != State::Active {
                assert_eq!(volts, 0.0, "moved by a command from before: {:?}", self.path);
            }
            books.hold(volts, &self.path);
            self.driven += u64::from(volts != 0.0);
            // What was refused has changed nothing: what follows it, follows without it too, and is
            // searched there.
            let refused = matches!(happening, Happening::Asked(_)) && !accepted;
            if left > 0 && !refused {
                self.follow(&supervisor, books, left - 1);
            }
            self.path.pop();
        }
    }
}

/// Puts an event to the supervisor. Says whether a request was accepted.
fn happen(supervisor: &mut SafetySupervisor, books: &mut Books, happening: Happening) -> bool {
    match happening {
        Happening::Asked(request) => {
            let before = supervisor.state();
            let accepted = supervisor.request(request).is_ok();
            assert!(accepted || supervisor.state() == before, "a refusal changed the state");
            accepted
        }
        Happening::BackEndFault => {
            supervisor.fault(Fault::BackEnd, 0.0, 0.0);
            true
        }
        Happening::Command(stamp, volts) => {
            let stamp = match stamp {
                Stamp::Now => books.now,
                Stamp::Old => books.now - 0.021,
                Stamp::Ahead => books.now + 10.0,
            };
            supervisor.command(stamp, volts);
            true
        }
        Happening::Cycle(gap, reading) => {
            books.cycle += 1;
            let noise = if books.cycle.is_multiple_of(2) { 0.005 } else { -0.005 };
            let seen = Measurement {
                cycle: books.cycle,
                time: books.cycle as f64 * PERIOD,
                tachometer_velocity: noise,
                torque: if reading == Reading::NotANumber { f64::NAN } else { noise },
                encoder_position: match reading {
                    Reading::AtTheEnd => 3.05,
                    Reading::BeyondTheEnd => 3.2,
                    _ => 0.0,
                },
                fault: reading == Reading::BackEndFault,
                ..Measurement::default()
            };
            supervisor.cycle(books.now + gap, &seen);
            true
        }
    }
}

/// The supervisor after `path`, checked on the way, and every sequence of `depth` events from
/// there.
fn search(path: &[Happening], depth: u32) -> Search {
    let mut supervisor = SafetySupervisor::new(limits(), PERIOD).expect("valid limits");
    let mut books = Books {
        now: 0.0,
        fresh: true,
        cycle: 0,
        state: State::Unconfigured,
        newest: None,
        late: false,
        at_the_end: false,
        before: 0.0,
    };
    for happening in path {
        let accepted = happen(&mut supervisor, &mut books, *happening);
        assert!(accepted, "{path:?}");
        books.happened(*happening, accepted);
        books.hold(supervisor.output(), path);
    }
    let mut search = Search { events: 0, driven: 0, path: path.to_vec() };
    search.follow(&supervisor, books, depth - 1);
    search
}

/// From the start six events, with FRICTION_FULL seven. The same from a motor that turns, one event
/// less: what takes five events to reach from the start counts there from the first.
#[test]
fn no_sequence_of_events_gives_the_motor_a_voltage_that_it_may_not_have() {
    let depth = if std::env::var_os("FRICTION_FULL").is_some() { 7 } else { 6 };
    let start = search(&[], depth);
    let turning = [
        Happening::Asked(Request::Configure),
        Happening::Cycle(PERIOD, Reading::Good),
        Happening::Asked(Request::Activate),
        Happening::Command(Stamp::Now, 1.5),
        Happening::Cycle(PERIOD, Reading::Good),
    ];
    let moving = search(&turning, depth - 1);
    println!(
        "{} sequences from the start ({} with a voltage), {} from a turning motor ({} with one)",
        start.events, start.driven, moving.events, moving.driven
    );
    // The search reached what it is for.
    assert!(start.events > 1_000_000 && start.driven > 1000 && moving.driven > 10_000);
}
