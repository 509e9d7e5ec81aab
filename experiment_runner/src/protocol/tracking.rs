//! Tracking: which reference, for how long, how often.

use controller::ControlMode;
use serde::{Deserialize, Serialize};

use crate::waveform::Waveform;

/// How much of the reference is fed forward through the inverse of the frictionless drive,
/// `B(s) = (T s + 1) / K` (thesis section 6.3).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InverseUse {
    /// Nothing.
    #[default]
    Off,
    /// Its gain at zero frequency, `1 / K`.
    Gain,
    /// The whole inverse, with the reference's acceleration.
    Whole,
}

/// A reference followed with and without friction compensation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrackingProtocol {
    /// What is regulated.
    pub mode: ControlMode,
    /// The reference.
    pub reference: Waveform,
    /// How much of the reference goes through the inverse of the drive.
    #[serde(default)]
    pub inverse: InverseUse,
    /// Length of a run \[s\].
    pub duration: f64,
    /// Runs of each compensation, with different sensor noise.
    pub repetitions: u32,
}

impl TrackingProtocol {
    /// Velocity tracking of the thesis's Table 6.5: one period of r = 0.30 sin(0.107 t) rad/s, 5
    /// repetitions.
    #[must_use]
    pub fn velocity() -> Self {
        Self {
            mode: ControlMode::Velocity,
            reference: Waveform::SineVelocity { amplitude: 0.30, angular_frequency: 0.107 },
            inverse: InverseUse::Off,
            duration: 58.7,
            repetitions: 5,
        }
    }

    /// Position tracking of the thesis's Table 6.7: 20 s of r = 1.0 sin(0.546 t) rad, 5
    /// repetitions.
    #[must_use]
    pub fn position() -> Self {
        Self {
            mode: ControlMode::Position,
            reference: Waveform::SinePosition { amplitude: 1.0, angular_frequency: 0.546 },
            inverse: InverseUse::Off,
            duration: 20.0,
            repetitions: 5,
        }
    }

    /// Time that `arms` compensations take on a rig \[s\].
    #[must_use]
    pub fn rig_seconds(&self, arms: usize) -> f64 {
        self.duration * f64::from(self.repetitions) * arms as f64
    }
}
