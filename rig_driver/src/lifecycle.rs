//! States of the driver and the transitions between them: one table.

use serde::{Deserialize, Serialize};
use strum::{IntoStaticStr, VariantArray};

/// State of the driver. The motor is at zero volts in every one but [`Active`](State::Active).
///
/// To ROS 2, unconfigured, inactive, active and finalized are the states of a managed node; faulted
/// and emergency-stopped are inactive there.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, strum::Display, VariantArray,
)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum State {
    /// Started, nothing set up.
    Unconfigured,
    /// Set up and watching the sensors.
    Inactive,
    /// The motor follows commands.
    Active,
    /// A fault holds the motor at zero volts until it is cleared.
    Faulted,
    /// Somebody stopped the motor; it stays at zero volts until that is cleared.
    EmergencyStopped,
    /// Shut down for good.
    Finalized,
}

impl State {
    /// Whether the motor may get another voltage than zero.
    #[must_use]
    pub const fn moves(self) -> bool {
        matches!(self, Self::Active)
    }
}

/// What people and programs ask of the driver.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray,
)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "lowercase")]
pub enum Request {
    /// Take the parameters and watch the sensors.
    Configure,
    /// Forget them.
    #[strum(serialize = "clean up")]
    CleanUp,
    /// Let the motor follow commands.
    Activate,
    /// Zero volts, orderly.
    Deactivate,
    /// Zero volts at once, from any state, until cleared.
    #[strum(serialize = "emergency stop")]
    EmergencyStop,
    /// The cause of a fault or of an emergency stop is mended.
    Clear,
    /// End for good.
    #[strum(serialize = "shut down")]
    ShutDown,
}

/// What moves the driver from one state to another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Event {
    /// It was asked for.
    Asked(Request),
    /// The supervisor found a fault that latches.
    Fault,
}

impl Event {
    /// Its name, as in documents and messages.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Asked(request) => request.into(),
            Self::Fault => "fault",
        }
    }
}

/// One transition that is allowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transition {
    /// State before.
    pub from: State,
    /// What happens.
    pub event: Event,
    /// State after.
    pub to: State,
}

const fn asked(from: State, request: Request, to: State) -> Transition {
    Transition { from, event: Event::Asked(request), to }
}

const fn fault(from: State) -> Transition {
    Transition { from, event: Event::Fault, to: State::Faulted }
}

/// Every transition there is. What is not in the table is refused.
pub const TRANSITIONS: [Transition; 19] = {
    use Request::{Activate, CleanUp, Clear, Configure, Deactivate, EmergencyStop, ShutDown};
    use State::{Active, EmergencyStopped, Faulted, Finalized, Inactive, Unconfigured};
    [
        asked(Unconfigured, Configure, Inactive),
        asked(Inactive, CleanUp, Unconfigured),
        asked(Inactive, Activate, Active),
        asked(Active, Deactivate, Inactive),
        fault(Inactive),
        fault(Active),
        fault(Faulted),
        asked(Faulted, Clear, Inactive),
        asked(Unconfigured, EmergencyStop, EmergencyStopped),
        asked(Inactive, EmergencyStop, EmergencyStopped),
        asked(Active, EmergencyStop, EmergencyStopped),
        asked(Faulted, EmergencyStop, EmergencyStopped),
        asked(EmergencyStopped, EmergencyStop, EmergencyStopped),
        // Whoever stopped the machine may have changed it: it is configured anew.
        asked(EmergencyStopped, Clear, Unconfigured),
        asked(Unconfigured, ShutDown, Finalized),
        asked(Inactive, ShutDown, Finalized),
        asked(Active, ShutDown, Finalized),
        asked(Faulted, ShutDown, Finalized),
        asked(EmergencyStopped, ShutDown, Finalized),
    ]
};

/// A request that the state does not allow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the driver is {state} and cannot `{}`; from here it can: {}", event.as_str(), allowed(*state))]
pub struct Refused {
    /// The state, which stays.
    pub state: State,
    /// What was asked for.
    pub event: Event,
}

fn allowed(state: State) -> String {
    let names: Vec<&str> = TRANSITIONS
        .iter()
        .filter(|rule| rule.from == state && rule.event != Event::Fault)
        .map(|rule| rule.event.as_str())
        .collect();
    if names.is_empty() { "nothing, start it anew".to_owned() } else { names.join(", ") }
}

/// The state after `event`.
///
/// # Errors
/// [`Refused`] if the table has no such transition.
pub fn next(state: State, event: Event) -> Result<State, Refused> {
    TRANSITIONS
        .iter()
        .find(|rule| rule.from == state && rule.event == event)
        .map(|rule| rule.to)
        .ok_or(Refused { state, event })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn events() -> impl Iterator<Item = Event> {
        Request::VARIANTS.iter().copied().map(Event::Asked).chain([Event::Fault])
    }

    /// All 48 pairs, against what is to hold of them in words, not against the table itself.
    #[test]
    fn every_pair_of_state_and_event_does_what_the_rules_in_words_say() {
        use Request::{Activate, CleanUp, Clear, Configure, Deactivate, EmergencyStop, ShutDown};
        for &state in State::VARIANTS {
            for event in events() {
                let after = next(state, event);
                let expected = match (state, event) {
                    (State::Finalized, _) => None,
                    (_, Event::Asked(EmergencyStop)) => Some(State::EmergencyStopped),
                    (_, Event::Asked(ShutDown)) => Some(State::Finalized),
                    (State::Unconfigured, Event::Asked(Configure))
                    | (State::Active, Event::Asked(Deactivate))
                    | (State::Faulted, Event::Asked(Clear)) => Some(State::Inactive),
                    (State::Inactive, Event::Asked(Activate)) => Some(State::Active),
                    (State::Inactive, Event::Asked(CleanUp))
                    | (State::EmergencyStopped, Event::Asked(Clear)) => Some(State::Unconfigured),
                    (State::Inactive | State::Active | State::Faulted, Event::Fault) => {
                        Some(State::Faulted)
                    }
                    _ => None,
                };
                assert_eq!(after.ok(), expected, "{state} on {event:?}");
            }
        }
    }

    #[test]
    fn no_transition_stands_twice_in_the_table() {
        for (i, rule) in TRANSITIONS.iter().enumerate() {
            let twin = TRANSITIONS
                .iter()
                .skip(i + 1)
                .find(|r| r.from == rule.from && r.event == rule.event);
            assert_eq!(twin, None, "{rule:?}");
        }
    }

    #[test]
    fn the_motor_moves_only_after_it_was_activated() {
        for rule in TRANSITIONS.iter().filter(|rule| rule.to.moves()) {
            assert_eq!((rule.from, rule.event), (State::Inactive, Event::Asked(Request::Activate)));
        }
    }

    #[test]
    fn a_refusal_says_what_would_be_allowed() {
        let text = next(State::Faulted, Event::Asked(Request::Activate)).unwrap_err().to_string();
        assert_eq!(
            text,
            "the driver is faulted and cannot `activate`; from here it can: clear, emergency stop, shut down"
        );
    }
}
