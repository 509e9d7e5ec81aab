//! What is known of a servo before it moves: a description in YAML, built in or of one's own.

use std::collections::BTreeMap;

use friction_ident::servo::{Control, Drive, Free, FrictionLevel, ServoParameter};
use serde::Deserialize;
use work::BadInput;

/// Bounds are this many times the data sheet's value above and below it.
const AROUND: f64 = 5.0;

/// The built-in descriptions.
const FAMILIES: [(&str, &str); 4] = [
    ("dynamixel_x.yaml", include_str!("../../servos/dynamixel_x.yaml")),
    ("dynamixel_mx.yaml", include_str!("../../servos/dynamixel_mx.yaml")),
    ("feetech_sts.yaml", include_str!("../../servos/feetech_sts.yaml")),
    ("erob.yaml", include_str!("../../servos/erob.yaml")),
];

/// A description to start from.
pub const EXAMPLE: &str = include_str!("../../servos/example.yaml");

/// A servo.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ServoDescription {
    /// What logs call it, the first for people.
    pub names: Vec<String>,
    /// Where the figures come from.
    pub source: String,
    control: ControlMode,
    gain: Gain,
    full_scale: FullScale,
    /// Step of the encoder \[rad\].
    #[serde(default)]
    pub encoder_step: Option<f64>,
    /// Turns of the motor a turn of the axis.
    #[serde(default)]
    pub gear_ratio: Option<f64>,
    /// Supply that the figures below hold at \[V\].
    pub nominal_voltage: f64,
    /// Torque at stall \[N m\].
    #[serde(default)]
    pub stall_torque: Option<f64>,
    /// Current at stall \[A\].
    #[serde(default)]
    pub stall_current: Option<f64>,
    /// Speed without load \[rad/s\].
    #[serde(default)]
    pub no_load_speed: Option<f64>,
    /// Damping of a current loop over the square root of its gain, where the log gives none.
    #[serde(default)]
    pub damping_per_root_gain: f64,
    #[serde(default)]
    goal_speed_limited: bool,
    #[serde(default)]
    bounds: BTreeMap<String, [f64; 2]>,
}

/// What the position loop commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum ControlMode {
    Voltage,
    Current,
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Gain {
    per_unit: f64,
    #[serde(default)]
    estimated: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct FullScale {
    value: f64,
    #[serde(default)]
    estimated: bool,
}

impl ServoDescription {
    /// All that are built in.
    ///
    /// # Errors
    /// None but a mistake of this program.
    pub fn built_in() -> Result<Vec<Self>, BadInput> {
        let mut all = Vec::new();
        for (name, text) in FAMILIES {
            let family: Vec<Self> = serde_saphyr::from_str(text)
                .map_err(|error| BadInput(format!("{name}: {error}")))?;
            for description in &family {
                description.check(name)?;
            }
            all.extend(family);
        }
        Ok(all)
    }

    /// One from the text of a file of that name.
    ///
    /// # Errors
    /// [`BadInput`] says what is wrong with it, and shows one that is right.
    pub fn read(file: &str, text: &str) -> Result<Self, BadInput> {
        let description: Self = serde_saphyr::from_str(text).map_err(|error| {
            let hint = hint(&error.to_string());
            BadInput(format!(
                "{file} is no servo description: {error}{hint}\nA description looks like this:\n\n{EXAMPLE}"
            ))
        })?;
        description.check(file)?;
        Ok(description)
    }

    /// The built-in one that logs call so; capitals, blanks and dashes do not count.
    ///
    /// # Errors
    /// [`BadInput`] for a name that there is not, with how to write a description.
    pub fn of_motor(motor: &str) -> Result<Self, BadInput> {
        let all = Self::built_in()?;
        let wanted = plain(motor);
        if let Some(found) =
            all.iter().find(|servo| servo.names.iter().any(|name| plain(name) == wanted))
        {
            return Ok(found.clone());
        }
        let names = all.iter().flat_map(|servo| &servo.names).map(String::as_str);
        Err(BadInput(format!(
            "no servo `{motor}` is described{} (frictionlab identify-servo --list-servos names all). \
             Its gain and its limits must be known: write them into a file and give it with \
             --servo FILE.yaml. A description looks like this:\n\n{EXAMPLE}",
            work::suggestion::did_you_mean(motor, names)
        )))
    }

    /// How a log's name for it is told in a sentence.
    pub fn name(&self) -> &str {
        self.names.first().map_or("unnamed servo", String::as_str)
    }

    /// Whether a log calls it so.
    pub fn is_called(&self, motor: &str) -> bool {
        self.names.iter().any(|name| plain(name) == plain(motor))
    }

    /// The law of its position loop.
    pub fn drive(&self) -> Drive {
        let control = match self.control {
            ControlMode::Voltage => Control::Voltage,
            ControlMode::Current => Control::Current,
        };
        Drive { control, per_gain: self.gain.per_unit, full_scale: self.full_scale.value }
    }

    /// `voltage` or `current`.
    pub fn control(&self) -> &'static str {
        match self.control {
            ControlMode::Voltage => "voltage",
            ControlMode::Current => "current",
        }
    }

    /// What a fit of this level searches: the level's parameters and those of the drive that are
    /// not known, each within the bounds that suit this servo.
    pub fn free(&self, level: FrictionLevel, delay: bool) -> Vec<Free> {
        let mut parameters = level.parameters().to_vec();
        let mut also = |parameter, wanted: bool| {
            if wanted && !parameters.contains(&parameter) {
                parameters.push(parameter);
            }
        };
        also(ServoParameter::Delay, delay);
        also(ServoParameter::GainScale, self.gain.estimated);
        also(ServoParameter::FullScale, self.full_scale.estimated);
        also(ServoParameter::GoalSpeed, self.goal_speed_limited);
        parameters.retain(|parameter| delay || *parameter != ServoParameter::Delay);
        parameters.into_iter().map(|parameter| self.bounded(parameter)).collect()
    }

    /// Whether the scale of the gain is a free parameter.
    pub fn estimates_gain(&self) -> bool {
        self.gain.estimated
    }

    fn bounded(&self, parameter: ServoParameter) -> Free {
        use ServoParameter as P;
        let (low, high) = match self.bounds.get(parameter.name()) {
            Some(&[low, high]) => (low, high),
            None => {
                let usual = parameter.bounds();
                let around = |value: Option<f64>, low: f64, high: f64| {
                    value.map_or(usual, |value| (low * value, high * value))
                };
                let torque = self.stall_torque;
                let pair = |a: Option<f64>, b: Option<f64>| a.zip(b).map(|(a, b)| a / b);
                let slope = pair(torque, self.no_load_speed);
                match parameter {
                    P::TorqueConstant => {
                        around(pair(torque, self.stall_current), 1.0 / AROUND, AROUND)
                    }
                    P::Resistance => around(
                        pair(Some(self.nominal_voltage), self.stall_current),
                        1.0 / AROUND,
                        AROUND,
                    ),
                    // Mechanical time constants of a millisecond to half a second.
                    P::Armature => around(slope, 1e-3, 0.5),
                    P::Coulomb | P::StribeckCoulomb => around(torque, 0.0, 0.4),
                    P::Viscous => around(slope, 0.0, 10.0),
                    P::QuadraticExternal | P::QuadraticMotor => {
                        around(torque.map(f64::recip), 0.0, 0.2)
                    }
                    P::LoadSquared => around(torque.map(f64::recip), 0.0, 1.0),
                    P::StribeckVelocity => around(self.no_load_speed, 0.01, 0.3),
                    P::GoalSpeed => around(self.no_load_speed, 0.1, 3.0),
                    P::Delay => (-0.02, 0.06),
                    _ => usual,
                }
            }
        };
        Free { parameter, low, high }
    }

    fn check(&self, file: &str) -> Result<(), BadInput> {
        let wrong = |why: String| Err(BadInput(format!("{file}: servo {}: {why}", self.name())));
        if self.names.iter().all(|name| plain(name).is_empty()) {
            return wrong("names must hold one name at least".to_owned());
        }
        let named = [
            ("gain.per_unit", Some(self.gain.per_unit)),
            ("full_scale.value", Some(self.full_scale.value)),
            ("nominal_voltage", Some(self.nominal_voltage)),
            ("encoder_step", self.encoder_step),
            ("gear_ratio", self.gear_ratio),
            ("stall_torque", self.stall_torque),
            ("stall_current", self.stall_current),
            ("no_load_speed", self.no_load_speed),
        ];
        for (name, value) in named {
            if let Some(value) = value.filter(|value| !(*value > 0.0 && value.is_finite())) {
                return wrong(format!("{name} must be a finite number above 0, but is {value}"));
            }
        }
        if !(self.damping_per_root_gain >= 0.0 && self.damping_per_root_gain.is_finite()) {
            return wrong("damping_per_root_gain must be a number of 0 or more".to_owned());
        }
        if self.control == ControlMode::Voltage && self.full_scale.value > 1.0 {
            return wrong(format!(
                "full_scale of a duty cycle is at most 1, but is {}",
                self.full_scale.value
            ));
        }
        for (name, &[low, high]) in &self.bounds {
            let Some(parameter) = ServoParameter::of_name(name) else {
                let names = ServoParameter::ALL.iter().map(|parameter| parameter.name());
                let known: Vec<&str> = names.collect();
                return wrong(format!(
                    "bounds: no parameter `{name}`; there are {}",
                    known.join(", ")
                ));
            };
            let least = parameter.bounds().0;
            if !(low.is_finite() && high.is_finite() && low < high && (least < 0.0 || low >= 0.0)) {
                return wrong(format!(
                    "bounds of {name} must be two numbers, the smaller first{}, but are {low} and {high}",
                    if least < 0.0 { "" } else { " and not negative" }
                ));
            }
            if least > 0.0 && low <= 0.0 {
                return wrong(format!("bounds of {name} must lie above 0, but begin at {low}"));
            }
        }
        Ok(())
    }
}

/// What helps against a form that was not expected.
fn hint(error: &str) -> &'static str {
    let hints = [
        (
            "invalid floating point",
            "\nA number stands without its unit; the example says which it is in.",
        ),
        (
            "expected mapping start\n --> <input>:1:1",
            "\nA file describes one servo: no list begins it.",
        ),
        ("expected mapping start", "\nA value with fields is written as in gain: {per_unit: 0.1}."),
        ("expected sequence start", "\nA list is written in brackets, as in names: [my-servo]."),
    ];
    hints.iter().find(|(said, _)| error.contains(said)).map_or("", |(_, hint)| *hint)
}

/// Letters and digits only, small.
fn plain(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric() || *c == '.').flat_map(char::to_lowercase).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_description_can_be_searched_and_no_name_stands_twice() {
        let all = ServoDescription::built_in().unwrap();
        let mut names: Vec<String> = all
            .iter()
            .flat_map(|s| {
                s.names.iter().map(|n| plain(n)).collect::<std::collections::BTreeSet<_>>()
            })
            .collect();
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count, "{names:?}");
        for servo in &all {
            assert!(servo.drive().is_usable());
            for free in servo.free(FrictionLevel::Progressive, true) {
                assert!(free.low < free.high, "{} {free:?}", servo.name());
            }
        }
        assert!(all.len() > 20);
    }

    #[test]
    fn the_data_sheets_torque_constant_lies_within_the_bounds() {
        for servo in ServoDescription::built_in().unwrap() {
            let Some((torque, current)) = servo.stall_torque.zip(servo.stall_current) else {
                continue;
            };
            let free = servo.bounded(ServoParameter::TorqueConstant);
            assert!(free.low < torque / current && torque / current < free.high, "{free:?}");
        }
    }

    #[test]
    fn a_log_may_spell_the_name_as_it_likes_and_an_unknown_one_is_told_what_to_write() {
        assert_eq!(ServoDescription::of_motor("XL330-M288-T").unwrap().name(), "xl330");
        assert_eq!(ServoDescription::of_motor("mx_106").unwrap().name(), "mx106");
        for motor in ["XH430-V210-R", "2XL430-W250-T", "XD430-T350-R", "XW430-T333-R"] {
            assert!(ServoDescription::of_motor(motor).unwrap().is_called(motor), "{motor}");
        }
        let message = ServoDescription::of_motor("sts3216").unwrap_err().to_string();
        assert!(message.contains("did you mean `sts3215`"), "{message}");
        assert!(message.contains("--servo FILE.yaml") && message.contains("per_unit"), "{message}");
    }

    #[test]
    fn the_example_is_right_and_what_is_wrong_is_named() {
        let own = ServoDescription::read("own.yaml", EXAMPLE).unwrap();
        let free = own.free(FrictionLevel::M1, false);
        let names: Vec<&str> = free.iter().map(|free| free.parameter.name()).collect();
        assert_eq!(names, ["k_t", "r", "armature", "q_offset", "k_c", "k_v", "gain_scale"]);
        assert_eq!((free[2].low, free[2].high), (0.001, 0.1));
        for (from, to, said) in [
            ("gear_ratio:", "gear:", "gear"),
            ("value: 1.0", "value: 885", "at most 1"),
            ("armature:", "inertia:", "no parameter `inertia`"),
            ("[0.001, 0.1]", "[0.1, 0.001]", "the smaller first"),
            ("nominal_voltage: 12.0", "nominal_voltage: -12.0", "nominal_voltage"),
            ("control: voltage", "control: torque", "torque"),
            ("nominal_voltage: 12.0", "nominal_voltage: 12 V", "without its unit"),
            ("gain: {per_unit: 0.1, estimated: true}", "gain: 0.1", "gain: {per_unit: 0.1}"),
            ("names: [my-servo]", "names: my-servo", "names: [my-servo]."),
            ("names: [my-servo]", "- names: [my-servo]", "own.yaml"),
        ] {
            let text = EXAMPLE.replace(from, to);
            let message = ServoDescription::read("own.yaml", &text).unwrap_err().to_string();
            assert!(message.contains("own.yaml") && message.contains(said), "{said}: {message}");
        }
    }
}
