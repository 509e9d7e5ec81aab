//! Velocity and position control of one axis, with friction compensation.
//!
//! [`design`] turns specifications into gains; [`LagCompensator`] regulates velocity and [`Pid`] position; [`Controller`]
//! adds the plant inverse and the friction compensation and keeps the sum within the voltage limit. The step path
//! allocates nothing and cannot panic.

mod controller;
pub mod design;
mod error;
mod lag;
#[cfg(feature = "msgs")]
pub mod messages;
#[cfg(feature = "ros")]
pub mod node;
mod pid;
mod signals;

pub use controller::{Compensation, Controller, ControllerOptions, Feedback};
pub use error::ControllerError;
pub use lag::{LagCompensator, LagGains};
pub use pid::{DerivativeOn, Pid, PidGains};
pub use signals::{Command, ControlMode, Reference};
