//! How far a machine was driven.

use serde::{Deserialize, Serialize};

/// The farthest that a machine was driven.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Peaks {
    /// Largest voltage \[V\].
    pub voltage: f64,
    /// Largest true speed [rad/s].
    pub velocity: f64,
    /// Farthest true position from the first \[rad\].
    pub position: f64,
    /// Largest true speed at which a stop was met [rad/s].
    #[serde(default)]
    pub hit: f64,
    /// Voltage that was given out last \[V\].
    pub last_voltage: f64,
    /// Time that it was driven \[s\].
    pub time: f64,
}
