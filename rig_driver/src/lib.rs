//! The rig behind one trait: [`Rig`] is measured and driven once a control cycle.
//!
//! The simulated test bed ([`SimulatedRig`]) is a geared DC servo
//! ([`Motor`](friction_model::Motor)) under any friction model, seen through sensors as real ones
//! are ([`Sensors`]): encoder counts, tachometer and torque noise, converters, a voltage limit. It
//! is lock-step and reproducible from a seed. Real back ends join behind the same trait
//! ([`serial::SerialRig`] on a serial line, [`quanser::QuanserRig`] on a card), and every one of
//! them stands under the safety layer ([`safety`]), which trusts neither the controller nor the
//! sensors. Which rigs there are, how they are named and opened, says [`registry`].

pub mod back_end;
mod calibration;
mod drift;
pub mod emulated;
mod error;
mod fault;
mod friction_coupling;
mod lifecycle;
mod measurement;
#[cfg(feature = "msgs")]
pub mod messages;
mod miswired;
#[cfg(feature = "ros")]
pub mod node;
pub mod parameters;
mod plant;
pub mod quanser;
pub mod registry;
mod rig;
pub mod safety;
mod sensors;
#[cfg(feature = "serial")]
pub mod serial;
mod simulated;
mod simulation_options;
#[cfg(any(test, feature = "ros"))]
mod station;

pub use back_end::{RigFactory, RigSetup};
pub use calibration::{Calibrated, Calibration, Sign, SignError};
pub use drift::FrictionDrift;
pub use error::RigError;
pub use friction_coupling::FrictionCoupling;
pub use measurement::Measurement;
pub use miswired::{Miswired, Miswiring, MiswiringError};
pub use plant::{Plant, Truth};
pub use registry::{RigAddress, RigRegistry};
pub use rig::{HIGHEST_VOLTAGE, Rig, VOLTAGE_RANGE};
pub use sensors::{Channel, SensorError, Sensors};
pub use simulated::{SimulatedFactory, SimulatedRig};
pub use simulation_options::SimulationOptions;

/// The example of the README runs.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
