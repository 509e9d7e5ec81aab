//! What goes into a controller and what comes out of it.

use serde::{Deserialize, Serialize};

use crate::{ControlFault, Diagnosis};

/// Where the axis should be.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Reference {
    /// Position \[rad\].
    pub position: f64,
    /// Velocity \[rad/s\].
    pub velocity: f64,
    /// Acceleration \[rad/s^2\].
    pub acceleration: f64,
}

/// What the controller is told of the axis.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Feedback {
    /// Position \[rad\].
    pub position: f64,
    /// Velocity \[rad/s\].
    pub velocity: f64,
    /// Friction torque as estimated \[N m\]; not used while compensation is off.
    pub friction: f64,
    /// Number of the cycle in which it was measured, where the source counts: the same number twice
    /// is a measurement that did not come.
    pub cycle: Option<u64>,
}

/// What the controller regulates.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Default,
    Serialize,
    Deserialize,
    strum::EnumString,
    strum::IntoStaticStr,
    strum::VariantNames,
)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum ControlMode {
    /// Velocity \[rad/s\] by the velocity law.
    #[default]
    Velocity,
    /// Position \[rad\] by the PID.
    Position,
}

/// The parts of one cycle's motor voltage. Before the limit they sum to `total`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Command {
    /// What the controller regulates.
    pub mode: ControlMode,
    /// Value the feedback is compared with (rad or rad/s, by mode).
    pub reference: f64,
    /// Measured value (rad or rad/s, by mode).
    pub feedback: f64,
    /// `reference - feedback`.
    pub error: f64,
    /// Part of the linear controller \[V\].
    pub linear: f64,
    /// Part of the plant inverse \[V\].
    pub inverse: f64,
    /// Part of the friction compensation \[V\].
    pub friction: f64,
    /// Part of the acceleration feedback \[V\].
    pub acceleration: f64,
    /// Part of the dither \[V\].
    pub dither: f64,
    /// Part of the knocker's impulses \[V\].
    pub impulse: f64,
    /// Voltage sent to the rig, after the limit \[V\].
    pub total: f64,
    /// The sum of the parts was beyond the limit.
    pub saturated: bool,
    /// Why the output is held at zero volts, until the controller is reset.
    pub fault: Option<ControlFault>,
    /// Fraction of the compensation that the guard holds back; 0 for none.
    pub held_back: f64,
    /// Why it is not 0.
    pub diagnosis: Option<Diagnosis>,
}
