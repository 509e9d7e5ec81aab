//! The rig as a ROS 2 node.
//!
//! - [`RigNode`]: what it measures, published; for programs that have a loop of their own;
//! - [`run`]: the executable `rig_driver`, a managed node: a control thread ([`control`]) at the
//!   rig's period, commands over `/motor_voltage` with an age limit, the safety layer's states
//!   behind those of the managed node ([`driver`]);
//! - [`RigDriver`]: the same node for a process in which observer and controller answer on the
//!   control thread ([`InCycle`]).

mod axis;
mod commander;
mod control;
mod driver;
mod in_cycle;
mod limits_guard;
mod locked;
mod memory;
mod parameters;
mod program;
mod publishers;
mod torque_estimate;
mod warmth;
mod zero;

pub use driver::{Lasting, NotActive, RigDriver, run};
pub use in_cycle::{BegunCycle, EndedCycle, InCycle};
pub use parameters::declarations;
pub use program::program;
pub use publishers::RigNode;
