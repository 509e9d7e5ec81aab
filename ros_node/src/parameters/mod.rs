//! Declared parameters: each with a type, a description, a range and a reason when it says no.
//!
//! The rules are rclcpp's: a parameter keeps its type, undeclared ones cannot be set, and a set is
//! checked as a whole before anything changes. What a parameter is stands in
//! the crate `parameters`, which has no ROS; here are the six services and
//! `/parameter_events` ([`Parameters`]). [`RemoteParameters`](crate::RemoteParameters) asks another node.

mod events;
mod services;
mod store;
pub(crate) mod wire;

pub use ::parameters::{Declaration, Declared, ParameterError, ValueRange, Values, markdown_table};
pub use services::Parameters;
pub use store::{Change, Judge, ParameterStore, StoreError};
