//! Friction observers: what the friction torque is now.
//!
//! [`FrictionEstimator`] is the whole: which velocity it believes ([`VelocitySource`]), which
//! [`Technique`] makes the estimate, and over which model. The parts can be used alone:
//! [`FrictionObserver`] runs any model of `friction_model` at the control period,
//! [`DisturbanceObserver`], [`SuperTwisting`], [`FuzzyCompensator`] and [`RbfCompensator`] need no model, and [`adaptive`] follows friction
//! that drifts. None allocates or panics while it steps.

pub mod adaptive;
mod change;
mod disturbance_observer;
mod drive;
mod drive_inverse;
mod error;
mod estimate;
mod estimator;
mod finite;
mod fuzzy;
#[cfg(feature = "msgs")]
pub mod messages;
#[cfg(feature = "ros")]
pub mod node;
mod observer;
mod options;
pub mod parameters;
mod rbf;
mod running;
mod seen;
mod super_twisting;
mod technique;
pub mod velocity_estimator;

pub use disturbance_observer::{DisturbanceObserver, DisturbanceObserverOptions, FilterOrder};
pub use drive::NominalDrive;
pub use drive_inverse::DriveInverse;
pub use error::ObserverError;
pub use estimate::{Estimate, Source};
pub use estimator::FrictionEstimator;
pub use fuzzy::{FuzzyCompensator, FuzzyOptions};
pub use observer::FrictionObserver;
pub use options::EstimatorOptions;
pub use rbf::{RbfCompensator, RbfOptions};
pub use running::Adapted;
pub use seen::Seen;
pub use super_twisting::{SuperTwisting, SuperTwistingOptions};
pub use technique::{Technique, TechniqueName};
pub use velocity_estimator::{VelocityEstimator, VelocitySource, VelocitySourceName};
