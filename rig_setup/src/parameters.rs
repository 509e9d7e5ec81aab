//! `calibration.yaml`: the calibration as a ROS 2 parameter file for `/rig_driver`.

use files::ros_parameters::of_rig_driver;
use parameters::ParameterValue;
use parameters::file::Writer;
use rig_driver::{Calibration, Sign};

use super::{Findings, RigChoice, RigFileError};

/// The file as text; standard errors stand in comments.
#[must_use]
pub fn render(found: &Findings, rig: &RigChoice) -> String {
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
    let mut file = Writer::default();
    let version = env!("CARGO_PKG_VERSION");
    file.comment(&format!("Calibration of the rig {rig} by frictionlab {version}."));
    file.node("/rig_driver");
    let mut say = |name: &str, value, said: &str| {
        file.value(&format!("calibration.{name}"), value, said);
    };
    let sign = |sign: Sign| ParameterValue::Integer(i64::from(i8::from(sign)));
    say("encoder_sign", sign(encoder_sign), "1 if it counts up at a positive voltage");
    let gain = found.tachometer_gain.map_or_else(
        || "not found: the tachometer does not show the motion".to_owned(),
        |gain| format!("true over shown, {}", error(gain.standard_error, "")),
    );
    say("tachometer_gain", ParameterValue::Double(tachometer_gain), &gain);
    let zero = error(found.tachometer_zero.standard_error, "rad/s");
    say("tachometer_zero", ParameterValue::Double(tachometer_zero), &format!("[rad/s], {zero}"));
    let shows = if found.torque_sign.is_some() {
        "1 if friction opposes the motion"
    } else {
        "not found: the sensor does not show the motion"
    };
    say("torque_sign", sign(torque_sign), shows);
    for (name, value, unit, spread) in [
        ("torque_zero", torque_zero, "N m", found.torque_zero.standard_error),
        ("deadband_forward", deadband_forward, "V", found.deadband_forward.standard_error),
        ("deadband_backward", deadband_backward, "V", found.deadband_backward.standard_error),
    ] {
        let said = format!("[{unit}], {}", error(spread, unit));
        say(name, ParameterValue::Double(value), &said);
    }
    file.text()
}

/// Reads a parameter file with `/rig_driver: ros__parameters: calibration:`.
///
/// # Errors
/// [`RigFileError`] says what is wrong in the text.
pub fn read(text: &str) -> Result<Calibration, RigFileError> {
    let calibration: Calibration = of_rig_driver(text, "calibration")?;
    calibration.check().map_err(|error| RigFileError::section("calibration", error))?;
    Ok(calibration)
}
