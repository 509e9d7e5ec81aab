//! Friction compensation compared: by which means, over which model.
//!
//! * [`means`]: the techniques, and what each sets in the estimator and the controller.
//! * [`monte_carlo`]: what each is worth when its parameters are wrong.
//! * [`additions`]: those that need no model, with their defaults.
//! * [`arm`]: one column of a comparison: nothing, a technique, or a technique over a model.

pub mod additions;
pub mod arm;
pub mod means;
pub mod monte_carlo;

pub use arm::Arm;
pub use means::Means;
