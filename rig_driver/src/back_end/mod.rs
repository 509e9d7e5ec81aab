//! What every kind of rig has to say of itself to be one: how it is named, found and opened.
//!
//! The folders of the rigs implement [`RigFactory`] and know nothing of each other; the list of
//! all of them, and who opens a rig by its address, stand above ([`registry`](crate::registry)).

mod description;
mod factory;
mod setup;

pub use description::{RigDescription, Scales};
pub use factory::{BackEnd, Listed, Place, PlaceError, RigFactory, Standing};
pub use setup::{RigSetup, SensorsPresent};
