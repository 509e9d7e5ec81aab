//! `drive.yaml`: the drive as a ROS 2 parameter file, and the motor read back from it.

use friction_ident::drive::Calibration;
use friction_model::Motor;

use parameters::ParameterValue;
use parameters::file::Writer;
use rig_setup::{DriveSheet, RigProfile, of_rig_driver};

use super::{DriveFileError, Identified};

/// From what was identified; none unless gear ratio, back-EMF, torque per volt and inertia are
/// all known.
///
/// A measured friction torque tells `A K_m` and `R_a / (A K_m)` themselves, else they are the
/// given ones.
#[must_use]
pub fn motor_of(found: &Identified) -> Option<Motor> {
    let gear_ratio = found.gear_ratio?;
    let inertia = found.value("inertia")?;
    let (back_emf, volts_per_torque) =
        match (found.value("back_emf"), found.value("volts_per_torque")) {
            (Some(back_emf), Some(volts)) => (back_emf, volts),
            _ => match found.calibration? {
                Calibration::Motor { torque_constant, resistance } => {
                    (torque_constant.value, resistance.value / torque_constant.value)
                }
                Calibration::ForcePerVolt(_) => return None,
            },
        };
    Some(Motor {
        motor_constant: back_emf / gear_ratio,
        gear_ratio,
        armature_resistance: volts_per_torque * back_emf,
        inertia,
    })
}

/// Reads a parameter file with `/rig_driver: ros__parameters: drive:`, or a rig profile with a
/// drive.
///
/// # Errors
/// [`DriveFileError`] says what is wrong in the text.
pub fn read_motor(text: &str) -> Result<Motor, DriveFileError> {
    if RigProfile::is_one(text) {
        let drive = RigProfile::read(text)?.drive.ok_or(DriveFileError::NoDrive)?;
        return drive.motor().ok_or(DriveFileError::NoMotor);
    }
    let motor = Motor::from(of_rig_driver(text, "drive")?.drive);
    motor.check()?;
    Ok(motor)
}

/// The drive as a rig profile has it; none unless gain and time constant are known.
#[must_use]
pub fn sheet(found: &Identified) -> Option<DriveSheet> {
    // Without a gear ratio the constants are those of the load.
    let known = Identified { gear_ratio: found.gear_ratio.or(Some(1.0)), ..found.clone() };
    let motor = motor_of(&known);
    Some(DriveSheet {
        gain: found.value("gain")?,
        time_constant: found.value("time_constant")?,
        motor_constant: motor.map(|p| p.motor_constant),
        gear_ratio: motor.map(|p| p.gear_ratio),
        armature_resistance: motor.map(|p| p.armature_resistance),
        inertia: motor.map(|p| p.inertia),
    })
}

/// The file as text.
pub fn render(found: &Identified) -> String {
    let mut file = Writer::default();
    file.comment(&format!(
        "A drive fitted by frictionlab {}. Behind each value stands where it comes from.",
        env!("CARGO_PKG_VERSION")
    ));
    for [name, value, unit, interval, verdict] in crate::rows::rows(&found.estimates) {
        file.comment(&format!("{name}: {value} {unit}, 95 % {interval}, {verdict}"));
    }
    match motor_of(found) {
        Some(p) => {
            let by_sensor =
                found.value("back_emf").is_some() && found.value("volts_per_torque").is_some();
            let (motor, resistance) = if by_sensor {
                ("identified, with the gear ratio that was given", "identified")
            } else {
                ("given", "given")
            };
            file.node("/rig_driver");
            for (name, value, from) in [
                ("motor_constant", p.motor_constant, motor),
                ("gear_ratio", p.gear_ratio, "given"),
                ("armature_resistance", p.armature_resistance, resistance),
                ("inertia", p.inertia, "identified"),
            ] {
                file.value(&format!("drive.{name}"), ParameterValue::Double(value), from);
            }
        }
        None => file.comment(
            "No /rig_driver here: the motor's constants (--gear-ratio, --motor-constant, --resistance) or a torque sensor are needed.",
        ),
    }
    file.node("/drive_identification");
    for estimate in found.estimates.iter().filter(|estimate| estimate.is_identified()) {
        let value = ParameterValue::Double(estimate.value);
        file.value(&estimate.id.to_string(), value, "identified");
    }
    file.text()
}

#[cfg(test)]
mod tests {
    use super::read_motor;

    #[test]
    fn a_drive_that_cannot_be_is_refused_by_name() {
        let file = |inertia: &str| {
            format!(
                "/rig_driver:\n  ros__parameters:\n    drive:\n      motor_constant: 0.00767\n      gear_ratio: 70.0\n      \
                 armature_resistance: 2.6\n      inertia: {inertia}\n"
            )
        };
        assert_eq!(read_motor(&file("0.0026")).unwrap().inertia, 0.0026);
        assert!(read_motor(&file("-1.0")).unwrap_err().to_string().contains("inertia"));
        assert!(
            read_motor("/controller:\n  ros__parameters:\n    a: 1\n")
                .unwrap_err()
                .to_string()
                .contains("rig_driver")
        );
    }
}
