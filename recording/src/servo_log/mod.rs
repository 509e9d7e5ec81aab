//! A log of a position-controlled servo with a pendulum: one JSON object, as the
//! servo-identification tool bam records it.
//!
//! ```text
//! mass [kg], length [m], kp (device units)                          the header's needed part
//! motor, vin [V], arm_mass [kg], damping, control_mode, trajectory  the header's other part; more fields may stand there
//! entries: timestamp [s], position, goal_position [rad]; speed [rad/s], input_volts [V], torque_enable where recorded
//! ```

mod complaint;

use std::path::{Path, PathBuf};

use serde::de::IgnoredAny;
use serde::{Deserialize, Deserializer};
use serde_json::{Map, Value};

use super::RecordingError;

/// A log as it stands in its file.
#[derive(Debug, Clone, PartialEq)]
pub struct ServoFile {
    /// The file.
    pub path: PathBuf,
    /// Every field but the entries.
    pub header: Map<String, Value>,
    /// Mass of the pendulum \[kg\].
    pub mass: f64,
    /// From the axis to the mass \[m\].
    pub length: f64,
    /// Position gain in the servo's own units.
    pub gain: f64,
    /// Supply voltage that the header gives \[V\].
    pub nominal_supply: Option<f64>,
    /// Median of the supply voltages measured, where there are any \[V\].
    pub measured_supply: Option<f64>,
    /// Mass of the arm \[kg\].
    pub arm_mass: Option<f64>,
    /// Damping of the position loop, in the servo's own units.
    pub damping: Option<f64>,
    /// Time of each sample \[s\].
    pub time: Vec<f64>,
    /// Measured position \[rad\].
    pub position: Vec<f64>,
    /// Measured speed \[rad/s\]; the difference quotient where none was recorded.
    pub speed: Vec<f64>,
    /// Position asked for \[rad\].
    pub goal: Vec<f64>,
    /// Whether the motor was driven.
    pub enabled: Vec<bool>,
}

impl ServoFile {
    /// A text of the header, if it stands there.
    pub fn text(&self, field: &str) -> Option<&str> {
        self.header.get(field).and_then(Value::as_str)
    }

    /// A number of the header, if it stands there.
    pub fn number(&self, field: &str) -> Option<f64> {
        self.header.get(field).and_then(Value::as_f64)
    }

    /// `sin_sin, m 0.5, kp 400`, or the file's name where the header names no motion.
    pub fn title(&self) -> String {
        let name = self.text("trajectory").filter(|name| !name.is_empty()).map_or_else(
            || {
                let stem = self.path.file_stem();
                stem.map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
            },
            str::to_owned,
        );
        format!("{name}, kp {}, {} kg", self.gain, self.mass)
    }

    /// Why the file cannot be used, in a sentence with its name.
    pub fn refuse(&self, detail: impl Into<String>) -> RecordingError {
        RecordingError::ServoLog { path: self.path.clone(), detail: detail.into() }
    }
}

#[derive(Deserialize)]
struct File {
    mass: f64,
    length: f64,
    kp: f64,
    #[serde(default)]
    vin: Option<f64>,
    #[serde(default)]
    arm_mass: Option<f64>,
    #[serde(default)]
    damping: Option<f64>,
    entries: Vec<Entry>,
}

#[derive(Deserialize)]
struct Header {
    #[serde(flatten)]
    fields: Map<String, Value>,
    #[serde(rename = "entries")]
    _entries: IgnoredAny,
}

#[derive(Deserialize)]
struct Entry {
    timestamp: f64,
    position: f64,
    goal_position: f64,
    #[serde(default)]
    speed: Option<f64>,
    #[serde(default)]
    input_volts: Option<f64>,
    #[serde(default = "driven", deserialize_with = "switch")]
    torque_enable: bool,
}

fn driven() -> bool {
    true
}

/// `true`, `false`, or 1 and 0 for them.
fn switch<'de, D: Deserializer<'de>>(from: D) -> Result<bool, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Switch {
        Word(bool),
        Number(f64),
    }
    match Switch::deserialize(from)? {
        Switch::Word(on) => Ok(on),
        Switch::Number(number) if number == 0.0 || number == 1.0 => Ok(number == 1.0),
        Switch::Number(other) => Err(serde::de::Error::custom(format!(
            "torque_enable must be true or false, but is {other}"
        ))),
    }
}

/// Reads a log.
///
/// # Errors
/// [`RecordingError`] with the file, and what is wrong with which field of which entry; the line
/// and column where its text is no JSON.
pub fn read(path: &Path) -> Result<ServoFile, RecordingError> {
    let bytes = files::input::table(path)
        .map_err(|source| RecordingError::Read { path: path.into(), source })?;
    parse(path, &bytes)
}

fn parse(path: &Path, bytes: &[u8]) -> Result<ServoFile, RecordingError> {
    let refuse = |error: serde_json::Error| RecordingError::ServoLog {
        path: path.into(),
        detail: error
            .is_data()
            .then(|| complaint::complaint(bytes))
            .flatten()
            .unwrap_or_else(|| complaint::no_json(bytes, &error)),
    };
    let file: File = serde_json::from_slice(bytes).map_err(refuse)?;
    let Header { fields, .. } = serde_json::from_slice(bytes).map_err(refuse)?;
    if file.entries.is_empty() {
        let detail = "its list `entries` is empty: the recorder wrote the header and not one sample; \
                      record it again, or leave this file out";
        return Err(RecordingError::ServoLog { path: path.into(), detail: detail.to_owned() });
    }
    let column = |of: &dyn Fn(&Entry) -> f64| file.entries.iter().map(of).collect::<Vec<f64>>();
    let (time, position) = (column(&|entry| entry.timestamp), column(&|entry| entry.position));
    let recorded: Option<Vec<f64>> = file.entries.iter().map(|entry| entry.speed).collect();
    let speed = recorded.unwrap_or_else(|| differences(&time, &position));
    let mut volts: Vec<f64> = file
        .entries
        .iter()
        .filter_map(|entry| entry.input_volts)
        .filter(|volts| *volts > 0.0 && volts.is_finite())
        .collect();
    volts.sort_by(f64::total_cmp);
    Ok(ServoFile {
        path: path.into(),
        header: fields,
        mass: file.mass,
        length: file.length,
        gain: file.kp,
        nominal_supply: file.vin,
        measured_supply: volts.get(volts.len() / 2).copied(),
        arm_mass: file.arm_mass,
        damping: file.damping,
        goal: column(&|entry| entry.goal_position),
        enabled: file.entries.iter().map(|entry| entry.torque_enable).collect(),
        time,
        position,
        speed,
    })
}

/// Difference quotients from each sample to the next; the last is repeated.
fn differences(time: &[f64], position: &[f64]) -> Vec<f64> {
    let mut speed: Vec<f64> = time
        .windows(2)
        .zip(position.windows(2))
        .map(|(t, q)| if t[1] > t[0] { (q[1] - q[0]) / (t[1] - t[0]) } else { 0.0 })
        .collect();
    speed.push(speed.last().copied().unwrap_or(0.0));
    speed.truncate(time.len());
    speed
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn text(entries: usize) -> String {
        let entry = |i: usize| {
            let t = 0.0053 * i as f64;
            format!(
                "{{\"timestamp\": {t}, \"position\": {}, \"goal_position\": {t}, \"input_volts\": {}}}",
                2.0 * t,
                if i == 0 { 0.0 } else { 11.9 }
            )
        };
        let entries: Vec<String> = (0..entries).map(entry).collect();
        format!(
            "{{\"mass\": 0.5, \"length\": 0.1, \"kp\": 200, \"vin\": 15, \"trajectory\": \"lift\", \"entries\": [{}]}}",
            entries.join(", ")
        )
    }

    #[test]
    fn the_header_is_kept_and_what_was_measured_is_taken_from_the_entries() {
        let read = parse(Path::new("a.json"), text(101).as_bytes()).unwrap();
        assert_eq!(read.title(), "lift, kp 200, 0.5 kg");
        assert_eq!((read.nominal_supply, read.measured_supply), (Some(15.0), Some(11.9)));
        assert_eq!((read.text("motor"), read.number("kp")), (None, Some(200.0)));
        // No speed was recorded: it is that of the positions.
        assert!(read.speed.len() == 101 && read.speed.iter().all(|w| (w - 2.0).abs() < 1e-9));
        assert!(!read.header.contains_key("entries"));
    }

    #[test]
    fn what_is_wrong_is_said_with_the_file() {
        for (text, part) in [
            (String::new(), "EOF"),
            (text(0), "`entries` is empty"),
            (text(9).replace("\"position\": 0,", "\"position\": NaN,"), "JSON has no NaN"),
            ("[1, 2]".to_owned(), "mass, length, kp and entries, but found a list"),
            (text(9).replace("\"mass\"", "\"weight\""), "missing field `mass`"),
            (text(9).replace("\"mass\": 0.5", "\"mass\": \"0.5\""), "without quotation marks"),
            (text(9).replace("\"vin\": 15", "\"vin\": \"high\""), "`vin` must be a number"),
            (text(9).replace("\"position\": 0,", "\"position\": null, \"was\": 0,"), "null"),
            (
                text(9).replace("\"position\": 0.0212,", "\"position\": \"abc\","),
                "entry 3 of `entries`, counted from 1: `position` must be a number [rad], but is the text \"abc\"",
            ),
            (
                text(9).replace("\"input_volts\"", "\"torque_enable\""),
                "must be true or false, but is 11.9",
            ),
        ] {
            let message = parse(Path::new("a.json"), text.as_bytes()).unwrap_err().to_string();
            assert!(message.contains(part) && message.contains("a.json"), "{message}");
        }
    }

    #[test]
    fn a_switch_may_be_written_as_a_number() {
        let text = text(9).replace("\"input_volts\": 11.9", "\"torque_enable\": 1");
        let read = parse(Path::new("a.json"), text.as_bytes()).unwrap();
        assert_eq!(&read.enabled[..2], [true, true]);
        let text = text.replace("\"torque_enable\": 1", "\"torque_enable\": 0");
        assert!(!parse(Path::new("a.json"), text.as_bytes()).unwrap().enabled[2]);
    }

    proptest! {
        #[test]
        fn never_panics(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            let _ = parse(Path::new("x.json"), &bytes);
        }
    }
}
