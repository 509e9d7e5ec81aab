//! One control cycle, whole: what the recorder, the publishers and the report are fed with.

use controller::{Command, Reference};
use friction_observer::Estimate;
use rig_driver::Measurement;

/// Everything one pass of the loop saw and decided.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CycleSample {
    /// Time of the measurement: nanoseconds since the Unix epoch.
    pub stamp_ns: u64,
    /// What the rig measured.
    pub measurement: Measurement,
    /// Where the axis should be.
    pub reference: Reference,
    /// What the observer thought of it.
    pub estimate: Estimate,
    /// What the controller decided.
    pub command: Command,
}
