//! Which rigs there are, how they are named, listed and opened.
//!
//! A kind of rig is a [`RigFactory`]: its name, what may stand behind the colon of its address, what
//! of it is there at the moment, and how it is opened. All kinds stand in one list
//! ([`RigRegistry::standard`]), which addresses, help texts, parameter descriptions and the doctor
//! read: a back end joins by its folder and one line there. A program of somebody else adds its own
//! kind with [`RigRegistry::with`] and opens it like any other:
//!
//! ```
//! use rig_driver::registry::{RigRegistry, RigSetup};
//!
//! let rigs = RigRegistry::standard();
//! let address = rigs.address("simulated").unwrap();
//! let mut rig = address.open(&RigSetup::default()).unwrap().supervised().unwrap();
//! # use rig_driver::Rig;
//! assert_eq!(rig.measure().cycle, 0);
//! assert!(rigs.address("teapot").unwrap_err().to_string().contains("simulated"));
//! ```
//!
//! Whoever opens a rig by its address ([`RigAddress::open`]) gets it with the limits that belong to
//! it, put together in one place ([`RigLimits`](crate::safety::RigLimits)).

mod address;
mod list;
mod opened;

pub use address::{AddressError, RigAddress};
pub use list::{AlreadyInstalled, RigRegistry};
pub use opened::{Opened, Pace};

pub use crate::back_end::{
    BackEnd, Listed, Place, PlaceError, RigDescription, RigFactory, RigSetup, Scales,
    SensorsPresent, Standing,
};
