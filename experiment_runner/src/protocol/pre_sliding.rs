//! Experiment 3: breakaway by slow ramps of torque (stage 1), and a nested path below breakaway
//! (stage 2).

use serde::{Deserialize, Serialize};

use super::ProtocolFile;
use super::quantity::{Dimension, Quantity};
use super::{ProtocolError, count, within};
use crate::profile::{Profile, Segment};

/// Which sensor shows the displacement before sliding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Displacement {
    /// The encoder: exact, but coarse (1.5 mrad on the test bed, a quarter of the breakaway
    /// displacement).
    Encoder,
    /// The potentiometer: its noise hides its steps, so that the mean has no bias.
    Potentiometer,
}

/// When sliding begins: with the last stretch before gross motion in which the speed is above both
/// limits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OnsetRule {
    /// Smallest speed that counts [rad/s], clear of the sensor's noise.
    pub speed: f64,
    /// Multiple of the mean speed since the torque began to rise: more than this, pre-sliding does
    /// not explain.
    pub ratio: f64,
    /// Displacement that no pre-sliding reaches \[rad\]: gross motion.
    pub gross_motion: f64,
}

/// Experiment 3 of the thesis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PreSlidingProtocol {
    /// Rate of the torque's ramps, both ways [N m/s].
    pub rate: f64,
    /// Torque at which a ramp ends if nothing slides [N m].
    pub up_to: f64,
    /// When sliding begins.
    pub onset: OnsetRule,
    /// Turning points of the nested path [N m].
    pub turns: Vec<f64>,
    /// Length of the path \[s\].
    pub duration: f64,
    /// Samples that are kept of the path, each a mean.
    pub samples: u32,
    /// Which sensor shows the displacement.
    pub displacement: Displacement,
    /// Repetitions.
    pub repetitions: u32,
}

impl PreSlidingProtocol {
    /// A ramp upwards (`direction` 1) or downwards (-1).
    #[must_use]
    pub fn ramp(&self, direction: f64) -> Profile {
        ramp(self.rate, self.up_to, direction)
    }

    /// The nested path.
    #[must_use]
    pub fn path(&self) -> Profile {
        let mut segments = vec![Segment::REST];
        segments.extend(Segment::path(0.0, &self.turns, self.duration));
        Profile::new(segments)
    }

    /// A short form to try things out.
    #[must_use]
    pub fn quick(self) -> Self {
        Self { duration: self.duration.min(20.0), repetitions: self.repetitions.min(3), ..self }
    }

    /// Time that the experiment takes on a rig \[s\].
    #[must_use]
    pub fn rig_seconds(&self) -> f64 {
        let ramps = 2.0 * self.ramp(1.0).duration();
        f64::from(self.repetitions) * (ramps + self.path().duration())
    }
}

/// Rest and a ramp of torque.
pub(super) fn ramp(rate: f64, up_to: f64, direction: f64) -> Profile {
    Profile::new(vec![
        Segment::REST,
        Segment::Line { from: 0.0, to: direction * up_to, duration: up_to / rate },
    ])
}

impl ProtocolFile for PreSlidingProtocol {
    const NAME: &'static str = "pre-sliding";
    const TEXT: &'static str = include_str!("../../protocols/pre-sliding.yaml");
    type Sheet = Sheet;
}

/// The file's form.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sheet {
    #[serde(rename = "experiment")]
    _experiment: String,
    ramps: Ramps,
    onset: OnsetSheet,
    path: Path,
    displacement: Displacement,
    repetitions: u32,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Ramps {
    rate: Quantity,
    up_to: Quantity,
}

/// The onset rule in a file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OnsetSheet {
    speed: Quantity,
    ratio: f64,
    gross_motion: Quantity,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Path {
    turns: Vec<Quantity>,
    duration: Quantity,
    samples: u32,
}

impl TryFrom<OnsetSheet> for OnsetRule {
    type Error = ProtocolError;

    fn try_from(sheet: OnsetSheet) -> Result<Self, ProtocolError> {
        if !(1.0..=100.0).contains(&sheet.ratio) {
            return Err(ProtocolError::new("onset.ratio", sheet.ratio, "a number from 1 to 100"));
        }
        Ok(Self {
            speed: within(sheet.speed, "onset.speed", Dimension::AngularVelocity, 1e-5, 10.0)?,
            ratio: sheet.ratio,
            gross_motion: within(
                sheet.gross_motion,
                "onset.gross_motion",
                Dimension::Angle,
                1e-5,
                6.0,
            )?,
        })
    }
}

impl TryFrom<Sheet> for PreSlidingProtocol {
    type Error = ProtocolError;

    fn try_from(sheet: Sheet) -> Result<Self, ProtocolError> {
        let turns = sheet.path.turns.iter().enumerate().map(|(index, &turn)| {
            within(turn, &format!("path.turns[{index}]"), Dimension::Torque, -10.0, 10.0)
        });
        let turns: Vec<f64> = turns.collect::<Result<_, _>>()?;
        check_turns(&turns, "path.turns")?;
        Ok(Self {
            rate: within(sheet.ramps.rate, "ramps.rate", Dimension::TorqueRate, 1e-4, 100.0)?,
            up_to: within(sheet.ramps.up_to, "ramps.up_to", Dimension::Torque, 1e-4, 10.0)?,
            onset: sheet.onset.try_into()?,
            turns,
            duration: within(sheet.path.duration, "path.duration", Dimension::Time, 0.1, 3600.0)?,
            samples: count(sheet.path.samples, "path.samples", 10, 1_000_000)?,
            displacement: sheet.displacement,
            repetitions: count(sheet.repetitions, "repetitions", 1, 1000)?,
        })
    }
}

/// A path needs a turn, and each must differ from the one before (the first from zero).
pub(super) fn check_turns(turns: &[f64], key: &str) -> Result<(), ProtocolError> {
    let mut before = 0.0;
    for (index, &turn) in turns.iter().enumerate() {
        if turn == before {
            let expected = "another level than the turn before (the path starts at zero)";
            return Err(ProtocolError::new(format!("{key}[{index}]"), turn, expected));
        }
        before = turn;
    }
    if turns.is_empty() {
        return Err(ProtocolError::new(key, "empty", "a list of one turn or more"));
    }
    Ok(())
}
