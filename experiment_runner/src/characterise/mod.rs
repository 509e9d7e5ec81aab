//! What experiments 2 to 4 say about friction: from recorded channels to lag, breakaway and
//! hysteresis.
//!
//! Every figure is found for each repetition and comes with its quartiles over the repetitions, the
//! standard error that they show, and what the drive's constants add where there is no torque
//! sensor ([`Measured`]).

pub mod breakaway;
pub mod channels;
pub mod lag;
pub mod measured;
pub mod nested;

pub use breakaway::{Breakaway, NoBreakaway, find_breakaway};
pub use channels::{Channels, TorqueReading};
pub use lag::{LagLoop, lag_loop};
pub use measured::Measured;
pub use nested::{Closure, NestedPath, nested_path};
