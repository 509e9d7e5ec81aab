//! What a rig is opened with, and what it may lack.

use friction_model::{AnyModel, ModelName};
use serde::{Deserialize, Serialize};

use crate::safety::RigLimits;
use crate::{Calibration, Miswiring, SimulationOptions};

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
