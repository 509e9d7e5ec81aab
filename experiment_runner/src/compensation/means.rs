//! The techniques of compensation, as a person chooses them.

use controller::design::LinearDrive;
use controller::{ControlMode, ControllerOptions};
use friction_observer::adaptive::{LevelOptions, ParameterOptions};
use friction_observer::{
    DisturbanceObserverOptions, EstimatorOptions, FuzzyOptions, RbfOptions, SuperTwistingOptions,
    Technique,
};
use serde::{Deserialize, Serialize};

use super::additions;

/// By what means friction is compensated.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Default,
    Serialize,
    Deserialize,
    clap::ValueEnum,
    strum::IntoStaticStr,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Means {
    /// A model driven by the measured velocity
    #[default]
    Feedback,
    /// A model driven by the reference's velocity
    Feedforward,
    /// Half of each
    Both,
    /// A model whose friction level follows what is measured
    Adaptive,
    /// A model whose parameters of sliding follow what is measured
    AdaptiveParameters,
    /// A disturbance observer, without a model
    DisturbanceObserver,
    /// A network that learns the friction-speed curve while it runs, without a model
    Rbf,
    /// Sliding mode of second order on the error, without a model
    SuperTwisting,
    /// A fuzzy table over the error, without a model
    Fuzzy,
    /// A fast, small oscillation of the voltage, no model
    Dither,
    /// Short pulses in the direction in which the controller moves, no model
    Knocker,
    /// Feedback of the estimated acceleration with gains raised accordingly, no model
    AccelerationFeedback,
    /// Higher linear gains, as much as margins and noise allow: what a model must be compared with
    RetunedPid,
}

impl Means {
    /// The name on the command line and in tables.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        self.into()
    }

    /// Whether a friction model stands behind it.
    #[must_use]
    pub const fn needs_model(self) -> bool {
        match self {
            Self::Feedback
            | Self::Feedforward
            | Self::Both
            | Self::Adaptive
            | Self::AdaptiveParameters => true,
            Self::DisturbanceObserver
            | Self::Rbf
            | Self::SuperTwisting
            | Self::Fuzzy
            | Self::Dither
            | Self::Knocker
            | Self::AccelerationFeedback
            | Self::RetunedPid => false,
        }
    }

    /// Sets the estimator and the controller up for it; the controller's mode must be what it will
    /// be.
    pub fn configure(self, estimator: &mut EstimatorOptions, controller: &mut ControllerOptions) {
        let drive = LinearDrive {
            gain: estimator.drive.gain,
            time_constant: estimator.drive.time_constant,
        };
        let technique = match self {
            Self::Feedback => Some(Technique::Feedback),
            Self::Feedforward => Some(Technique::Feedforward),
            Self::Both => Some(Technique::Both { share: 0.5 }),
            Self::Adaptive => Some(Technique::Adaptive(LevelOptions::SRV02)),
            Self::AdaptiveParameters => {
                Some(Technique::AdaptiveParameters(ParameterOptions::SRV02))
            }
            Self::DisturbanceObserver => {
                Some(Technique::DisturbanceObserver(DisturbanceObserverOptions::SRV02))
            }
            Self::Rbf => Some(Technique::Rbf(RbfOptions::SRV02)),
            Self::SuperTwisting => Some(Technique::SuperTwisting(match controller.mode {
                ControlMode::Velocity => SuperTwistingOptions::SRV02,
                ControlMode::Position => SuperTwistingOptions::SRV02_POSITION,
            })),
            Self::Fuzzy => Some(Technique::Fuzzy(match controller.mode {
                ControlMode::Velocity => FuzzyOptions::SRV02,
                ControlMode::Position => FuzzyOptions::SRV02_POSITION,
            })),
            Self::Dither | Self::Knocker | Self::AccelerationFeedback | Self::RetunedPid => None,
        };
        // Additions to the controller leave the estimate out.
        controller.compensation.enabled = technique.is_some();
        estimator.technique = technique.unwrap_or(estimator.technique);
        match self {
            Self::Dither => controller.dither = Some(additions::dither(controller.mode)),
            Self::Knocker => controller.impulse = Some(additions::knocker(controller.mode)),
            Self::AccelerationFeedback => additions::accelerate(&drive, controller),
            Self::RetunedPid => additions::retune(&drive, controller),
            _ => {}
        }
    }
}
