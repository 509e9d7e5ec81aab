//! The techniques of compensation, as a person chooses them.

use controller::ControllerOptions;
use friction_observer::adaptive::{LevelOptions, ParameterOptions};
use friction_observer::{DisturbanceObserverOptions, EstimatorOptions, RbfOptions, Technique};
use serde::{Deserialize, Serialize};

/// By what means friction is compensated.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize, clap::ValueEnum,
)]
#[serde(rename_all = "kebab-case")]
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
}

impl Means {
    /// The name on the command line and in tables.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Feedback => "feedback",
            Self::Feedforward => "feedforward",
            Self::Both => "both",
            Self::Adaptive => "adaptive",
            Self::AdaptiveParameters => "adaptive-parameters",
            Self::DisturbanceObserver => "disturbance-observer",
            Self::Rbf => "rbf",
        }
    }

    /// Whether a friction model stands behind it.
    #[must_use]
    pub const fn needs_model(self) -> bool {
        match self {
            Self::Feedback | Self::Feedforward | Self::Both | Self::Adaptive | Self::AdaptiveParameters => {
                true
            }
            Self::DisturbanceObserver | Self::Rbf => false,
        }
    }

    /// Sets the estimator and the controller up for it.
    pub fn configure(self, estimator: &mut EstimatorOptions, controller: &mut ControllerOptions) {
        estimator.technique = match self {
            Self::Feedback => Technique::Feedback,
            Self::Feedforward => Technique::Feedforward,
            Self::Both => Technique::Both { share: 0.5 },
            Self::Adaptive => Technique::Adaptive(LevelOptions::SRV02),
            Self::AdaptiveParameters => Technique::AdaptiveParameters(ParameterOptions::SRV02),
            Self::DisturbanceObserver => Technique::DisturbanceObserver(DisturbanceObserverOptions::SRV02),
            Self::Rbf => Technique::Rbf(RbfOptions::SRV02),
        };
        controller.compensation.enabled = true;
    }
}
