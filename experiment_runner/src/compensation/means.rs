//! The techniques of compensation, as a person chooses them.

use controller::ControllerOptions;
use friction_observer::{EstimatorOptions, Technique};
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
}

impl Means {
    /// The name on the command line and in tables.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Feedback => "feedback",
            Self::Feedforward => "feedforward",
            Self::Both => "both",
        }
    }

    /// Whether a friction model stands behind it.
    #[must_use]
    pub const fn needs_model(self) -> bool {
        match self {
            Self::Feedback | Self::Feedforward | Self::Both => true,
        }
    }

    /// Sets the estimator and the controller up for it.
    pub fn configure(self, estimator: &mut EstimatorOptions, controller: &mut ControllerOptions) {
        estimator.technique = match self {
            Self::Feedback => Technique::Feedback,
            Self::Feedforward => Technique::Feedforward,
            Self::Both => Technique::Both { share: 0.5 },
        };
        controller.compensation.enabled = true;
    }
}
