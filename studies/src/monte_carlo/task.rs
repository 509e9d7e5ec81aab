//! The two tasks that the techniques are compared in.

use serde::{Deserialize, Serialize};

use experiment_runner::protocol::TrackingProtocol;

/// What the axis has to follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, strum::VariantArray)]
#[serde(rename_all = "kebab-case")]
pub enum Task {
    /// r = 0.30 sin(0.107 t) rad/s for 58.7 s under the lag compensator (thesis Table 6.5).
    VelocityTracking,
    /// r = 1.0 sin(0.546 t) rad for 20 s under the PID (thesis Table 6.7).
    PositionTracking,
}

impl Task {
    /// Both.
    pub const ALL: &'static [Self] = <Self as strum::VariantArray>::VARIANTS;

    /// In words.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::VelocityTracking => "velocity tracking",
            Self::PositionTracking => "position tracking",
        }
    }

    /// Unit of the error.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::VelocityTracking => "rad/s",
            Self::PositionTracking => "rad",
        }
    }

    /// Reference and length of one run.
    #[must_use]
    pub fn protocol(self) -> TrackingProtocol {
        match self {
            Self::VelocityTracking => TrackingProtocol::velocity(),
            Self::PositionTracking => TrackingProtocol::position(),
        }
    }
}
