//! A position-controlled servo with a pendulum: simulation, the peer's friction levels, search, and
//! what disjoint halves of the logs agree on.

pub mod drive;
pub mod fit_quality;
mod goals;
pub mod half_samples;
pub mod lanes;
pub mod level;
pub mod log;
pub mod parameter;
pub mod physics;
pub mod search;
mod simulation;
pub mod space;
pub mod spread;
mod step;

pub use drive::{Control, Drive};
pub use fit_quality::{FitQuality, PoorFit};
pub use half_samples::half_samples;
pub use lanes::Lanes;
pub use level::FrictionLevel;
pub use log::{RawServoLog, ServoLog, TIME_STEP};
pub use parameter::ServoParameter;
pub use physics::Physics;
pub use search::{Effort, Found, search, search_from};
pub use space::Free;
pub use spread::estimates;
