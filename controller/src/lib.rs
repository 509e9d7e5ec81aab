//! Velocity and position control of one axis, with friction compensation.
//!
//! [`design`] turns specifications into gains and says what they are worth. A velocity loop has a
//! [`VelocityLaw`], a position loop a [`Pid`]; [`Controller`] adds the plant inverse, the friction
//! compensation and what else is asked for ([`Dither`], [`Impulse`], [`AccelerationFeedback`]),
//! keeps the sum within the voltage limit, watches over the measurements ([`ControlFault`]) and
//! over the compensation ([`GuardOptions`]). The step path allocates nothing and cannot panic.

mod acceleration_feedback;
mod controller;
pub mod design;
mod dither;
mod error;
mod fault;
mod guard;
mod impulse;
mod inverse;
mod lag;
mod load;
#[cfg(feature = "msgs")]
pub mod messages;
#[cfg(feature = "ros")]
pub mod node;
mod options;
mod parameters;
mod pi;
mod pid;
mod ramp;
mod signals;
mod velocity_law;

pub use acceleration_feedback::{AccelerationEstimator, AccelerationFeedback};
pub use controller::Controller;
pub use dither::{Dither, DitherGenerator, DitherShape};
pub use error::ControllerError;
pub use fault::ControlFault;
pub use guard::{Diagnosis, GuardOptions};
pub use impulse::{Impulse, Knocker};
pub use inverse::{PlantInverse, PlantInverseName};
pub use lag::{LagCompensator, LagGains};
pub use load::Load;
pub use options::{Compensation, ControllerOptions};
pub use parameters::ControllerParameters;
pub use pi::{PiController, PiGains};
pub use pid::{DerivativeOn, Pid, PidGains};
pub use signals::{Command, ControlMode, Feedback, Reference};
pub use velocity_law::{VelocityLaw, VelocityLawName};
