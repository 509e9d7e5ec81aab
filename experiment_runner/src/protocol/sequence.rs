//! A sequence of one's own: holds, ramps, sines, chirps and triangular paths of one quantity.

use rig_driver::HIGHEST_VOLTAGE;
use serde::{Deserialize, Serialize};

use super::ProtocolFile;
use super::pre_sliding::check_turns;
use super::quantity::{Dimension, Quantity};
use super::{ProtocolError, count, within};
use crate::profile::{DrivenQuantity, Excitation, Profile, Segment};

/// A sequence of segments of one quantity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SequenceProtocol {
    /// Its name, in file names and pictures.
    pub name: String,
    /// What is driven, and how.
    pub excitation: Excitation,
    /// Whether the reference of a velocity also goes through the inverse of the drive.
    pub feed_forward: bool,
    /// Repetitions.
    pub repetitions: u32,
}

impl SequenceProtocol {
    /// Time that the sequence takes on a rig \[s\].
    #[must_use]
    pub fn rig_seconds(&self) -> f64 {
        f64::from(self.repetitions) * self.excitation.profile.duration()
    }
}

impl ProtocolFile for SequenceProtocol {
    const NAME: &'static str = "sequence";
    const TEXT: &'static str = include_str!("../../protocols/sequence.yaml");
    type Sheet = Sheet;
}

/// The file's form.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sheet {
    #[serde(rename = "experiment")]
    _experiment: String,
    name: String,
    drive: DrivenQuantity,
    #[serde(default)]
    feed_forward: bool,
    segments: Vec<SegmentSheet>,
    repetitions: u32,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum SegmentSheet {
    Hold { level: Quantity, duration: Quantity },
    Ramp { to: Quantity, duration: Quantity },
    Sine { amplitude: Quantity, frequency: Quantity, duration: Quantity },
    Chirp { amplitude: Quantity, from: Quantity, to: Quantity, duration: Quantity },
    Path { turns: Vec<Quantity>, duration: Quantity },
}

impl TryFrom<Sheet> for SequenceProtocol {
    type Error = ProtocolError;

    fn try_from(sheet: Sheet) -> Result<Self, ProtocolError> {
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if sheet.name.is_empty() || sheet.name.len() > 60 || !sheet.name.chars().all(plain) {
            let expected = "a name of up to 60 letters, digits, - and _";
            return Err(ProtocolError::new("name", format!("`{}`", sheet.name), expected));
        }
        let (dimension, most) = match sheet.drive {
            DrivenQuantity::Velocity => (Dimension::AngularVelocity, 50.0),
            DrivenQuantity::Position => (Dimension::Angle, 1000.0),
            DrivenQuantity::Voltage => (Dimension::Voltage, HIGHEST_VOLTAGE),
            DrivenQuantity::Torque => (Dimension::Torque, 10.0),
        };
        let mut segments: Vec<Segment> = Vec::new();
        let mut level = 0.0;
        for (index, segment) in sheet.segments.iter().enumerate() {
            let key = |field: &str| format!("segments[{index}].{field}");
            let driven =
                |quantity, field: &str| within(quantity, &key(field), dimension, -most, most);
            let time = |quantity| within(quantity, &key("duration"), Dimension::Time, 1e-3, 3600.0);
            let frequency = |quantity, field: &str| {
                within(quantity, &key(field), Dimension::AngularVelocity, 0.0, 500.0)
            };
            let wave = |amplitude, from, to, duration| Segment::Wave {
                level,
                amplitude,
                phase: 0.0,
                from,
                to,
                duration,
            };
            match segment {
                SegmentSheet::Hold { level, duration } => {
                    let level = driven(*level, "level")?;
                    segments.push(Segment::Line {
                        from: level,
                        to: level,
                        duration: time(*duration)?,
                    });
                }
                SegmentSheet::Ramp { to, duration } => {
                    let to = driven(*to, "to")?;
                    segments.push(Segment::Line { from: level, to, duration: time(*duration)? });
                }
                SegmentSheet::Sine { amplitude, frequency: w, duration } => {
                    let w = frequency(*w, "frequency")?;
                    segments.push(wave(driven(*amplitude, "amplitude")?, w, w, time(*duration)?));
                }
                SegmentSheet::Chirp { amplitude, from, to, duration } => {
                    let (from, to) = (frequency(*from, "from")?, frequency(*to, "to")?);
                    segments.push(wave(
                        driven(*amplitude, "amplitude")?,
                        from,
                        to,
                        time(*duration)?,
                    ));
                }
                SegmentSheet::Path { turns, duration } => {
                    let each = |(i, &turn)| {
                        within(turn, &key(&format!("turns[{i}]")), dimension, -most, most)
                    };
                    let turns: Vec<f64> =
                        turns.iter().enumerate().map(each).collect::<Result<_, _>>()?;
                    if level == 0.0 {
                        check_turns(&turns, &key("turns"))?;
                    }
                    segments.extend(Segment::path(level, &turns, time(*duration)?));
                }
            }
            level = segments.last().map_or(level, |last| last.at(last.duration()).0);
        }
        if segments.is_empty() {
            return Err(ProtocolError::new("segments", "empty", "a list of one segment or more"));
        }
        Ok(Self {
            name: sheet.name,
            excitation: Excitation { quantity: sheet.drive, profile: Profile::new(segments) },
            feed_forward: sheet.feed_forward,
            repetitions: count(sheet.repetitions, "repetitions", 1, 1000)?,
        })
    }
}
