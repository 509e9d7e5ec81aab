//! The identified drive as a simulation, with the controller and the estimator as they run.
//!
//! * [`shaft`]: the drive with its friction and delay.
//! * [`looped`]: the loop around it, and how it does on a task.
//! * [`robustness()`]: peak of the sensitivity and noise of the voltage, of the loop as it runs.
//!
//! It costs milliseconds and no rig time. It knows what was identified and nothing else: no
//! bristles, no ripple, no play.

pub mod looped;
pub mod robustness;
pub mod shaft;

pub use looped::{Looped, Settings};
pub use robustness::{Robustness, robustness};
pub use shaft::{Identified, Levels, Shaft};
