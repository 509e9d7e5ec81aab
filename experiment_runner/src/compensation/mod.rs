//! Friction compensation compared: by which means, over which model.
//!
//! * [`means`]: the techniques, and what each sets in the estimator and the controller.
//! * [`monte_carlo`]: what each is worth when its parameters are wrong.
//! * [`arm`]: one column of a comparison: nothing, a technique, or a technique over a model.
//! * [`limit_cycle`]: the oscillation of a regulated position.
//! * [`example_5_4`]: the thesis's example of section 5.4.

pub mod arm;
pub mod example_5_4;
pub mod limit_cycle;
pub mod means;
pub mod monte_carlo;

pub use arm::Arm;
pub use limit_cycle::LimitCycle;
pub use means::Means;
