//! The controller as a ROS 2 node.
//!
//! - [`ControllerNode`]: what it decides, published; for programs that have a loop of their own;
//! - [`run`]: the executable `controller`, a managed node that gives one command for each joint state ([`step`]).

mod controlling;
mod expressed;
mod parameters;
mod publishers;
mod reference;
mod step;

pub use controlling::run;
pub use expressed::parameters_of;
pub use parameters::declarations;
pub use publishers::ControllerNode;
