//! Quanser's data acquisition cards through the vendor's HIL library, which is loaded while the
//! program runs.
//!
//! Nothing of the vendor is needed to build. Without the library [`QuanserRig::open`] says what to
//! install.
//!
//! It was tested against a stand-in library that records calls, fails at any of them and keeps a
//! card with its own watchdog in a process of its own. **It has not been run on a real card.**

mod counter;
mod factory;
mod hil;
mod library;
mod options;
mod rig;

pub use crate::error::QuanserError;
pub use counter::UnwrappedCounter;
pub use factory::QuanserFactory;
pub use library::find_library;
pub use options::{AnalogInput, QuanserOptions};
pub use rig::QuanserRig;
