//! A position-controlled servo with a pendulum: simulation, the peer's friction levels, search.

pub mod lanes;
pub mod level;
pub mod log;
pub mod parameter;
pub mod physics;
pub mod search;
pub mod spread;

pub use lanes::Lanes;
pub use level::FrictionLevel;
pub use log::{RawServoLog, ServoLog, TIME_STEP};
pub use parameter::ServoParameter;
pub use physics::Physics;
pub use search::{Effort, Found, search};
pub use spread::estimates;
