//! What is set for one rig, and the limits that follow: the one place where they are put together,
//! whoever opens the rig.

use serde::{Deserialize, Serialize};

use super::{SafetyLimits, Travel};
use crate::RigError;

/// Limits of one rig. What is left out is as usual for it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RigLimits {
    /// Largest magnitude of the motor voltage \[V\], at most the range that the rig tells of itself
    /// [usual: 6 V].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub voltage: Option<f64>,
    /// Fastest growth of its magnitude [V/s].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slew: Option<f64>,
    /// Largest speed of the shaft [rad/s].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub velocity: Option<f64>,
    /// Where the shaft may be.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub travel: Option<Travel>,
    /// Oldest command that still counts \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub command_age: Option<f64>,
    /// Time without a command that is a fault \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub command_lost: Option<f64>,
    /// Longest cycle after which the motor goes on at once \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cycle_late: Option<f64>,
    /// Longest cycle that is no fault \[s\]; a simulated rig does not mind.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cycle_lost: Option<f64>,
}

impl RigLimits {
    /// These limits on a rig whose `usual` limits are known and whose voltage range is `range`
    /// \[V\]. A simulated shaft stands still while its loop waits: there a late cycle never asks
    /// for a new activation.
    ///
    /// # Errors
    /// [`RigError`] names the voltage that cannot be.
    pub fn on(
        self,
        usual: SafetyLimits,
        range: f64,
        simulated: bool,
    ) -> Result<SafetyLimits, RigError> {
        Ok(SafetyLimits {
            voltage: SafetyLimits::voltage_within(self.voltage, range)?,
            slew: self.slew.unwrap_or(usual.slew),
            velocity: self.velocity.unwrap_or(usual.velocity),
            travel: self.travel.or(usual.travel),
            command_age: self.command_age.unwrap_or(usual.command_age),
            command_lost: self.command_lost.unwrap_or(usual.command_lost),
            cycle_late: self.cycle_late.unwrap_or(usual.cycle_late),
            cycle_lost: match self.cycle_lost {
                _ if simulated => f64::MAX,
                asked => asked.unwrap_or(usual.cycle_lost),
            },
            ..usual
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_set_counts_and_the_rest_is_as_usual() {
        let usual = SafetyLimits::default();
        assert_eq!(RigLimits::default().on(usual, 10.0, false).unwrap(), usual);
        let asked = RigLimits {
            voltage: Some(8.0),
            travel: Some(Travel { min: -1.0, max: 1.0, margin: 0.1 }),
            cycle_lost: Some(0.2),
            ..RigLimits::default()
        };
        let limits = asked.on(usual, 10.0, false).unwrap();
        let expected =
            SafetyLimits { voltage: 8.0, travel: asked.travel, cycle_lost: 0.2, ..usual };
        assert_eq!(limits, expected);
        let simulated = asked.on(usual, 10.0, true).unwrap();
        assert_eq!(simulated, SafetyLimits { cycle_lost: f64::MAX, ..expected });
        assert!(asked.on(usual, 7.0, false).unwrap_err().to_string().contains("at most 7 V"));
    }
}
