//! `rig.yaml`: everything that is known of one rig, in one file, so that it need not be passed by
//! hand.

use std::collections::BTreeMap;

use friction_model::Motor;
use rig_driver::Calibration;
use serde::{Deserialize, Deserializer, Serialize};

use super::{RigChoice, RigDescription, RigFileError, RigLimits, SensorsPresent};
use parameters::with_nearest;

/// Name of the profile that is found by default, in the current folder.
pub const PROFILE: &str = "rig.yaml";

/// Everything that is known of one rig. What was not found out yet is left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RigProfile {
    /// Where it is.
    #[serde(deserialize_with = "read_address")]
    pub rig: RigChoice,
    /// What it says of itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<RigDescription>,
    /// Sensors that a rig may lack.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensors: Option<SensorsPresent>,
    /// What the engineer allows on it.
    #[serde(default)]
    pub limits: RigLimits,
    /// What corrects its readings.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub calibration: Option<Calibration>,
    /// Its drive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drive: Option<DriveSheet>,
}

/// The drive of a rig: gain and time constant, and where they are known the constants of the motor.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveSheet {
    /// Gain K [rad/(V s)].
    pub gain: f64,
    /// Time constant T \[s\].
    pub time_constant: f64,
    /// Torque constant K_m [N m/A]; that of the load, A K_m, where the gear ratio is 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motor_constant: Option<f64>,
    /// Gear ratio A.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gear_ratio: Option<f64>,
    /// Armature resistance R_a \[ohm\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub armature_resistance: Option<f64>,
    /// Inertia at the load [kg m^2].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inertia: Option<f64>,
}

impl DriveSheet {
    /// The motor's constants, where all are known.
    #[must_use]
    pub fn motor(&self) -> Option<Motor> {
        Some(Motor {
            motor_constant: self.motor_constant?,
            gear_ratio: self.gear_ratio?,
            armature_resistance: self.armature_resistance?,
            inertia: self.inertia?,
        })
    }

    fn check(&self) -> Result<(), RigFileError> {
        let wrong = |why: String| Err(RigFileError::section("drive", why));
        for (name, value) in [("gain", self.gain), ("time_constant", self.time_constant)] {
            if !(value > 0.0 && value.is_finite()) {
                return wrong(format!("{name} must be a finite number above 0, but is {value}"));
            }
        }
        let given = [self.motor_constant, self.gear_ratio, self.armature_resistance, self.inertia];
        match self.motor() {
            Some(motor) => {
                motor.check().or_else(|error| wrong(error.to_string()))
            }
            None if given.iter().any(Option::is_some) => wrong(
                "expected all of motor_constant, gear_ratio, armature_resistance and inertia, or none of them"
                    .to_owned(),
            ),
            None => Ok(()),
        }
    }
}

impl RigProfile {
    /// The profile of a rig of which nothing else is known.
    #[must_use]
    pub fn new(rig: RigChoice) -> Self {
        Self {
            rig,
            description: None,
            sensors: None,
            limits: RigLimits::default(),
            calibration: None,
            drive: None,
        }
    }

    /// Reads a profile. It is taken whole or not at all.
    ///
    /// # Errors
    /// [`RigFileError`] says what is wrong in the text; a key that there is not is named.
    pub fn read(text: &str) -> Result<Self, RigFileError> {
        let profile: Self = serde_saphyr::from_str(text)
            .map_err(|error| RigFileError::Unreadable(with_nearest(&error.to_string())))?;
        let wrong = |why: String| Err(RigFileError::section("limits", why));
        profile.calibration.map_or(Ok(()), |calibration| {
            calibration.check().map_err(|error| RigFileError::section("calibration", error))
        })?;
        profile.drive.map_or(Ok(()), |drive| drive.check())?;
        let above_zero = |value: f64| value > 0.0 && value.is_finite();
        let RigLimits { voltage, travel, .. } = profile.limits;
        for (name, value) in numbers(&profile.limits) {
            if let Some(value) = value.filter(|value| !above_zero(*value)) {
                return wrong(format!("{name} must be a finite number above 0, but is {value}"));
            }
        }
        if let Some(travel) = travel
            && !(travel.min.is_finite()
                && travel.max.is_finite()
                && travel.min < travel.max
                && travel.margin >= 0.0)
        {
            return wrong("travel needs a min below its max and a margin of 0 or more".to_owned());
        }
        if let Some((voltage, range)) =
            voltage.zip(profile.description.as_ref().map(|said| said.voltage_range))
            && voltage > range
        {
            return wrong(format!(
                "voltage is {voltage} V, but this rig's own voltage range is {range} V (`description`)"
            ));
        }
        Ok(profile)
    }

    /// Whether the text is a rig profile, and not a parameter file: it has an address.
    #[must_use]
    pub fn is_one(text: &str) -> bool {
        serde_saphyr::from_str::<BTreeMap<String, serde_json::Value>>(text)
            .is_ok_and(|keys| keys.contains_key("rig"))
    }

    /// What of it counts, in a few words: `calibration, drive, at most 8 V`.
    #[must_use]
    pub fn parts(&self) -> String {
        let mut parts = Vec::new();
        if self.calibration.is_some() {
            parts.push("calibration".to_owned());
        }
        if self.drive.is_some() {
            parts.push("drive".to_owned());
        }
        let RigLimits { voltage, velocity, travel, .. } = self.limits;
        parts.extend(voltage.map(|volts| format!("at most {volts} V")));
        parts.extend(velocity.map(|velocity| format!("at most {velocity} rad/s")));
        parts.extend(
            travel.map(|travel| format!("travel from {} to {} rad", travel.min, travel.max)),
        );
        if parts.is_empty() { "its address".to_owned() } else { parts.join(", ") }
    }

    /// The file as text.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!(
            "# Rig profile by frictionlab {}: docs/reference/rig-profile.md says what uses it. \
             `rig check`, `rig calibrate` and `identify-drive` write their\n\
             # parts anew; comments of your own are lost then.\n\
             # [V], [s], [rad], [N m], [A], [ohm], [kg m^2], at the load side of the gear.\n",
            env!("CARGO_PKG_VERSION"),
        );
        part(&mut text, "rig", &self.rig);
        if let Some(description) = &self.description {
            text += "\n# What the device says of itself.\n";
            part(&mut text, "description", description);
        }
        if let Some(sensors) = &self.sensors {
            text += "\n# Sensors that a rig may lack.\n";
            part(&mut text, "sensors", sensors);
        }
        text += "\n# What is allowed, within the device's own range: voltage [usual: 6 V], \
                 velocity [usual: 9.5 rad/s], travel {min, max, margin}.\n";
        part(&mut text, "limits", &self.limits);
        if let Some(calibration) = &self.calibration {
            text += "\n# By `frictionlab rig calibrate`.\n";
            part(&mut text, "calibration", calibration);
        }
        if let Some(drive) = &self.drive {
            text += "\n# By `frictionlab identify-drive`.\n";
            part(&mut text, "drive", drive);
        }
        text
    }
}

/// Adds one key of the profile and what it holds.
fn part(text: &mut String, key: &str, value: &impl Serialize) {
    // Plain data, written to a string: neither can fail.
    let _ = serde_saphyr::to_fmt_writer(text, &BTreeMap::from([(key, value)]));
}

/// The limits that are numbers, by name.
const fn numbers(limits: &RigLimits) -> [(&'static str, Option<f64>); 7] {
    [
        ("voltage", limits.voltage),
        ("slew", limits.slew),
        ("velocity", limits.velocity),
        ("command_age", limits.command_age),
        ("command_lost", limits.command_lost),
        ("cycle_late", limits.cycle_late),
        ("cycle_lost", limits.cycle_lost),
    ]
}

fn read_address<'de, D: Deserializer<'de>>(from: D) -> Result<RigChoice, D::Error> {
    let text = String::deserialize(from)?;
    let rig: RigChoice = text.parse().map_err(serde::de::Error::custom)?;
    match rig {
        RigChoice::Nodes { .. } => Err(serde::de::Error::custom(
            "a profile is of a rig that is opened here: simulated, serial:PORT or quanser[:CARD], not of running nodes",
        )),
        rig => Ok(rig),
    }
}

#[cfg(test)]
mod tests {
    use rig_driver::Sign;
    use rig_driver::safety::Travel;

    use super::*;
    use crate::Scales;

    fn full() -> RigProfile {
        RigProfile {
            rig: "serial:/dev/ttyACM0@115200".parse().unwrap(),
            description: Some(RigDescription {
                name: "it's: a #board".to_owned(),
                firmware: Some("1.20.0".to_owned()),
                period: 1e-3,
                voltage_range: 24.0,
                counts_per_turn: 4096.0,
                scales: Some(Scales {
                    volts_per_count: 0.0048828125,
                    tachometer_per_count: 1e-5,
                    potentiometer_per_count: 0.0,
                    torque_per_count: 0.011230469,
                    current_per_count: 0.0,
                }),
            }),
            sensors: Some(SensorsPresent { torque: true, current: false }),
            limits: RigLimits {
                voltage: Some(12.0),
                cycle_lost: Some(0.25),
                travel: Some(Travel { min: -20.0, max: 20.0, margin: 0.5 }),
                ..RigLimits::default()
            },
            calibration: Some(Calibration {
                encoder_sign: Sign::Reversed,
                tachometer_gain: 1.1,
                ..Default::default()
            }),
            drive: Some(DriveSheet {
                gain: 1.86,
                time_constant: 0.0239,
                motor_constant: Some(0.5369),
                gear_ratio: Some(1.0),
                armature_resistance: Some(2.6),
                inertia: Some(2.65e-3),
            }),
        }
    }

    #[test]
    fn a_profile_reads_back_as_it_was_written() {
        for profile in [full(), RigProfile::new(RigChoice::Simulated)] {
            let text = profile.text();
            assert_eq!(RigProfile::read(&text).unwrap(), profile, "{text}");
        }
    }

    #[test]
    fn what_a_device_says_stays_text() {
        for said in ["1.20", "no", "~", "0x10", "a: {b}", "# c", "'", "\"", "two\nlines", "", " x "]
        {
            let mut profile = full();
            let description = profile.description.as_mut().unwrap();
            description.name = said.to_owned();
            description.firmware = Some(said.to_owned());
            let text = profile.text();
            assert_eq!(RigProfile::read(&text).unwrap(), profile, "{text}");
        }
    }

    #[test]
    fn what_is_wrong_is_named_and_nothing_of_the_file_is_taken() {
        let good = full().text();
        for (from, to, said) in [
            ("limits:", "limit:", "is `limits` meant?"),
            ("  voltage: 12.0", "  volts: 12.0", "volts"),
            ("  voltage: 12.0", "  voltage: 36.0", "voltage range is 24"),
            ("  voltage: 12.0", "  voltage: -1.0", "voltage"),
            ("encoder_sign: -1", "encoder_sign: 3", "1 or -1"),
            ("tachometer_gain: 1.1", "tachometer_gain: 0.0", "tachometer_gain"),
            ("  inertia: 0.00265\n", "", "inertia"),
            ("  gain: 1.86", "  gain: .nan", "gain"),
            ("serial:/dev/ttyACM0@115200", "nodes", "running nodes"),
            ("serial:/dev/ttyACM0@115200", "serial", "serial:/dev/ttyACM0"),
            ("min: -20.0", "min: 30.0", "travel"),
        ] {
            assert!(good.contains(from), "{from}: {good}");
            let message = RigProfile::read(&good.replace(from, to)).unwrap_err().to_string();
            assert!(message.contains(said), "{to}: {message}");
        }
    }
}
