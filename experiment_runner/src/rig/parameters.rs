//! `calibration.yaml`: the calibration as a ROS 2 parameter file for `/rig_driver`.

use std::collections::BTreeMap;
use std::fmt::Write;

use rig_driver::Calibration;
use serde::Deserialize;

use super::{Findings, RigChoice};
use crate::identify::parameters::number;

/// The file as text; standard errors stand in comments.
#[must_use]
pub fn render(found: &Findings, rig: &RigChoice) -> String {
    let mut text = format!("# Calibration of the rig {rig} by frictionlab {}.\n", env!("CARGO_PKG_VERSION"));
    let Calibration {
        encoder_sign,
        tachometer_gain,
        tachometer_zero,
        torque_sign,
        torque_zero,
        deadband_forward,
        deadband_backward,
    } = found.calibration();
    let error =
        |value: f64, unit: &str| format!("standard error {} {unit}", number(value)).trim_end().to_owned();
    let lines: [(&str, String, String); 7] = [
        (
            "encoder_sign",
            i8::from(encoder_sign).to_string(),
            "1 if it counts up at a positive voltage".to_owned(),
        ),
        (
            "tachometer_gain",
            number(tachometer_gain),
            found.tachometer_gain.map_or_else(
                || "not found: the tachometer does not show the motion".to_owned(),
                |gain| format!("true over shown, {}", error(gain.standard_error, "")),
            ),
        ),
        (
            "tachometer_zero",
            number(tachometer_zero),
            format!("[rad/s], {}", error(found.tachometer_zero.standard_error, "rad/s")),
        ),
        (
            "torque_sign",
            i8::from(torque_sign).to_string(),
            if found.torque_sign.is_some() {
                "1 if friction opposes the motion"
            } else {
                "not found: the sensor does not show the motion"
            }
            .to_owned(),
        ),
        (
            "torque_zero",
            number(torque_zero),
            format!("[N m], {}", error(found.torque_zero.standard_error, "N m")),
        ),
        (
            "deadband_forward",
            number(deadband_forward),
            format!("[V], {}", error(found.deadband_forward.standard_error, "V")),
        ),
        (
            "deadband_backward",
            number(deadband_backward),
            format!("[V], {}", error(found.deadband_backward.standard_error, "V")),
        ),
    ];
    text.push_str("/rig_driver:\n  ros__parameters:\n    calibration:\n");
    for (name, value, comment) in lines {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "      {name}: {value}  # {comment}");
    }
    text
}

/// Reads a parameter file with `/rig_driver: ros__parameters: calibration:`.
///
/// # Errors
/// A sentence about what is wrong in the text.
pub fn read(text: &str) -> Result<Calibration, String> {
    #[derive(Deserialize)]
    struct Node {
        #[serde(rename = "ros__parameters")]
        parameters: serde_json::Value,
    }
    let tree: BTreeMap<String, Node> = serde_saphyr::from_str(text)
        .map_err(|e| format!("{e}\n(expected `/NODE:` and under it `ros__parameters:`)"))?;
    let node = tree
        .iter()
        .find(|(name, _)| name.trim_start_matches('/') == "rig_driver")
        .map(|(_, node)| &node.parameters)
        .ok_or("there is no node `rig_driver` in it; `frictionlab rig calibrate` writes one")?;
    let found = node.get("calibration").ok_or("`rig_driver` has no `calibration` in it")?;
    let calibration: Calibration =
        serde_json::from_value(found.clone()).map_err(|e| format!("in `calibration`: {e}"))?;
    calibration.check().map_err(|e| format!("in `calibration`: {e}"))?;
    Ok(calibration)
}
