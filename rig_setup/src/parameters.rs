//! `calibration.yaml`: the calibration as a ROS 2 parameter file for `/rig_driver`.

use std::fmt::Write;

use rig_driver::Calibration;

use super::{Findings, RigChoice, RigFileError};
use files::commented_yaml::number;
use files::ros_parameters::of_rig_driver;

/// The file as text; standard errors stand in comments.
#[must_use]
pub fn render(found: &Findings, rig: &RigChoice) -> String {
    let mut text =
        format!("# Calibration of the rig {rig} by frictionlab {}.\n", env!("CARGO_PKG_VERSION"));
    let Calibration {
        encoder_sign,
        tachometer_gain,
        tachometer_zero,
        torque_sign,
        torque_zero,
        deadband_forward,
        deadband_backward,
    } = found.calibration();
    // Two digits: an error is not known better.
    let error =
        |value: f64, unit: &str| format!("standard error {value:.1e} {unit}").trim_end().to_owned();
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
/// [`RigFileError`] says what is wrong in the text.
pub fn read(text: &str) -> Result<Calibration, RigFileError> {
    let calibration: Calibration =
        of_rig_driver(text, "calibration", "`frictionlab rig calibrate` writes one")
            .map_err(RigFileError::Unreadable)?;
    calibration.check().map_err(|error| RigFileError::section("calibration", error))?;
    Ok(calibration)
}
