//! What breaks, and when.

use serde::{Deserialize, Serialize};

/// What can break.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Break {
    /// The shaft is blocked.
    Blocked,
    /// The shaft comes loose from its load: nearly no inertia and no friction is left.
    TornLoose,
    /// The encoder stands still.
    EncoderUnplugged,
    /// The encoder loses counts in one direction, one of twenty.
    EncoderSkips,
    /// The encoder counts the other way: a loop around it runs away.
    EncoderReversed,
    /// The torque sensor stands at the end of its range.
    TorqueSaturated,
    /// The line is gone.
    Unplugged,
}

/// A break at a time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Breakdown {
    /// What breaks.
    pub what: Break,
    /// After so much time of the machine \[s\].
    pub after: f64,
}
