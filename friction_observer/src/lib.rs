//! Friction observers: what the friction torque is now, estimated by a model that runs on the measured velocity.
//!
//! [`FrictionObserver`] runs any model of `friction_model` at the control period. It allocates nothing and cannot panic.

mod estimate;
#[cfg(feature = "msgs")]
pub mod messages;
#[cfg(feature = "ros")]
pub mod node;
mod observer;

pub use estimate::Estimate;
pub use observer::FrictionObserver;
