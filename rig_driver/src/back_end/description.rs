//! What a rig says of itself, number by number.

use serde::{Deserialize, Serialize};

/// A device's description of itself, as a rig profile keeps it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RigDescription {
    /// Its name, or the card's type.
    pub name: String,
    /// Version of its firmware.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub firmware: Option<String>,
    /// Period of its cycle \[s\].
    pub period: f64,
    /// Largest magnitude of the motor voltage \[V\].
    pub voltage_range: f64,
    /// Encoder counts a turn of the load.
    pub counts_per_turn: f64,
    /// What a count means, where the device tells it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scales: Option<Scales>,
}

/// What a count of each channel means; 0 for a sensor that is not there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scales {
    /// Voltage output \[V\].
    pub volts_per_count: f64,
    /// Tachometer [rad/s].
    pub tachometer_per_count: f64,
    /// Potentiometer \[rad\].
    pub potentiometer_per_count: f64,
    /// Torque sensor [N m].
    pub torque_per_count: f64,
    /// Motor current \[A\].
    pub current_per_count: f64,
}

impl RigDescription {
    /// In what `other` differs so that calibration and limits of this one do not fit it: everything
    /// but firmware and period.
    #[must_use]
    pub fn differs_from(&self, other: &Self) -> Option<String> {
        if self.name != other.name {
            return Some(format!("its name is `{}`, not `{}`", other.name, self.name));
        }
        for (what, here, there) in [
            ("voltage range [V]", self.voltage_range, other.voltage_range),
            ("counts per turn", self.counts_per_turn, other.counts_per_turn),
        ] {
            if here != there {
                return Some(format!("its {what} is {there}, not {here}"));
            }
        }
        (self.scales != other.scales).then(|| "its scales are others".to_owned())
    }
}
