//! The thesis's example of observer-based compensation (section 5.4): a velocity loop under an
//! output disturbance, and a step of position.
//!
//! * [`closed_loop`]: plant, controller and observer integrated together.
//! * [`models`]: the friction.
//! * [`velocity`] and [`position`]: the two tasks.
//! * [`cases`]: which runs Tables 5.1 and 5.2 and their explanation need.

pub mod cases;
mod closed_loop;
mod models;
mod position;
#[cfg(test)]
mod tests;
mod velocity;

pub use cases::{Example, ExampleOptions, PositionCase, VelocityCase};
pub use models::ExampleModel;
pub use position::PositionExample;
pub use velocity::{ExampleRun, VelocityExample};
