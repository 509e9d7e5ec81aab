//! Friction observers: what the friction torque is now.
//!
//! [`FrictionObserver`] runs any model of `friction_model` at the control period. [`FrictionEstimator`] is the whole: which velocity it believes, which
//! [`Technique`] makes the estimate, and over which model. It allocates nothing and cannot panic.

mod drive;
mod error;
mod estimate;
mod estimator;
#[cfg(feature = "msgs")]
pub mod messages;
#[cfg(feature = "ros")]
pub mod node;
mod observer;
mod seen;
mod technique;

pub use drive::NominalDrive;
pub use error::ObserverError;
pub use estimate::Estimate;
pub use estimator::{EstimatorOptions, FrictionEstimator};
pub use observer::FrictionObserver;
pub use seen::Seen;
pub use technique::Technique;
