//! What a rig says of itself, number by number.

use rig_driver::serial::Hello;
use serde::{Deserialize, Serialize};

use super::{RigChoice, RigSetupError};

/// A device's description of itself, as a rig profile keeps it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RigDescription {
    /// Its name, or the card's type.
    pub name: String,
    /// Version of its firmware.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub firmware: Option<String>,
    /// Period of its cycle [s].
    pub period: f64,
    /// Largest magnitude of the motor voltage [V].
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
    /// Voltage output [V].
    pub volts_per_count: f64,
    /// Tachometer [rad/s].
    pub tachometer_per_count: f64,
    /// Potentiometer [rad].
    pub potentiometer_per_count: f64,
    /// Torque sensor [N m].
    pub torque_per_count: f64,
    /// Motor current [A].
    pub current_per_count: f64,
}

impl RigDescription {
    /// What a device on a serial line said.
    pub(super) fn of(hello: &Hello, period: f64, voltage_range: f64) -> Self {
        let [major, minor, patch] = hello.firmware;
        Self {
            name: hello.name.as_str().to_owned(),
            firmware: Some(format!("{major}.{minor}.{patch}")),
            period,
            voltage_range,
            counts_per_turn: hello.counts_per_turn.into(),
            scales: Some(Scales {
                volts_per_count: hello.volts_per_count.into(),
                tachometer_per_count: hello.tachometer_per_count.into(),
                potentiometer_per_count: hello.potentiometer_per_count.into(),
                torque_per_count: hello.torque_per_count.into(),
                current_per_count: hello.current_per_count.into(),
            }),
        }
    }

    /// Refuses a device that is not the described one: calibration and limits would be those of
    /// another.
    ///
    /// # Errors
    /// [`RigSetupError::OtherDevice`] says in what it differs.
    pub fn require(&self, rig: &RigChoice, device: Option<&Self>) -> Result<(), RigSetupError> {
        match device.and_then(|device| self.differs_from(device)) {
            None => Ok(()),
            Some(what) => Err(RigSetupError::OtherDevice { rig: rig.to_string(), what }),
        }
    }

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
