//! A rig that is open.

use crate::back_end::{RigDescription, SensorsPresent};
use crate::safety::{SafetyLimits, Supervised};
use crate::{Rig, RigError};

/// Who sets the pace of a rig.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pace {
    /// Nobody: the rig is simulated and goes as fast as the processor.
    LockStep,
    /// The clock of this machine, one cycle a period.
    Clock,
    /// The device itself.
    Device,
}

/// A rig that is open, with the limits that belong to it.
pub struct Opened {
    /// The rig, with its calibration.
    pub rig: Box<dyn Rig + Send>,
    /// What the safety layer allows on it.
    pub limits: SafetyLimits,
    /// Who sets the pace.
    pub pace: Pace,
    /// Which sensors there are.
    pub sensors: SensorsPresent,
    /// What a real rig says of itself, in a line.
    pub about: Option<String>,
    /// What a device says of itself, number by number.
    pub description: Option<RigDescription>,
}

impl Opened {
    /// The rig under the safety layer, unconfigured: its motor does not move before it is configured
    /// and activated.
    ///
    /// # Errors
    /// [`RigError`] names the limit that cannot be.
    pub fn supervised(self) -> Result<Supervised<Box<dyn Rig + Send>>, RigError> {
        Supervised::new(self.rig, self.limits)
    }
}
