//! Friction compensation compared: by which means, over which model.
//!
//! * [`means`]: the techniques, and what each sets in the estimator and the controller.
//! * [`monte_carlo`]: what each is worth when its parameters are wrong.
//! * [`additions`]: those that need no model, with their defaults.
//! * [`arm`]: one column of a comparison: nothing, a technique, or a technique over a model.
//! * [`limit_cycle`]: the oscillation of a regulated position.
//! * [`example_5_4`]: the thesis's example of section 5.4.
//! * [`thesis_rig`]: its simulations of section 6.5.
//! * [`matrix`]: every model as plant under every model as observer.
//! * [`thesis_tables`]: its tables of compensation, with ours beside them.

pub mod additions;
pub mod arm;
pub mod example_5_4;
pub mod limit_cycle;
pub mod matrix;
pub mod means;
pub mod monte_carlo;
pub mod thesis_rig;
pub mod thesis_tables;

pub use arm::Arm;
pub use limit_cycle::LimitCycle;
pub use means::Means;
