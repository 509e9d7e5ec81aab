//! What an estimator is told once a cycle.

/// One cycle's readings and intentions, load side, SI units.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Seen {
    /// Velocity as measured by the tachometer \[rad/s\].
    pub velocity: f64,
    /// Position as measured by the encoder \[rad\].
    pub position: f64,
    /// Velocity that the reference asks for \[rad/s\].
    pub reference_velocity: f64,
    /// Controlled output minus its reference \[rad/s or rad, by mode\].
    pub error: f64,
    /// Voltage applied during the cycle before \[V\].
    pub voltage: f64,
    /// Friction torque as measured, where the rig has a sensor \[N m\].
    pub torque: Option<f64>,
}
