//! What an engineer sets for one rig.

use rig_driver::RigError;
use rig_driver::safety::{SafetyLimits, Travel};
use serde::{Deserialize, Serialize};

/// Limits of one rig. What is left out is as usual.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RigLimits {
    /// Largest magnitude of the motor voltage [V], at most the range that the rig tells of itself
    /// [usual: 6 V].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub voltage: Option<f64>,
    /// Largest speed of the shaft [rad/s].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity: Option<f64>,
    /// Where the shaft may be.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub travel: Option<Travel>,
}

impl RigLimits {
    /// These limits on a rig whose `usual` limits are known and whose voltage range is `range` [V].
    ///
    /// # Errors
    /// [`RigError`] names the limit that cannot be.
    pub fn on(self, usual: SafetyLimits, range: f64) -> Result<SafetyLimits, RigError> {
        Ok(SafetyLimits {
            voltage: SafetyLimits::voltage_within(self.voltage, range)?,
            velocity: self.velocity.unwrap_or(usual.velocity),
            travel: self.travel.or(usual.travel),
            ..usual
        })
    }
}
