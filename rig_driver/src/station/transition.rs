//! The node's transitions, one step at a time.

use super::{Presence, Station};
use crate::safety::Request;

/// What a transition needs done for it.
pub(crate) trait Hands {
    /// Opens the back end, its motor at zero volts. It may take long.
    fn open(&mut self) -> Result<(), String>;

    /// Starts the control thread on what was opened.
    fn start(&mut self) -> Result<(), String>;

    /// Sends the control thread a request.
    fn send(&mut self, number: u64, request: Request) -> Result<(), String>;

    /// Its answer, once it is there.
    fn answer(&mut self, number: u64) -> Option<Result<(), String>>;

    /// Tells the control thread to end, and lets go of a rig that has none.
    fn end(&mut self);

    /// Whether no control thread is left.
    fn has_ended(&mut self) -> bool;
}

/// Which transition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Kind {
    Configure,
    Activate,
    Deactivate,
    CleanUp,
}

/// Why a transition did not happen.
#[derive(Debug, Clone, PartialEq, Eq, Hash, thiserror::Error)]
pub(crate) enum Reason {
    #[error("the emergency stop is set; clear it first with ~/clear_fault")]
    Stopped,
    #[error("the node is leaving")]
    Leaving,
    #[error("the control thread does not answer: the rig hangs; take its power away if it moves. {}", if *.begun {
        "The request has begun, and its effect is undone"
    } else {
        "The request is withdrawn"
    })]
    NoAnswer {
        /// The thread has begun with it.
        begun: bool,
    },
    #[error("{0}")]
    Said(String),
}

/// What came of a step.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) enum Progress {
    /// The next step can be taken.
    Goes,
    /// Somebody else has to do something first.
    Waits,
    /// It is over.
    Done(Result<(), Reason>),
}

#[derive(Debug, Clone, PartialEq, Eq, Hash)]
enum Step {
    Begin,
    Check,
    Open,
    CheckOpened,
    Start,
    Send,
    Await(u64),
    GiveUp(u64),
    CheckLast,
    /// Withdraws the permission to move, then goes on.
    Take(Result<(), Reason>),
    End(Result<(), Reason>),
    AwaitEnd(Result<(), Reason>),
    Done(Result<(), Reason>),
}

/// A transition on its way.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct Walk {
    kind: Kind,
    at: Step,
}

impl Walk {
    pub(crate) const fn new(kind: Kind) -> Self {
        let at = match kind {
            Kind::Configure => Step::Begin,
            Kind::Activate => Step::Check,
            Kind::Deactivate => Step::Send,
            Kind::CleanUp => Step::Take(Ok(())),
        };
        Self { kind, at }
    }

    /// Waits no longer for the control thread's answer.
    pub(crate) fn give_up(&mut self) {
        if let Step::Await(number) = self.at {
            self.at = Step::GiveUp(number);
        }
    }

    #[cfg(test)]
    pub(super) const fn waits_for_an_answer(&self) -> bool {
        matches!(self.at, Step::Await(_))
    }

    /// Takes one step.
    pub(crate) fn step(&mut self, station: &Station, hands: &mut dyn Hands) -> Progress {
        let next = match &mut self.at {
            Step::Begin => {
                station.enter(Presence::Opening);
                Step::Check
            }
            Step::Check => match (held(station), self.kind) {
                (Err(why), _) => self.failed(why),
                (Ok(()), Kind::Configure) => Step::Open,
                (Ok(()), _) if station.permission.give() => Step::Send,
                (Ok(()), _) => self.failed(Reason::Leaving),
            },
            Step::Open => match hands.open() {
                Ok(()) => Step::CheckOpened,
                Err(why) => self.failed(Reason::Said(why)),
            },
            Step::CheckOpened => match held(station) {
                Ok(()) => {
                    // Before the thread is there: who presses the stop from here on waits for it.
                    station.enter(Presence::Running);
                    Step::Start
                }
                Err(why) => self.failed(why),
            },
            Step::Start => match hands.start() {
                Ok(()) => Step::Send,
                Err(why) => self.failed(Reason::Said(why)),
            },
            Step::Send => {
                let number = station.desk.number();
                match hands.send(number, self.request()) {
                    Ok(()) => Step::Await(number),
                    Err(why) => self.failed(Reason::Said(why)),
                }
            }
            Step::Await(number) => match hands.answer(*number) {
                None => return Progress::Waits,
                Some(Ok(())) => self.answered(),
                Some(Err(why)) => self.failed(Reason::Said(why)),
            },
            Step::GiveUp(number) => {
                let number = *number;
                let begun = !station.desk.give_up(number);
                match if begun { hands.answer(number) } else { None } {
                    Some(Ok(())) => self.answered(),
                    Some(Err(why)) => self.failed(Reason::Said(why)),
                    None => self.failed(Reason::NoAnswer { begun }),
                }
            }
            Step::CheckLast => match held(station) {
                Ok(()) => Step::Done(Ok(())),
                Err(why) => self.failed(why),
            },
            Step::Take(outcome) => {
                station.permission.take();
                let outcome = outcome.clone();
                if self.kind == Kind::CleanUp { Step::End(outcome) } else { Step::Done(outcome) }
            }
            Step::End(outcome) => {
                hands.end();
                Step::AwaitEnd(outcome.clone())
            }
            Step::AwaitEnd(outcome) => {
                if !hands.has_ended() {
                    return Progress::Waits;
                }
                station.enter(Presence::Absent);
                Step::Done(outcome.clone())
            }
            Step::Done(outcome) => return Progress::Done(outcome.clone()),
        };
        self.at = next;
        Progress::Goes
    }

    const fn request(&self) -> Request {
        match self.kind {
            Kind::Configure => Request::Configure,
            Kind::Activate => Request::Activate,
            Kind::Deactivate | Kind::CleanUp => Request::Deactivate,
        }
    }

    fn answered(&self) -> Step {
        match self.kind {
            // The control thread has the motor at rest; the permission is not needed any more.
            Kind::Deactivate | Kind::CleanUp => Step::Take(Ok(())),
            Kind::Configure | Kind::Activate => Step::CheckLast,
        }
    }

    fn failed(&self, why: Reason) -> Step {
        match self.kind {
            Kind::Configure => Step::End(Err(why)),
            _ => Step::Take(Err(why)),
        }
    }
}

/// Whether something holds every transition that leads to motion.
fn held(station: &Station) -> Result<(), Reason> {
    if station.permission.has_left() {
        Err(Reason::Leaving)
    } else if station.latch.is_set() {
        Err(Reason::Stopped)
    } else {
        Ok(())
    }
}
