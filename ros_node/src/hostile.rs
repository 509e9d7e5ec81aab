//! What anybody on the network may send to the nodes, and what becomes of it: the list of inputs
//! that may stop the rig. None may move it but the voltages of the one who commands.
//!
//! The nodes' own tests give each input to the logic and hold it to its row; the book shows the
//! rows.

use std::fmt;

/// What an input does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effect {
    /// Nothing: it is left out, and counted in `/diagnostics`.
    Dropped,
    /// Nothing: nobody is listened to yet.
    Unheard,
    /// The motor gets it as far as the limits allow.
    Limited,
    /// The motor is at zero volts, in a fault that somebody clears.
    Stops,
    /// The motor comes to rest until what is missing comes.
    Rests,
    /// A transition is refused, with a sentence.
    Refused,
}

impl fmt::Display for Effect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Dropped => "dropped and counted",
            Self::Unheard => "dropped",
            Self::Limited => "taken, within the limits",
            Self::Stops => "**stops the rig** until it is cleared",
            Self::Rests => "the shaft comes to rest until it is mended",
            Self::Refused => "a transition is refused",
        })
    }
}

/// One kind of input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hostile {
    /// Which node hears it.
    pub node: &'static str,
    /// What comes.
    pub input: &'static str,
    /// From whom.
    pub from: &'static str,
    /// What becomes of it.
    pub effect: Effect,
}

const RIG: &str = "rig_driver";
const OBSERVER: &str = "friction_observer";
const CONTROLLER: &str = "controller";
const ONE: &str = "the one that is listened to";
const OTHERS: &str = "another";
const ANYBODY: &str = "anybody";

const fn row(
    node: &'static str,
    input: &'static str,
    from: &'static str,
    effect: Effect,
) -> Hostile {
    Hostile { node, input, from, effect }
}

/// Every kind of input.
pub const HOSTILE: [Hostile; 27] = [
    row(RIG, "a voltage, whatever its stamp", OTHERS, Effect::Dropped),
    row(RIG, "a voltage that is no number", OTHERS, Effect::Dropped),
    row(RIG, "a voltage that is no number", ONE, Effect::Stops),
    row(RIG, "a voltage beyond the limit", ONE, Effect::Limited),
    row(RIG, "a voltage with a stamp from the future", ONE, Effect::Dropped),
    row(RIG, "a voltage with a stamp of no measurement", ONE, Effect::Dropped),
    row(RIG, "a voltage older than command_lost", ONE, Effect::Dropped),
    row(RIG, "a voltage before the activation", ANYBODY, Effect::Unheard),
    row(RIG, "voltages of two within half a second before an activation", ANYBODY, Effect::Refused),
    row(
        RIG,
        "any voltage while the controller in the same process (`live`) commands",
        ANYBODY,
        Effect::Dropped,
    ),
    row(RIG, "no voltage for command_lost", ONE, Effect::Stops),
    row(CONTROLLER, "a joint state of load_shaft", OTHERS, Effect::Dropped),
    row(CONTROLLER, "a joint state with a stamp from the future", ONE, Effect::Dropped),
    row(CONTROLLER, "a joint state with a stamp that is not later", ONE, Effect::Dropped),
    row(CONTROLLER, "a joint state of another joint", ANYBODY, Effect::Dropped),
    row(CONTROLLER, "a joint state beyond what a shaft does", ANYBODY, Effect::Dropped),
    row(CONTROLLER, "joint states that are no numbers", ONE, Effect::Rests),
    row(CONTROLLER, "a friction estimate", OTHERS, Effect::Dropped),
    row(CONTROLLER, "a friction estimate of no joint state", ONE, Effect::Dropped),
    row(CONTROLLER, "a friction estimate that is no number", ANYBODY, Effect::Dropped),
    row(CONTROLLER, "a reference", OTHERS, Effect::Dropped),
    row(
        CONTROLLER,
        "a reference that is no number, or beyond what a shaft does",
        ANYBODY,
        Effect::Dropped,
    ),
    row(CONTROLLER, "no reference for reference_timeout", ONE, Effect::Rests),
    row(OBSERVER, "a joint state of load_shaft, a voltage or a reference", OTHERS, Effect::Dropped),
    row(OBSERVER, "a joint state with a stamp from the future, or not later", ONE, Effect::Dropped),
    row("every node", "bytes that are no message of the type", ANYBODY, Effect::Dropped),
    row(
        "every node",
        "configure or activate beside an older node of the same name",
        ANYBODY,
        Effect::Refused,
    ),
];

/// The rows of a node.
pub fn of(node: &str) -> impl Iterator<Item = &'static Hostile> + '_ {
    HOSTILE.iter().filter(move |row| row.node == node)
}

/// The rows as Markdown.
#[must_use]
pub fn markdown_table() -> String {
    let head = "| node | what comes | from | what becomes of it |\n|---|---|---|---|\n";
    HOSTILE.iter().fold(head.to_owned(), |text, Hostile { node, input, from, effect }| {
        text + &format!("| {node} | {input} | {from} | {effect} |\n")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_row_is_there_twice_and_only_the_one_who_commands_moves_the_motor() {
        for (index, row) in HOSTILE.iter().enumerate() {
            assert!(!HOSTILE[..index].contains(row), "{row:?}");
            assert!(row.effect != Effect::Limited || row.from == ONE, "{row:?}");
            assert!(
                row.effect != Effect::Stops || row.from == ONE,
                "a stranger stops nothing: {row:?}"
            );
        }
    }
}
