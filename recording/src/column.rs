//! How a person names a column, and how columns are recognised without being named.

use std::str::FromStr;

use serde::Serialize;

use super::AxisKind;
use super::units::{self, Quantity, Unit};

/// A column as named on the command line: `NAME` or `NAME:SCALE`. A number counts the columns from
/// one, where no column has it as its name.
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
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
    /// Motor voltage that stands in place of a force.
    DrivingVoltage,
    /// Motor current.
    Current,
    /// Friction torque from a sensor.
    Friction,
    /// Angle of a motor, in counts.
    Angle,
    /// Angle of a pendulum, in counts.
    Pendulum,
}

impl Channel {
    /// All that are recognised.
    pub(crate) const fn all() -> &'static [Self] {
        &[
            Self::Time,
            Self::Position,
            Self::Velocity,
            Self::Force,
            Self::Voltage,
            Self::Current,
            Self::Friction,
        ]
    }

    /// Those of which each joint has its own.
    pub(crate) const fn of_joints() -> &'static [Self] {
        &[Self::Position, Self::Velocity, Self::Force, Self::Voltage, Self::Current, Self::Friction]
    }

    /// The channel in words.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Force => "force or torque",
            Self::Voltage | Self::DrivingVoltage => "voltage",
            Self::Current => "current",
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
            Self::Voltage | Self::DrivingVoltage => "V",
            Self::Current => "A",
            Self::Angle | Self::Pendulum => "counts",
        }
    }

    /// Units that are known, for messages.
    const fn usual_units(self) -> &'static str {
        match self {
            Self::Time => "s, ms, us or ns",
            Self::Position => "m, mm, um, rad, mrad, deg or rev",
            Self::Velocity => "m/s, mm/s, rad/s, deg/s, rpm or rev/s",
            Self::Force | Self::Friction => "N, kN, Nm, mNm or Ncm",
            Self::Voltage | Self::DrivingVoltage => "V or mV",
            Self::Current => "A or mA",
            Self::Angle | Self::Pendulum => "rad, deg or counts",
        }
    }

    /// Names that are recognised, in order of preference, compared without their units and without
    /// regard to case. Those marked `true` are recognised with a unit of the channel only.
    fn known(self) -> &'static [(&'static str, bool)] {
        match self {
            Self::Time => &[
                ("t", false),
                ("time", false),
                ("timestamp", false),
                ("time_stamp", false),
                ("stamp", false),
                ("sec", false),
                ("seconds", false),
                ("datetime", false),
                // What pandas calls an index without a name: a time where the file says so.
                ("index", true),
                ("__index_level_0", true),
            ],
            Self::Position => &[
                ("position", false),
                ("q", false),
                ("x", true),
                ("angle", false),
                ("theta", false),
                ("pos", false),
                ("joint_position", false),
                ("motor_position", false),
                ("phi", true),
            ],
            Self::Velocity => &[
                ("velocity", false),
                ("speed", true),
                ("vel", false),
                ("dq", false),
                ("qd", false),
                ("qdot", false),
                ("q_dot", false),
                ("omega", false),
                ("joint_velocity", false),
                ("motor_velocity", false),
                ("dtheta", true),
                ("v", true),
                ("w", true),
            ],
            Self::Force => &[
                ("force", false),
                ("torque", false),
                ("motor_force", false),
                ("motor_torque", false),
                ("effort", false),
                ("tau", false),
                ("joint_torque", false),
            ],
            Self::Voltage | Self::DrivingVoltage => &[
                ("voltage", false),
                ("voltage_applied", true),
                ("control", true),
                ("u", true),
                ("motor_voltage", true),
            ],
            Self::Current => {
                &[("current", false), ("motor_current", false), ("i", false), ("iq", false)]
            }
            Self::Friction => {
                &[("friction", true), ("friction_torque", true), ("friction_force", true)]
            }
            // They are always named.
            Self::Angle | Self::Pendulum => &[],
        }
    }

    /// Whether values of the channel may be of that kind.
    const fn accepts(self, quantity: Quantity) -> bool {
        match self {
            Self::Time => matches!(quantity, Quantity::Time),
            Self::Position => matches!(quantity, Quantity::Length | Quantity::Angle),
            Self::Velocity => matches!(quantity, Quantity::Speed | Quantity::AngularSpeed),
            Self::Force | Self::Friction => matches!(quantity, Quantity::Force | Quantity::Torque),
            Self::Voltage | Self::DrivingVoltage => matches!(quantity, Quantity::Voltage),
            Self::Current => matches!(quantity, Quantity::Current),
            Self::Angle | Self::Pendulum => matches!(quantity, Quantity::Angle | Quantity::Bare),
        }
    }

    /// The unit that a column's name gives the channel; none where the name has no unit.
    ///
    /// # Errors
    /// [`UnitError`] where it has one that is not known, or is none of this channel.
    pub fn unit_in(self, name: &str) -> Result<Option<Unit>, UnitError> {
        let found = units::parts(name);
        let Some(text) = found.unit else { return Ok(None) };
        match units::unit_of(text) {
            Some(unit) if self.accepts(unit.quantity) => Ok(Some(unit)),
            // `tau_m` is a motor's torque, and not one in metres.
            Some(_) if !found.bracketed && text.len() == 1 => Ok(None),
            _ => Err(UnitError { unit: text.to_owned(), channel: self }),
        }
    }

    /// The column that the header has for the channel, as the header spells it: known names first
    /// in their order, and of those with one name the first with a unit that can be used; then the
    /// only one whose name is a unit of the channel and nothing else.
    pub fn recognise(self, header: &[String]) -> Option<&str> {
        self.by_name(header).or_else(|| {
            let is_unit = |name: &&String| {
                units::parts(name).stem.is_empty() && matches!(self.unit_in(name), Ok(Some(_)))
            };
            let mut named = header.iter().filter(is_unit);
            named.next().filter(|_| named.next().is_none()).map(String::as_str)
        })
    }

    fn by_name(self, header: &[String]) -> Option<&str> {
        self.known().iter().find_map(|&(known, with_unit)| {
            let mut named = header.iter().filter(|name| self.stem_is(name, known, with_unit));
            let first = named.next()?;
            let usable = |name: &&String| self.unit_in(name).is_ok();
            Some(std::iter::once(first).chain(named).find(usable).unwrap_or(first).as_str())
        })
    }

    fn stem_is(self, name: &str, known: &str, with_unit: bool) -> bool {
        let same = |stem: &str| stem.replace([' ', '.', '-'], "_").eq_ignore_ascii_case(known);
        let found = units::parts(name);
        let usable = self.unit_in(name);
        // Of another quantity altogether, it is another channel.
        let other = found
            .unit
            .and_then(units::unit_of)
            .is_some_and(|unit| usable.is_err() && unit.quantity != Quantity::Bare);
        match usable {
            // `sec` is both a usual name and a unit.
            Ok(Some(_)) if found.stem.is_empty() => same(name.trim()) && !with_unit,
            Ok(Some(_)) => same(found.stem),
            Ok(None) => same(name.trim()) && !with_unit,
            Err(_) => same(found.stem) && !with_unit && !other,
        }
    }
}

/// The kind of axis that a name without a unit tells: only a turn has an angle or a torque.
pub(crate) fn axis_in(name: &str) -> Option<AxisKind> {
    let stem = units::parts(name).stem.replace([' ', '.', '-'], "_").to_lowercase();
    match stem.as_str() {
        "torque" | "motor_torque" | "joint_torque" | "tau" | "angle" | "theta" | "phi"
        | "omega" | "dtheta" => Some(AxisKind::Rotary),
        "joint_angle" | "winkel" | "drehwinkel" | "drehzahl" | "drehmoment" | "θ" | "φ" | "ω"
        | "τ" => Some(AxisKind::Rotary),
        "force" | "motor_force" | "kraft" => Some(AxisKind::Linear),
        _ => None,
    }
}

/// A unit that is not known, or is none of the channel that the column is to hold.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{unit}` is not known as a unit of {}; expected {}",
    channel.describe(),
    channel.usual_units()
)]
pub struct UnitError {
    /// As it is written.
    pub unit: String,
    /// What the column is to hold.
    pub channel: Channel,
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
    fn a_unit_alone_names_the_only_column_of_its_kind() {
        let header = ["rpm", "mNm"].map(String::from);
        assert_eq!(Channel::Velocity.recognise(&header), Some("rpm"));
        assert_eq!(Channel::Force.recognise(&header), Some("mNm"));
        assert_eq!(Channel::Position.recognise(&header), None);
        let factor = |channel: Channel, name| channel.unit_in(name).unwrap().unwrap().factor;
        assert!((factor(Channel::Velocity, "rpm") - std::f64::consts::PI / 30.0).abs() < 1e-15);
        assert!((factor(Channel::Velocity, "deg_s") - std::f64::consts::PI / 180.0).abs() < 1e-15);
        assert!((factor(Channel::Force, "mNm") - 1e-3).abs() < 1e-18);
        // A usual name that is a unit comes before a unit that is no usual name.
        let header = ["ms", "sec"].map(String::from);
        assert_eq!(Channel::Time.recognise(&header), Some("sec"));
        let two = ["rpm", "rad/s"].map(String::from);
        assert_eq!(Channel::Velocity.recognise(&two), None);
    }

    #[test]
    fn the_usual_names_are_recognised_with_and_without_units() {
        let is = |channel: Channel, name: &str| {
            channel.recognise(&[name.to_owned()]).is_some_and(|found| found == name)
        };
        for name in ["t", "time", "t_ms", "Time [s]", "timestamp_ns", "stamp", "time (us)"] {
            assert!(is(Channel::Time, name), "{name}");
        }
        for name in ["q", "pos", "position", "q [rad]", "pos_mm", "Angle (deg)", "theta_rad"] {
            assert!(is(Channel::Position, name), "{name}");
        }
        for name in
            ["dq", "vel", "velocity", "dq [rad/s]", "speed (rpm)", "vel_rad.s^-1", "w_rad_s"]
        {
            assert!(is(Channel::Velocity, name), "{name}");
        }
        for name in ["tau", "effort", "torque", "tau [Nm]", "Motor Torque (mNm)", "effort_N_m"] {
            assert!(is(Channel::Force, name), "{name}");
        }
        for name in ["i", "i [A]", "current_mA", "iq"] {
            assert!(is(Channel::Current, name), "{name}");
        }
        // Another quantity, another channel; and one letter may mean anything.
        for (channel, name) in [
            (Channel::Position, "x"),
            (Channel::Velocity, "v [V]"),
            (Channel::Velocity, "speed"),
            (Channel::Position, "position_reference_m"),
        ] {
            assert!(!is(channel, name), "{name}");
        }
    }

    #[test]
    fn units_of_the_channel_count_and_others_are_refused() {
        let factor = |channel: Channel, name: &str| {
            channel.unit_in(name).map(|unit| unit.map(|unit| unit.factor))
        };
        assert_eq!(factor(Channel::Position, "position_mm"), Ok(Some(1e-3)));
        assert_eq!(factor(Channel::Force, "tau_m"), Ok(None), "of the motor");
        assert_eq!(factor(Channel::Force, "tau"), Ok(None));
        for (channel, name, unit) in [
            (Channel::Velocity, "velocity [furlong/fortnight]", "furlong/fortnight"),
            (Channel::Velocity, "position_rad", "rad"),
            (Channel::Position, "position_counts", "counts"),
            (Channel::Force, "effort [%]", "%"),
        ] {
            let error = factor(channel, name).unwrap_err();
            assert_eq!((error.unit.as_str(), error.channel), (unit, channel));
            assert!(error.to_string().contains("expected"), "{error}");
        }
    }

    #[test]
    fn units_tell_the_axis() {
        let axis = |channel: Channel, name: &str| {
            channel.unit_in(name).unwrap().and_then(|unit| unit.quantity.axis())
        };
        assert_eq!(axis(Channel::Position, "position_m"), Some(AxisKind::Linear));
        assert_eq!(axis(Channel::Force, "torque_N_m"), Some(AxisKind::Rotary));
        assert_eq!(axis(Channel::Force, "force_N"), Some(AxisKind::Linear));
        assert_eq!(axis(Channel::Velocity, "velocity_rad_s"), Some(AxisKind::Rotary));
        assert_eq!(axis(Channel::Voltage, "control_V"), None);
        for (name, kind) in [
            ("tau", Some(AxisKind::Rotary)),
            ("Joint Torque", Some(AxisKind::Rotary)),
            ("force", Some(AxisKind::Linear)),
            ("q", None),
            ("effort", None),
        ] {
            assert_eq!(axis_in(name), kind, "{name}");
        }
    }
}
