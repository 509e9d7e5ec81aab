//! A log of a position-controlled servo with a pendulum: one JSON object, as the
//! servo-identification tool bam records it.
//!
//! ```text
//! mass [kg], length [m], kp (device units), vin [V], trajectory     the header
//! entries: timestamp [s], position, goal_position [rad], speed [rad/s], torque_enable; others are left alone
//! ```

use std::path::{Path, PathBuf};

use friction_ident::servo::{RawServoLog, ServoLog};
use serde::Deserialize;

use super::RecordingError;

/// A log and what it is called.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedServoLog {
    /// The file.
    pub path: PathBuf,
    /// The motion that was asked for; empty where the header does not say.
    pub trajectory: String,
    /// The log on its even grid.
    pub log: ServoLog,
}

impl NamedServoLog {
    /// `sin_sin, kp 400`, or the file's name where the header names no motion.
    pub fn title(&self) -> String {
        let name = if self.trajectory.is_empty() {
            self.path
                .file_stem()
                .map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
        } else {
            self.trajectory.clone()
        };
        format!("{name}, kp {}", self.log.gain())
    }
}

#[derive(Deserialize)]
struct File {
    mass: f64,
    length: f64,
    kp: f64,
    vin: f64,
    #[serde(default)]
    trajectory: String,
    entries: Vec<Entry>,
}

#[derive(Deserialize)]
struct Entry {
    timestamp: f64,
    position: f64,
    goal_position: f64,
    speed: f64,
    #[serde(default = "driven")]
    torque_enable: bool,
}

fn driven() -> bool {
    true
}

/// Reads a log.
///
/// # Errors
/// [`RecordingError`] with the file, and the line and column where its text is no such log.
pub fn read(path: &Path) -> Result<NamedServoLog, RecordingError> {
    let bytes = files::input::table(path)
        .map_err(|source| RecordingError::Read { path: path.into(), source })?;
    parse(path, &bytes)
}

fn parse(path: &Path, bytes: &[u8]) -> Result<NamedServoLog, RecordingError> {
    let refuse = |detail: String| RecordingError::ServoLog { path: path.into(), detail };
    let file: File = serde_json::from_slice(bytes).map_err(|error| refuse(error.to_string()))?;
    let column = |of: &dyn Fn(&Entry) -> f64| file.entries.iter().map(of).collect::<Vec<f64>>();
    let raw = RawServoLog {
        mass: file.mass,
        length: file.length,
        gain: file.kp,
        nominal_voltage: file.vin,
        time: column(&|entry| entry.timestamp),
        position: column(&|entry| entry.position),
        speed: column(&|entry| entry.speed),
        goal: column(&|entry| entry.goal_position),
        enabled: file.entries.iter().map(|entry| entry.torque_enable).collect(),
    };
    let log = ServoLog::new(&raw).map_err(|error| refuse(error.to_string()))?;
    Ok(NamedServoLog { path: path.into(), trajectory: file.trajectory, log })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn text(entries: usize) -> String {
        let entry = |i: usize| {
            let t = 0.0053 * i as f64;
            format!(
                "{{\"timestamp\": {t}, \"position\": 0.1, \"goal_position\": {t}, \"speed\": 0, \"load\": 1}}"
            )
        };
        let entries: Vec<String> = (0..entries).map(entry).collect();
        format!(
            "{{\"mass\": 0.5, \"length\": 0.1, \"kp\": 200, \"vin\": 7.4, \"trajectory\": \"lift\", \"entries\": [{}]}}",
            entries.join(", ")
        )
    }

    #[test]
    fn a_log_is_brought_to_the_grid() {
        let read = parse(Path::new("a.json"), text(101).as_bytes()).unwrap();
        assert_eq!(read.title(), "lift, kp 200");
        // 0 to 0.53 s, the end left out.
        assert_eq!(read.log.samples(), 106);
        for (k, goal) in read.log.goal().iter().enumerate() {
            assert!((goal - 0.005 * k as f64).abs() < 1e-12);
        }
    }

    #[test]
    fn what_is_wrong_is_said_with_the_file() {
        for (text, part) in [
            (String::new(), "EOF"),
            (text(2), "at least 3 samples"),
            (text(9).replace("\"mass\": 0.5", "\"mass\": -1"), "mass"),
            (text(9).replace("\"mass\"", "\"weight\""), "missing field `mass`"),
            (text(9).replace("0.0106", "9.0"), "time does not increase"),
            (text(9).replace("\"position\": 0.1", "\"position\": null"), "null"),
        ] {
            let message = parse(Path::new("a.json"), text.as_bytes()).unwrap_err().to_string();
            assert!(message.contains(part) && message.contains("a.json"), "{message}");
        }
    }

    proptest! {
        #[test]
        fn never_panics(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            let _ = parse(Path::new("x.json"), &bytes);
        }
    }
}
