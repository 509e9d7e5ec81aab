//! The laboratory's nodes as processes, for those who have no `ros2 launch`.
//!
//! - [`arguments`]: what the launch files of `friction_bringup` take;
//! - [`files`]: the parameter files of that package, carried along;
//! - [`plan`]: which processes with which arguments, the same that the launch files start (a test
//!   compares them);
//! - [`supervise`]: starts them, passes on what they say, ends them together.

pub mod arguments;
mod error;
pub mod files;
pub mod plan;
pub mod supervise;

pub use arguments::{LaunchArguments, LaunchFile};
pub use error::LaunchError;
