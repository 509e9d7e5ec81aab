//! Faults: what can be wrong, what the driver does about it, and what it says.

mod kinds;
mod report;

pub use kinds::{FAULTS, Fault, FaultRule, Reaction};
pub use report::FaultReport;
