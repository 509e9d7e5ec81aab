//! Experiments as data: what is driven, for how long, how often.

use controller::ControlMode;
use serde::{Deserialize, Serialize};

use crate::waveform::Waveform;

/// Experiment 1 of the thesis: friction at constant velocities.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConstantVelocityProtocol {
    /// Velocities [rad/s], ascending.
    pub velocities: Vec<f64>,
    /// Length of each point [s].
    pub duration: f64,
    /// Dropped at the beginning of each point, until the velocity is steady [s].
    pub drop_first: f64,
    /// Dropped at the end of each point [s].
    pub drop_last: f64,
    /// Repetitions of the whole grid in a set.
    pub repetitions: u32,
    /// Independent sets: the first identifies, the others validate.
    pub sets: u32,
}

impl Default for ConstantVelocityProtocol {
    /// The full protocol: 80 velocities (30 in .03 to .5, 50 in .55 to 4 rad/s), 15 s each of which 10.5 s count, 10
    /// repetitions, two sets.
    fn default() -> Self {
        let mut velocities = spaced(0.03, 0.5, 30);
        velocities.extend(spaced(0.55, 4.0, 50));
        Self { velocities, duration: 15.0, drop_first: 3.0, drop_last: 1.5, repetitions: 10, sets: 2 }
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

    /// Time that the whole experiment takes on a rig [s].
    #[must_use]
    pub fn rig_seconds(&self) -> f64 {
        self.duration * self.velocities.len() as f64 * f64::from(self.repetitions) * f64::from(self.sets)
    }
}

/// `n` values from `first` to `last`, equally spaced.
fn spaced(first: f64, last: f64, n: u32) -> Vec<f64> {
    (0..n).map(|i| first + (last - first) * f64::from(i) / f64::from(n - 1)).collect()
}

/// A reference followed with and without friction compensation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrackingProtocol {
    /// What is regulated.
    pub mode: ControlMode,
    /// The reference.
    pub reference: Waveform,
    /// Length of a run [s].
    pub duration: f64,
    /// Runs of each compensation, with different sensor noise.
    pub repetitions: u32,
}

impl TrackingProtocol {
    /// Velocity tracking of the thesis's Table 6.5: one period of r = .30 sin(.107 t) rad/s, 5 repetitions.
    #[must_use]
    pub fn velocity() -> Self {
        Self {
            mode: ControlMode::Velocity,
            reference: Waveform::SineVelocity { amplitude: 0.30, angular_frequency: 0.107 },
            duration: 58.7,
            repetitions: 5,
        }
    }

    /// Position tracking of the thesis's Table 6.7: 20 s of r = 1.0 sin(.546 t) rad, 5 repetitions.
    #[must_use]
    pub fn position() -> Self {
        Self {
            mode: ControlMode::Position,
            reference: Waveform::SinePosition { amplitude: 1.0, angular_frequency: 0.546 },
            duration: 20.0,
            repetitions: 5,
        }
    }

    /// Time that `arms` compensations take on a rig [s].
    #[must_use]
    pub fn rig_seconds(&self, arms: usize) -> f64 {
        self.duration * f64::from(self.repetitions) * arms as f64
    }
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
        assert!((protocol.duration - protocol.drop_first - protocol.drop_last - 10.5).abs() < 1e-12);
    }
}
