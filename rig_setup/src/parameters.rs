//! `calibration.yaml`: the calibration as a ROS 2 parameter file for `/rig_driver`.

use parameters::file::{Parameters, Writer};
use parameters::{Declaration, Declared, Values};
use rig_driver::Calibration;
use rig_driver::parameters::RigParameters;

use super::{Findings, RigChoice, RigFileError, RigProfile, SectionError};

/// The file as text; standard errors stand in comments.
#[must_use]
pub fn render(found: &Findings, rig: &RigChoice) -> String {
    let calibration = found.calibration();
    // Two digits: an error is not known better.
    let error =
        |value: f64, unit: &str| format!("standard error {value:.1e} {unit}").trim_end().to_owned();
    let mut file = Writer::default();
    let version = env!("CARGO_PKG_VERSION");
    file.comment(&format!("Calibration of the rig {rig} by frictionlab {version}."));
    let not_found = |what: &str| format!("not found: the {what} does not show the motion");
    let said = |name: &str| match name {
        "encoder_sign" => "1 if it counts up at a positive voltage".to_owned(),
        "tachometer_gain" => found.tachometer_gain.map_or_else(
            || not_found("tachometer"),
            |gain| format!("true over shown, {}", error(gain.standard_error, "")),
        ),
        "tachometer_zero" => {
            format!("[rad/s], {}", error(found.tachometer_zero.standard_error, "rad/s"))
        }
        "torque_sign" if found.torque_sign.is_none() => not_found("sensor"),
        "torque_sign" => "1 if friction opposes the motion".to_owned(),
        "torque_zero" => format!("[N m], {}", error(found.torque_zero.standard_error, "N m")),
        "deadband_forward" => {
            format!("[V], {}", error(found.deadband_forward.standard_error, "V"))
        }
        "deadband_backward" => {
            format!("[V], {}", error(found.deadband_backward.standard_error, "V"))
        }
        _ => String::new(),
    };
    file.node("/rig_driver");
    // Declared with its present values, in the order of the fields.
    for one in calibration.declarations() {
        let name = format!("calibration.{}", one.name());
        file.value(&name, one.default_value().clone(), &said(one.name()));
    }
    file.text()
}

/// The parameters of `/rig_driver` in a file that says everything of `section`, as `calibration`.
/// What a rig has is not guessed: a value that is left out is missed.
///
/// # Errors
/// [`SectionError`] says what is wrong in the text.
pub fn of_rig_driver(text: &str, section: &'static str) -> Result<RigParameters, SectionError> {
    let file = Parameters::parse(text)?;
    if file.of_node("/rig_driver").is_empty() {
        return Err(SectionError::NoNode);
    }
    let declared = RigParameters::default().declarations();
    let given = file.taken_by("/rig_driver", &declared)?;
    let prefix = format!("{section}.");
    let (there, missing): (Vec<_>, Vec<_>) = declared
        .iter()
        .map(Declaration::name)
        .filter(|name| name.starts_with(&prefix))
        .partition(|name| given.contains_key(*name));
    if there.is_empty() {
        return Err(SectionError::NoSection { section });
    }
    if let Some(name) = missing.first() {
        return Err(SectionError::Missing { section, name: (*name).to_owned() });
    }
    Ok(RigParameters::default().with(&Values::given(&declared, &given)?))
}

/// Reads a parameter file with `/rig_driver: ros__parameters: calibration:`, or a rig profile with a
/// calibration.
///
/// # Errors
/// [`RigFileError`] says what is wrong in the text.
pub fn read(text: &str) -> Result<Calibration, RigFileError> {
    if RigProfile::is_one(text) {
        return RigProfile::read(text)?.calibration.ok_or(RigFileError::NoCalibration);
    }
    let said = of_rig_driver(text, "calibration")?;
    said.calibration.check().map_err(|error| RigFileError::section("calibration", error))?;
    Ok(said.calibration)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_section_is_read_under_every_name_that_means_the_node() {
        let read = |node: &str, body: &str| {
            let said = of_rig_driver(&format!("{node}:\n  ros__parameters:\n{body}"), "drive");
            said.map(|said| said.drive.gear_ratio)
        };
        let good = "    drive: {motor_constant: 0.1, gear_ratio: 70.0, armature_resistance: 2.6, inertia: 0.1}\n";
        for node in ["/rig_driver", "rig_driver", "/**/rig_driver", "/**", "/*"] {
            assert_eq!(read(node, good), Ok(70.0), "{node}");
        }
        for (node, body, said) in [
            ("/controller", good, "rig_driver"),
            ("/axis_1/rig_driver", good, "rig_driver"),
            ("/rig_driver", "    rig: simulated\n", "no `drive`"),
            ("/rig_driver", &good.replace("70.0", "70"), "write 70.0"),
            ("/rig_driver", &good.replace("gear_ratio", "gear_ration"), "`drive.gear_ratio`"),
            ("/rig_driver", &good.replace(", inertia: 0.1", ""), "`drive.inertia` is missing"),
            ("/rig_driver", &good.replace("drive:", "drives:"), "`drive."),
        ] {
            let error = read(node, body).unwrap_err().to_string();
            assert!(error.contains(said), "{node}: {error}");
        }
    }
}
