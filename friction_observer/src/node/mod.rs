//! The observer as a ROS 2 node.
//!
//! - [`ObserverNode`]: what it estimates, published; for programs that have a loop of their own;
//! - [`run`]: the executable `friction_observer`, a managed node that makes one estimate for each
//!   joint state ([`step`]);
//! - [`FrictionObserver`] and [`Inner`]: the same node taken apart, for a process whose control
//!   thread makes the estimates itself.

#[cfg(test)]
mod hostile;
mod observing;
mod program;
mod publishers;
mod step;

pub use crate::parameters::declarations;
pub use observing::{FrictionObserver, Inner, run};
pub use program::program;
pub use publishers::ObserverNode;
pub use step::{Beside, Estimated, Estimation, Joint};
