//! Declared parameters: each with a type, a description, a range and a reason when it says no.
//!
//! The rules are rclcpp's: a parameter keeps its type, undeclared ones cannot be set, and a set is
//! checked as a whole before anything changes. The six services and `/parameter_events` are in
//! [`services`]; [`RemoteParameters`] asks another node.

mod declaration;
mod remote;
mod services;
mod store;
mod table;
mod values;

pub use declaration::{Declaration, ValueRange};
pub use remote::RemoteParameters;
pub use services::Parameters;
pub use store::{Change, ParameterStore};
pub use table::markdown_table;
pub use values::Values;
