//! A drive of which gain and time constant are known, and perhaps no more.

use controller::design::LinearDrive;
use files::ros_parameters::{file, tree};
use serde_json::Value;

use super::DriveFileError;
use super::parameters::read_motor;

/// A drive as far as a linear design needs it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownDrive {
    /// Gain and time constant.
    pub linear: LinearDrive,
    /// Voltage that overcomes 1 N m of friction [V/(N m)], where it is known.
    pub volts_per_newton_metre: Option<f64>,
}

impl KnownDrive {
    /// Reads a file with the motor's constants (`/rig_driver: ros__parameters: drive:`) or with
    /// `gain` and `time_constant`, as `frictionlab identify-drive` writes them, under any node,
    /// under `drive:` or alone.
    ///
    /// # Errors
    /// [`DriveFileError`] says what is wrong in the text.
    pub fn read(text: &str) -> Result<Self, DriveFileError> {
        let tree = match file(text)? {
            Some(file) if file.of_node("/rig_driver").contains_key("drive.motor_constant") => {
                let motor = read_motor(text)?;
                return Ok(Self {
                    linear: LinearDrive::of(&motor),
                    volts_per_newton_metre: Some(motor.volts_per_newton_metre()),
                });
            }
            Some(file) => {
                let nodes = file.nodes().iter();
                Value::Array(nodes.map(|node| tree(&node.values).into()).collect())
            }
            None => {
                let bare: Value = serde_saphyr::from_str(text)
                    .map_err(|error| DriveFileError::Yaml(error.to_string()))?;
                Value::Array(vec![bare])
            }
        };
        let nodes = tree.as_array().into_iter().flatten();
        let places = nodes.flat_map(|place| [Some(place), place.get("drive")]).flatten();
        let number = |place: &Value, name: &str| place.get(name).and_then(Value::as_f64);
        let mut found = places.filter_map(|place| {
            let linear = LinearDrive {
                gain: number(place, "gain")?,
                time_constant: number(place, "time_constant")?,
            };
            let volts = number(place, "volts_per_newton_metre")
                .or_else(|| number(place, "volts_per_torque"));
            Some(Self { linear, volts_per_newton_metre: volts })
        });
        let found = found.next().ok_or(DriveFileError::Nothing)?;
        let values = [
            Some(found.linear.gain),
            Some(found.linear.time_constant),
            found.volts_per_newton_metre,
        ];
        match values.into_iter().flatten().find(|value| !(*value > 0.0 && value.is_finite())) {
            None => Ok(found),
            Some(wrong) => Err(DriveFileError::Number(wrong)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gain_and_time_constant_are_enough() {
        let linear = LinearDrive { gain: 2.0, time_constant: 0.05 };
        for text in [
            "gain: 2.0\ntime_constant: 0.05\n",
            "drive:\n  gain: 2\n  time_constant: 0.05\n",
            "# No /rig_driver here.\n/drive_identification:\n  ros__parameters:\n    gain: 2.0\n    time_constant: 0.05\n    delay: 0.001\n",
        ] {
            let known = KnownDrive::read(text).unwrap();
            assert_eq!(known, KnownDrive { linear, volts_per_newton_metre: None }, "{text}");
        }
        for (text, said) in [
            ("gain: 2.0\n", "time_constant"),
            ("gain: -2.0\ntime_constant: 0.05\n", "-2"),
            ("/controller:\n  ros__parameters:\n    pid: {k_p: 1.0}\n", "time_constant"),
        ] {
            let error = KnownDrive::read(text).unwrap_err().to_string();
            assert!(error.contains(said), "{text}: {error}");
        }
    }

    #[test]
    fn the_motors_constants_tell_more() {
        let text = "/rig_driver:\n  ros__parameters:\n    drive:\n      motor_constant: 0.00767\n      gear_ratio: 70.0\n      \
                    armature_resistance: 2.6\n      inertia: 0.0026476\n/drive_identification:\n  ros__parameters:\n    gain: 9.0\n    time_constant: 9.0\n";
        let known = KnownDrive::read(text).unwrap();
        assert!(
            (known.linear.gain - 1.8625).abs() < 1e-3 && known.volts_per_newton_metre.is_some()
        );
    }
}
