//! The controller as a ROS 2 node.
//!
//! - [`run`]: the executable `controller`, a managed node that gives one command for each joint
//!   state ([`step`]);
//! - [`ManagedController`] and [`Inner`]: the same node taken apart, for a process whose control
//!   thread gives the commands itself.

mod controlling;
mod estimates;
mod friction;
#[cfg(test)]
mod hostile;
mod parameters;
mod plausible;
mod program;
mod reference;
mod step;

pub use controlling::{Inner, ManagedController, run};
pub use friction::Friction;
pub use parameters::declarations;
pub use program::program;
pub use step::{Control, Decided, Joint};
