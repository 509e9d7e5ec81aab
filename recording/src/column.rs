//! How a person names a column, and how columns are recognised without being named.

use std::f64::consts::PI;
use std::str::FromStr;

use super::AxisKind;

/// A column as named on the command line: `NAME` or `NAME:SCALE`.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name in the header.
    pub name: String,
    /// Factor to SI units; none leaves it to the unit in the name.
    pub scale: Option<f64>,
}

/// A text that names no column.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ColumnError {
    /// A scale that scales nothing.
    #[error("the scale must be a finite number other than zero, but is {0}")]
    Scale(f64),
    /// No name.
    #[error("expected NAME or NAME:SCALE, but the name is empty")]
    NoName,
}

impl FromStr for Column {
    type Err = ColumnError;

    fn from_str(text: &str) -> Result<Self, ColumnError> {
        // A colon may belong to the name, unless a number follows it.
        let (name, scale) = match text.rsplit_once(':') {
            Some((name, scale)) => match scale.trim().parse::<f64>() {
                Ok(scale) if scale.is_finite() && scale != 0.0 => (name, Some(scale)),
                Ok(scale) => return Err(ColumnError::Scale(scale)),
                Err(_) => (text, None),
            },
            None => (text, None),
        };
        let name = name.trim();
        if name.is_empty() {
            return Err(ColumnError::NoName);
        }
        Ok(Self { name: name.to_owned(), scale })
    }
}

/// A channel that a table may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    /// Time.
    Time,
    /// Position.
    Position,
    /// Velocity.
    Velocity,
    /// Force or torque.
    Force,
    /// Motor voltage.
    Voltage,
    /// Friction torque from a sensor.
    Friction,
    /// Angle of a motor, in counts.
    Angle,
    /// Angle of a pendulum, in counts.
    Pendulum,
}

impl Channel {
    /// The channel in words.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Force => "force or torque",
            Self::Voltage => "voltage",
            Self::Friction => "friction torque",
            Self::Angle => "angle of the motor",
            Self::Pendulum => "angle of the pendulum",
        }
    }

    /// SI unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Time => "s",
            Self::Position => "m or rad",
            Self::Velocity => "m/s or rad/s",
            Self::Force | Self::Friction => "N or N m",
            Self::Voltage => "V",
            Self::Angle | Self::Pendulum => "counts",
        }
    }

    /// Names that are recognised, in order of preference, compared without regard to case.
    fn known(self) -> &'static [&'static str] {
        match self {
            Self::Time => {
                &["t_s", "time_s", "timestamp_s", "t_ms", "time_ms", "t", "time", "timestamp"]
            }
            Self::Position => &[
                "position_m",
                "position_rad",
                "position_mm",
                "position_deg",
                "q_m",
                "q_rad",
                "x_m",
                "angle_rad",
                "theta_rad",
                "position",
            ],
            Self::Velocity => {
                &["velocity_m_s", "velocity_rad_s", "speed_m_s", "speed_rad_s", "velocity"]
            }
            Self::Force => &[
                "force_N",
                "torque_Nm",
                "torque_N_m",
                "motor_force_N",
                "motor_torque_Nm",
                "effort_N",
                "effort_Nm",
                "force",
                "torque",
            ],
            Self::Voltage => &[
                "voltage_V",
                "voltage_applied_V",
                "control_V",
                "u_V",
                "motor_voltage_V",
                "voltage",
            ],
            Self::Friction => {
                &["friction_Nm", "friction_torque_Nm", "friction_N", "friction_force_N"]
            }
            // They are always named.
            Self::Angle | Self::Pendulum => &[],
        }
    }

    /// The first known name that the header has, as the header spells it.
    pub fn recognise(self, header: &[String]) -> Option<&str> {
        self.known()
            .iter()
            .find_map(|known| header.iter().find(|name| name.eq_ignore_ascii_case(known)))
            .map(String::as_str)
    }
}

/// Factor from the unit at the end of a column's name to SI; one where there is none or it is SI
/// already.
pub fn unit_factor(name: &str) -> f64 {
    let name = name.to_ascii_lowercase();
    let factors = [
        ("_mm", 1e-3),
        ("_mm_s", 1e-3),
        ("_deg", PI / 180.0),
        ("_deg_s", PI / 180.0),
        ("_ms", 1e-3),
        ("_us", 1e-6),
    ];
    factors.iter().find(|(suffix, _)| name.ends_with(suffix)).map_or(1.0, |(_, factor)| *factor)
}

/// Kind of axis that a column's name gives away by its unit.
pub fn axis_of(name: &str) -> Option<AxisKind> {
    let name = name.to_ascii_lowercase();
    let ends = |suffixes: &[&str]| suffixes.iter().any(|suffix| name.ends_with(suffix));
    // `_n_m` ends in `_m` too, so torque comes first.
    if ends(&["_rad", "_rad_s", "_deg", "_deg_s", "_nm", "_n_m"]) {
        Some(AxisKind::Rotary)
    } else if ends(&["_m", "_m_s", "_mm", "_mm_s", "_n"]) {
        Some(AxisKind::Linear)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_names_and_scales() {
        let parse = |text: &str| text.parse::<Column>();
        assert_eq!(parse("force_N"), Ok(Column { name: "force_N".into(), scale: None }));
        assert_eq!(
            parse("control_V:35.15"),
            Ok(Column { name: "control_V".into(), scale: Some(35.15) })
        );
        assert_eq!(parse("a:b:-2"), Ok(Column { name: "a:b".into(), scale: Some(-2.0) }));
        assert_eq!(parse("a:b"), Ok(Column { name: "a:b".into(), scale: None }));
        assert!(parse("").is_err() && parse(":3").is_err());
        assert!(parse("x:0").is_err() && parse("x:nan").is_err());
    }

    #[test]
    fn recognises_the_usual_names() {
        let header =
            ["Time_s", "position_reference_m", "position_m", "control_V"].map(str::to_owned);
        assert_eq!(Channel::Time.recognise(&header), Some("Time_s"));
        assert_eq!(Channel::Position.recognise(&header), Some("position_m"));
        assert_eq!(Channel::Force.recognise(&header), None);
    }

    #[test]
    fn units_tell_the_axis() {
        assert_eq!(axis_of("position_m"), Some(AxisKind::Linear));
        assert_eq!(axis_of("torque_N_m"), Some(AxisKind::Rotary));
        assert_eq!(axis_of("force_N"), Some(AxisKind::Linear));
        assert_eq!(axis_of("velocity_rad_s"), Some(AxisKind::Rotary));
        assert_eq!(axis_of("control_V"), None);
        assert_eq!(unit_factor("position_mm"), 1e-3);
        assert_eq!(unit_factor("position_m"), 1.0);
        assert!((unit_factor("angle_deg") * 180.0 - PI).abs() < 1e-15);
    }
}
