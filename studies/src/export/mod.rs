//! Identified friction written for simulators, robots and firmware, as it is asked for.
//!
//! [`simulator_export`] writes; here its options stand as the command and Python have them, and a
//! parameter file is read.

pub mod asked;
mod list;

pub use list::list;
