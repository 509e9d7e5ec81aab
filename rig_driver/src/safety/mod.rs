//! The safety layer: what stands between any controller and any motor.
//!
//! [`SafetySupervisor`] is the whole of it and pure: readings, commands and times come in as
//! numbers, a voltage comes out. [`Supervised`] puts it around a back end. It trusts neither side:
//! a command may be late, too large, too steep or no number; readings may be frozen, saturated or
//! in contradiction.
//!
//! States and transitions are one table ([`TRANSITIONS`]), and so is what each fault does
//! ([`FAULTS`]). The book shows both; a test holds its pages to the tables.

mod limits;
mod pages;
mod rig_limits;
mod sensors;
mod standstill;
mod stop_latch;
mod supervised;
mod supervisor;
mod temperature;

pub use crate::fault::{FAULTS, Fault, FaultReport, FaultRule, Reaction};
pub use crate::lifecycle::{Event, Refused, Request, State, TRANSITIONS, Transition, next};
pub use limits::{Agreement, MotorThermal, SafetyLimits, SensorChecks, Standstill, Travel};
pub use pages::{fault_table, transition_list, transition_table};
pub use rig_limits::RigLimits;
pub use stop_latch::StopLatch;
pub use supervised::Supervised;
pub use supervisor::SafetySupervisor;
