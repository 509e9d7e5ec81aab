//! What a friction observer says once a cycle.

use friction_model::{ModelName, Regime};

/// One cycle's friction estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Model behind the estimate.
    pub model: ModelName,
    /// Friction torque [N m]; positive opposes positive velocity.
    pub torque: f64,
    /// Bristle deflection z [rad]; zero for static models.
    pub deflection: f64,
    /// Stribeck state gamma [N m]: the present sliding level.
    pub gamma: f64,
    /// Stick or slip.
    pub regime: Regime,
    /// Velocity the estimate was made with [rad/s].
    pub velocity: f64,
    /// Measured torque minus `torque` [N m], where the rig has a torque sensor.
    pub residual: Option<f64>,
}
