//! What a rig reports once a cycle.

use serde::{Deserialize, Serialize};

/// One cycle's readings of every channel. SI units, load side of the gear.
///
/// Positive friction torque opposes positive velocity.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Measurement {
    /// Number of the control cycle, from 0.
    pub cycle: u64,
    /// Time since the rig started \[s\].
    pub time: f64,
    /// Encoder count, unwrapped.
    pub encoder_counts: i64,
    /// Position from the encoder \[rad\].
    pub encoder_position: f64,
    /// Velocity from the tachometer [rad/s].
    pub tachometer_velocity: f64,
    /// Position from the potentiometer \[rad\].
    pub potentiometer_position: f64,
    /// Friction torque from the torque sensor [N m].
    pub torque: f64,
    /// Mean motor current of the cycle before \[A\]; none on a rig that does not measure it.
    pub motor_current: Option<f64>,
    /// Voltage the controller asked for in the cycle before \[V\].
    pub voltage_asked: f64,
    /// Voltage that was applied in the cycle before \[V\].
    pub voltage_applied: f64,
    /// The voltage asked for was beyond a limit and was cut.
    pub saturated: bool,
    /// The command watchdog has expired.
    pub watchdog_expired: bool,
    /// A fault holds the output at zero volts.
    pub fault: bool,
}
