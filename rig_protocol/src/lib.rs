#![doc = include_str!("../README.md")]
//!
//! # Why whole numbers
//!
//! What goes over the line each cycle is in whole numbers of the device's own converters; their
//! scales come once, in [`Hello`]. A microcontroller then needs no floating point, a recording can
//! be scaled anew after a calibration, and a voltage that is not a number cannot be said.

#![no_std]
#![deny(rustdoc::broken_intra_doc_links)]
#![forbid(unsafe_code)]

mod decoder;
mod device;
mod device_message;
mod frame;
mod hello;
mod host_message;
mod measurement;
mod states;
mod wire;

pub use decoder::{Decoder, Message, Rejection, Rejections};
pub use device::{Device, Inputs, Output, Refusal};
pub use device_message::{DeviceMessage, FaultReport};
pub use frame::{Frame, MAX_FRAME};
pub use hello::{Channels, Hello, HelloError, Name};
pub use host_message::{HostMessage, Origin, VoltageCommand};
pub use measurement::{Measurement, Readings};
pub use states::{Cause, Event, State, TRANSITIONS};

/// The protocol's version, the first byte of every frame. Frames of another version are refused.
pub const VERSION: u8 = 2;

/// How far a message's number may be ahead of the last one's: so many frames may be lost in a row.
/// Further ahead it is refused.
pub const WINDOW: u32 = 1 << 16;

/// Number of a session. A host draws one at random for its hello, which tells the answer to it from
/// answers to an earlier one; the device draws the session's own, which tells the host that may
/// drive from everybody else. It is no secret: who reads the line knows it. Zero is no session.
pub type Session = core::num::NonZeroU32;
