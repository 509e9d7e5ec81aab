//! The loop as it runs in the nodes: experiments driven over ROS 2.
//!
//! The executables `rig_driver`, `friction_observer` and `controller`, or `frictionlab live`, close
//! the loop; an experiment says what they are to do (parameters, lifecycle), publishes
//! `/reference`, or `/motor_voltage` where there is no controller, and listens. [`Assembler`] puts
//! together again what the nodes say of one cycle, [`Link`] is the place on the network,
//! [`NodesBench`] prepares the nodes for each run and leaves them as they were, and [`NodesLoop`]
//! is one run. [`NodesAxis`] is their rig alone, for whoever closes the loop here.

mod assembler;
mod bench;
mod link;
mod nodes_loop;
mod rig;

pub use assembler::{Assembler, Heard, Source, Whole};
pub use bench::{NodesBench, Wanted};
pub use link::Link;
pub use nodes_loop::{NodesLoop, Task};
pub use rig::NodesAxis;
