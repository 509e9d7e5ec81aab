//! A rig on a serial line: the host's side of `PROTOCOL.md`.
//!
//! [`SerialRig`] is paced by the device: [`Rig::wait`](crate::Rig::wait) returns when the next
//! cycle's measurement has come, and the voltage that answers it is on the motor from the device's
//! next cycle on: one cycle after the measurement, always. The device itself ends the validity of a
//! command; nothing here has to work for that.
//!
//! A thread of its own ([`reader`]) reads the line into a bounded queue and brings the line back
//! after it was gone. The motor moves only after [`Rig::activate`](crate::Rig::activate), and again
//! only after another one when the line was lost or the device restarted.
//!
//! Nothing that the device says is taken on trust ([`monitor`], [`clock`]): an echo of a command
//! that was not sent, a voltage that was not asked for, frames of somebody else, a clock that jumps
//! are faults with reasons, and the device is told to rest. What stops is said again until a
//! measurement shows it ([`stopping`]).

mod clock;
mod factory;
mod handshake;
mod latency;
mod monitor;
mod options;
mod port;
mod ports;
mod reader;
mod rig;
mod scaling;
mod scheduling;
mod statistics;
mod stopping;
mod supervision;
#[cfg(test)]
mod test_messages;

pub use crate::error::SerialError;
pub use factory::SerialFactory;
pub use latency::Latency;
pub use options::SerialOptions;
pub use rig::SerialRig;
/// What a device says it is.
pub use rig_protocol::{Cause, FaultReport, Hello, State};
pub use statistics::LinkStatistics;
pub use supervision::limits;
