//! The functions of the header, by what they are about.

// Pointers of C, and names that the linker sees. Each block says what it relies on.
#![allow(unsafe_code)]

mod catalogue;
mod model;
mod observer;
mod values;

pub use catalogue::*;
pub use model::*;
pub use observer::*;
pub use values::{FRICTION_SCHEME_HELD, FRICTION_SCHEME_MEAN, FrictionValue};
