//! What tells friction models apart, computed.

mod contact;
mod settle;
mod stick_slip;
mod thinned;
mod time_scales;

pub use contact::{Contact, FreeBody, Prescribed};
pub use settle::{Evidence, Figure, Settling, settle};
pub use stick_slip::{Motion, StickSlip, StickSlipCourse, StickSlipSettings, stick_slip};
pub use time_scales::TimeScales;
