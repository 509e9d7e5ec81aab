//! Gains from specifications, and what a linear loop is worth: its step response, its margins, and
//! what theory says of it under friction.
//!
//! * [`velocity`]: lag and PI of the velocity loop; [`position`]: PID of the position loop.
//! * [`response`]: step response with the controller as it runs, discrete; overshoot, rise,
//!   settling.
//! * [`frequency`]: open loop, continuous or sampled; crossover, margins, sensitivity peak.
//! * [`theory`]: strictly positive real and positive real transfer functions, the hypotheses of the
//!   thesis's theorems 5.1 and 5.2.
//! * [`sector`]: how much friction, or error of its compensation, the loop is proven to stand
//!   (circle criterion).
//!
//! Nothing here belongs into the control cycle: these functions allocate.

mod drive;
pub mod frequency;
mod linear_loop;
mod polynomial;
pub mod position;
pub mod response;
pub mod sector;
pub mod theory;
pub mod velocity;

pub use drive::LinearDrive;
pub use linear_loop::{LinearLoop, LoopLaw};
pub use polynomial::{Polynomial, TransferFunction};
pub use position::{
    PidRealisation, PositionPoles, PositionSpecification, pid_from_poles, pid_from_specification,
};
pub use velocity::{
    PiSpecification, VelocitySpecification, lag_from_specification, pi_from_specification,
};
