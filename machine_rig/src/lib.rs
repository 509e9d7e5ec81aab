//! Simulated rigs of every kind, each described by a file.
//!
//! The thesis's test bed is one rig. [`Machine`] describes any other: another motor and gear, a load
//! under gravity or behind backlash, a cable that pulls back, gear ripple, delay, coarse sensors,
//! friction that differs by direction and warms up, and what breaks when. [`MachineFactory`] makes
//! each an address, `machine:FILE`, for whoever installs it beside the standard rigs; [`random`]
//! draws machines for trials.

mod backlash;
mod breakdown;
mod description;
mod factory;
mod forces;
mod peaks;
pub mod random;
mod rig;
mod shaft;
mod shelf;
mod simulated;
mod stops;

pub use backlash::Backlash;
pub use breakdown::{Break, Breakdown};
pub use description::{Machine, MachineError, Sensed, Thermal, Warming};
pub use factory::MachineFactory;
pub use forces::{Forces, Gravity, Ripple, Spring};
pub use peaks::Peaks;
pub use rig::MachineRig;
pub use shelf::{forget, peaks};
pub use stops::Stops;
