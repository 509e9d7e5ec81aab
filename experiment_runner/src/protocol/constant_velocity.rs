//! Experiment 1: which constant velocities, for how long, how often.

use serde::{Deserialize, Serialize};

use super::ProtocolFile;
use super::quantity::{Dimension, Quantity};
use super::{ProtocolError, count, within};

/// Experiment 1 of the thesis: friction at constant velocities.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConstantVelocityProtocol {
    /// Velocities [rad/s], ascending.
    pub velocities: Vec<f64>,
    /// Length of each point \[s\].
    pub duration: f64,
    /// Dropped at the beginning of each point, until the velocity is steady \[s\].
    pub drop_first: f64,
    /// Dropped at the end of each point \[s\].
    pub drop_last: f64,
    /// Repetitions of the whole grid in a set.
    pub repetitions: u32,
    /// Independent sets: the first identifies, the others validate.
    pub sets: u32,
}

impl Default for ConstantVelocityProtocol {
    /// The full protocol: 80 velocities (30 in 0.03 to 0.5, 50 in 0.55 to 4 rad/s), 15 s each of
    /// which 10.5 s count, 10 repetitions, two sets.
    fn default() -> Self {
        let mut velocities = spaced(0.03, 0.5, 30);
        velocities.extend(spaced(0.55, 4.0, 50));
        Self {
            velocities,
            duration: 15.0,
            drop_first: 3.0,
            drop_last: 1.5,
            repetitions: 10,
            sets: 2,
        }
    }
}

impl ConstantVelocityProtocol {
    /// A short form to try things out: 20 velocities, 6 s each, 2 repetitions, two sets.
    #[must_use]
    pub fn quick() -> Self {
        let mut velocities = spaced(0.03, 0.5, 12);
        velocities.extend(spaced(0.8, 4.0, 8));
        Self { velocities, duration: 6.0, drop_first: 2.0, drop_last: 0.5, repetitions: 2, sets: 2 }
    }

    /// Time that the whole experiment takes on a rig \[s\].
    #[must_use]
    pub fn rig_seconds(&self) -> f64 {
        self.duration
            * self.velocities.len() as f64
            * f64::from(self.repetitions)
            * f64::from(self.sets)
    }
}

impl ProtocolFile for ConstantVelocityProtocol {
    const NAME: &'static str = "constant-velocity";
    const TEXT: &'static str = include_str!("../../protocols/constant-velocity.yaml");
    type Sheet = Sheet;
}

/// The file's form.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sheet {
    #[serde(rename = "experiment")]
    _experiment: String,
    velocities: Vec<Span>,
    duration: Quantity,
    drop_first: Quantity,
    drop_last: Quantity,
    repetitions: u32,
    sets: u32,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Span {
    from: Quantity,
    to: Quantity,
    points: u32,
}

impl TryFrom<Sheet> for ConstantVelocityProtocol {
    type Error = ProtocolError;

    fn try_from(sheet: Sheet) -> Result<Self, ProtocolError> {
        let mut velocities = Vec::new();
        for (index, span) in sheet.velocities.iter().enumerate() {
            let key = |field: &str| format!("velocities[{index}].{field}");
            let from = within(span.from, &key("from"), Dimension::AngularVelocity, 1e-3, 50.0)?;
            let to = within(span.to, &key("to"), Dimension::AngularVelocity, 1e-3, 50.0)?;
            if to <= from {
                return Err(ProtocolError::new(key("to"), span.to, format!("above {}", span.from)));
            }
            count(span.points, &key("points"), 2, 1000)?;
            velocities.extend(spaced(from, to, span.points));
        }
        if velocities.is_empty() || velocities.windows(2).any(|pair| pair[0] >= pair[1]) {
            return Err(ProtocolError::new(
                "velocities",
                format!("{} spans", sheet.velocities.len()),
                "at least one span, each above the one before",
            ));
        }
        let duration = within(sheet.duration, "duration", Dimension::Time, 0.1, 3600.0)?;
        let drop_first = within(sheet.drop_first, "drop_first", Dimension::Time, 0.0, 3600.0)?;
        let drop_last = within(sheet.drop_last, "drop_last", Dimension::Time, 0.0, 3600.0)?;
        if drop_first + drop_last + 0.05 > duration {
            return Err(ProtocolError::new(
                "duration",
                sheet.duration,
                format!(
                    "longer by 0.05 s or more than what is dropped, {} and {}",
                    sheet.drop_first, sheet.drop_last
                ),
            ));
        }
        let repetitions = count(sheet.repetitions, "repetitions", 1, 1000)?;
        let sets = count(sheet.sets, "sets", 1, 100)?;
        Ok(Self { velocities, duration, drop_first, drop_last, repetitions, sets })
    }
}

/// `n` values from `first` to `last`, equally spaced.
fn spaced(first: f64, last: f64, n: u32) -> Vec<f64> {
    (0..n).map(|i| first + (last - first) * f64::from(i) / f64::from(n - 1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_full_protocol_is_the_thesis_one() {
        let protocol = ConstantVelocityProtocol::default();
        assert_eq!(protocol.velocities.len(), 80);
        assert!(protocol.velocities.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!((protocol.velocities[0], protocol.velocities[79]), (0.03, 4.0));
        assert_eq!(protocol.rig_seconds(), 24_000.0);
        assert!(
            (protocol.duration - protocol.drop_first - protocol.drop_last - 10.5).abs() < 1e-12
        );
    }
}
