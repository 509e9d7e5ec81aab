//! What answers each measurement within its own cycle, where observer and controller live in the
//! rig driver's process.

use std::ops::ControlFlow;

use crate::{
    Measurement, RigError,
    safety::{FaultReport, State},
};

/// A cycle that has begun: what the rig measured, and whether its motor may move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BegunCycle {
    /// Time of the measurement [ns since the epoch].
    pub stamp_ns: u64,
    /// What the rig measured, its zeros taken off.
    pub measurement: Measurement,
    /// Friction torque by the chosen source [N m].
    pub effort: f64,
    /// The safety layer's state.
    pub state: State,
}

/// The same cycle, its voltage on the motor.
#[derive(Debug, Clone, PartialEq)]
pub struct EndedCycle {
    /// The safety layer's state.
    pub state: State,
    /// The fault that holds the motor.
    pub fault: Option<FaultReport>,
    /// Time since the start of the cycle before \[ns\]; zero for the first.
    pub period_ns: u64,
    /// Time from the start of the cycle until the voltage was on the motor \[ns\].
    pub execution_ns: u64,
    /// What the rig said to being waited for, or to the voltage.
    pub refused: Option<RigError>,
}

/// Observer and controller on the control thread itself. They are called between two deadlines: no
/// locks, no allocation, no messages.
pub trait InCycle: Send {
    /// The voltage for this cycle \[V\]; none to leave the motor to the commands that come over the
    /// network.
    fn answer(&mut self, begun: &BegunCycle) -> Option<f64>;

    /// Hears how the cycle ended, and says whether there is to be another one. If not the motor is
    /// at zero volts, and the thread ends.
    fn end(&mut self, ended: EndedCycle) -> ControlFlow<()>;
}
