//! What the safety layer can hold a device on a serial line to.

use rig_protocol::Hello;

use crate::HIGHEST_VOLTAGE;
use crate::safety::{SafetyLimits, SensorChecks};

/// Largest magnitude of the motor voltage by the device's description \[V\], and never above
/// [`HIGHEST_VOLTAGE`].
pub(super) fn voltage_range(hello: &Hello) -> f64 {
    let volts = f64::from(hello.voltage_limit) * f64::from(hello.volts_per_count).abs();
    volts.min(HIGHEST_VOLTAGE)
}

/// The default limits, within the device's own voltage limit, with checks of only those sensors
/// that it has.
///
/// A real channel may be so quiet that its converter shows the same count for long: frozen values
/// are not looked for.
#[must_use]
pub fn limits(hello: &Hello) -> SafetyLimits {
    let default = SafetyLimits::default();
    let channels = hello.channels;
    let SensorChecks { agreement, torque_range, .. } = default.sensors;
    SafetyLimits {
        voltage: default.voltage.min(voltage_range(hello)),
        sensors: SensorChecks {
            agreement: agreement.filter(|_| channels.tachometer),
            torque_range: torque_range.filter(|_| channels.torque),
            frozen_cycles: None,
        },
        ..default
    }
}
