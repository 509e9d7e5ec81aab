//! Friction compensation compared: by which means, over which model.
//!
//! * [`means`]: the techniques, and what each sets in the estimator and the controller.
//! * [`additions`]: those that need no model, with their defaults.
//! * [`arm`]: one column of a comparison: nothing, a technique, or a technique over a model.
//! * [`limit_cycle`]: the oscillation of a regulated position.

pub mod additions;
pub mod arm;
pub mod limit_cycle;
pub mod means;

pub use arm::Arm;
pub use limit_cycle::LimitCycle;
pub use means::Means;
