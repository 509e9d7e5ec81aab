//! Managed nodes: states, transitions and the services that tell and change them
//! (<https://design.ros2.org/articles/node_lifecycle.html>).
//!
//! States and transitions are one table ([`TRANSITIONS`]), that of `rcl_lifecycle`. A node says in
//! [`Managed`] what it does on the way; [`RemoteLifecycle`] leads another node.

mod machine;
mod remote;
mod table;

pub use machine::{CallbackError, Lifecycle, Managed, Requested, TransitionError};
pub use remote::RemoteLifecycle;
pub use table::{Phase, TRANSITIONS, Transition, find};
