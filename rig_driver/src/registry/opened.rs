//! What a rig is opened with, and what comes of it.

use friction_model::{AnyModel, ModelName};
use serde::{Deserialize, Serialize};

use super::RigDescription;
use crate::safety::{RigLimits, SafetyLimits, Supervised};
use crate::{Calibration, Miswiring, Rig, RigError, SimulationOptions};

/// What a rig is opened with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigSetup {
    /// What corrects its readings; none for readings as they come.
    pub calibration: Option<Calibration>,
    /// What was set for it.
    pub limits: RigLimits,
    /// What a simulated rig is made of; its voltage limit is that of `limits`.
    pub simulation: SimulationOptions,
    /// Friction of a simulated rig.
    pub friction: AnyModel,
    /// Mistakes in the wiring of a simulated rig.
    pub wiring: Option<Miswiring>,
}

impl Default for RigSetup {
    /// The usual limits, readings as they come; a simulated rig is the thesis's test bed under its
    /// proposed model.
    fn default() -> Self {
        Self {
            calibration: None,
            limits: RigLimits::default(),
            simulation: SimulationOptions::default(),
            friction: AnyModel::test_bed(ModelName::Proposed),
            wiring: None,
        }
    }
}

/// Sensors that a rig may lack.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorsPresent {
    /// Friction torque.
    pub torque: bool,
    /// Motor current.
    pub current: bool,
}

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
