//! The states of a managed node and the transitions between them: one table.

use msgs::lifecycle_msgs::{self, State, TransitionDescription};
use strum::{IntoStaticStr, VariantArray};

/// State of a managed node. The last six are those in which it works.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "lowercase")]
#[repr(u8)]
pub enum Phase {
    /// Not known.
    Unknown = State::PRIMARY_STATE_UNKNOWN,
    /// Nothing is set up.
    Unconfigured = State::PRIMARY_STATE_UNCONFIGURED,
    /// Set up, at rest.
    Inactive = State::PRIMARY_STATE_INACTIVE,
    /// Does its work.
    Active = State::PRIMARY_STATE_ACTIVE,
    /// Ended for good.
    Finalized = State::PRIMARY_STATE_FINALIZED,
    /// Sets up.
    Configuring = State::TRANSITION_STATE_CONFIGURING,
    /// Forgets what it was set up with.
    CleaningUp = State::TRANSITION_STATE_CLEANINGUP,
    /// Ends.
    ShuttingDown = State::TRANSITION_STATE_SHUTTINGDOWN,
    /// Begins its work.
    Activating = State::TRANSITION_STATE_ACTIVATING,
    /// Ends its work.
    Deactivating = State::TRANSITION_STATE_DEACTIVATING,
    /// Mends what went wrong.
    ErrorProcessing = State::TRANSITION_STATE_ERRORPROCESSING,
}

impl Phase {
    /// Every state, in the order in which `rcl_lifecycle` registers them.
    pub const ALL: &'static [Self] = <Self as VariantArray>::VARIANTS;

    /// Its name, as ROS spells it.
    #[must_use]
    pub fn label(self) -> &'static str {
        self.into()
    }

    /// As a message.
    #[must_use]
    pub fn message(self) -> State {
        State { id: self as u8, label: self.label().to_owned() }
    }
}

/// One transition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transition {
    /// Its number, a constant of `lifecycle_msgs/msg/Transition`.
    pub id: u8,
    /// Its name, by which it can be asked for too.
    pub label: &'static str,
    /// State before.
    pub start: Phase,
    /// State after.
    pub goal: Phase,
}

impl Transition {
    /// As a message.
    #[must_use]
    pub fn message(&self) -> lifecycle_msgs::Transition {
        lifecycle_msgs::Transition { id: self.id, label: self.label.to_owned() }
    }

    /// With its ends, as a message.
    #[must_use]
    pub fn description(&self) -> TransitionDescription {
        TransitionDescription {
            transition: self.message(),
            start_state: self.start.message(),
            goal_state: self.goal.message(),
        }
    }
}

const fn row(id: u8, label: &'static str, start: Phase, goal: Phase) -> Transition {
    Transition { id, label, start, goal }
}

/// Every transition there is. People ask for those that begin in a primary state; the others are
/// what the node's answer leads to. Numbers, names and order are those of `rcl_lifecycle`'s default
/// state machine; the names that people ask for are those of its graph, where all three ways to
/// shut down are called `shutdown`.
pub const TRANSITIONS: [Transition; 25] = {
    use Phase::{
        Activating, Active, CleaningUp, Configuring, Deactivating, ErrorProcessing, Finalized,
        Inactive, ShuttingDown, Unconfigured,
    };
    const SUCCESS: &str = "transition_success";
    const FAILURE: &str = "transition_failure";
    const ERROR: &str = "transition_error";
    [
        row(1, "configure", Unconfigured, Configuring),
        row(10, SUCCESS, Configuring, Inactive),
        row(11, FAILURE, Configuring, Unconfigured),
        row(12, ERROR, Configuring, ErrorProcessing),
        row(2, "cleanup", Inactive, CleaningUp),
        row(20, SUCCESS, CleaningUp, Unconfigured),
        row(21, FAILURE, CleaningUp, Inactive),
        row(22, ERROR, CleaningUp, ErrorProcessing),
        row(3, "activate", Inactive, Activating),
        row(30, SUCCESS, Activating, Active),
        row(31, FAILURE, Activating, Inactive),
        row(32, ERROR, Activating, ErrorProcessing),
        row(4, "deactivate", Active, Deactivating),
        row(40, SUCCESS, Deactivating, Inactive),
        row(41, FAILURE, Deactivating, Active),
        row(42, ERROR, Deactivating, ErrorProcessing),
        row(5, "shutdown", Unconfigured, ShuttingDown),
        row(6, "shutdown", Inactive, ShuttingDown),
        row(7, "shutdown", Active, ShuttingDown),
        row(50, SUCCESS, ShuttingDown, Finalized),
        row(51, FAILURE, ShuttingDown, Finalized),
        row(52, ERROR, ShuttingDown, ErrorProcessing),
        row(60, SUCCESS, ErrorProcessing, Unconfigured),
        row(61, FAILURE, ErrorProcessing, Finalized),
        row(62, ERROR, ErrorProcessing, Finalized),
    ]
};

/// The transition of that number, or of that label where the number is zero or does not fit, that
/// begins in `from`.
#[must_use]
pub fn find(from: Phase, id: u8, label: &str) -> Option<&'static Transition> {
    let mut here = TRANSITIONS.iter().filter(|row| row.start == from);
    if label.is_empty() {
        here.find(|row| row.id == id)
    } else {
        here.find(|row| row.label == label)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn from_each_working_state_there_is_one_way_for_each_answer() {
        for phase in Phase::ALL.iter().copied().filter(|phase| *phase as u8 >= 10) {
            for answer in ["transition_success", "transition_failure", "transition_error"] {
                let ways = TRANSITIONS
                    .iter()
                    .filter(|row| row.start == phase && row.label == answer)
                    .count();
                assert_eq!(ways, 1, "{phase:?} {answer}");
            }
        }
        assert!(
            TRANSITIONS
                .iter()
                .all(|row| row.start != Phase::Finalized && row.start != Phase::Unknown)
        );
    }

    #[test]
    fn transitions_are_found_by_number_and_by_name() {
        assert_eq!(find(Phase::Unconfigured, 1, "").unwrap().goal, Phase::Configuring);
        assert_eq!(find(Phase::Active, 0, "shutdown").unwrap().id, 7);
        assert_eq!(find(Phase::Inactive, 1, ""), None);
        assert_eq!(find(Phase::Inactive, 3, "activate").unwrap().id, 3);
    }
}
