//! How the friction torque is estimated.

use serde::{Deserialize, Serialize};

use crate::adaptive::{LevelOptions, ParameterOptions, StiffnessOptions};
use crate::error::within;
use crate::{
    DisturbanceObserverOptions, FuzzyOptions, ObserverError, RbfOptions, SuperTwistingOptions,
};

/// Where the estimate comes from.
#[derive(
    Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, strum::EnumDiscriminants,
)]
#[serde(rename_all = "snake_case")]
#[strum_discriminants(
    name(TechniqueName),
    doc = "Where the estimate comes from, without its options.",
    derive(strum::EnumString, strum::IntoStaticStr, strum::VariantNames),
    strum(serialize_all = "snake_case")
)]
pub enum Technique {
    /// A model driven by the measured velocity (thesis section 5.2).
    #[default]
    Feedback,
    /// A model driven by the velocity that the reference asks for: knows the friction before the
    /// shaft moves, and nothing of what it really does.
    Feedforward,
    /// Both of them, weighted.
    Both {
        /// Weight of the feedforward estimate, from 0 to 1; the feedback estimate has the rest.
        share: f64,
    },
    /// A model of which one factor is adapted.
    Adaptive(LevelOptions),
    /// A model of which the parameters that enter linearly while sliding are adapted.
    AdaptiveParameters(ParameterOptions),
    /// A model of which the pre-sliding stiffness is adapted.
    AdaptiveStiffness(StiffnessOptions),
    /// What the nominal drive does not explain. Needs no friction model.
    DisturbanceObserver(DisturbanceObserverOptions),
    /// A network of radial basis functions that learns the friction-speed curve on line. Needs no
    /// friction model.
    Rbf(RbfOptions),
    /// Sliding mode of second order on the error. Needs no friction model.
    SuperTwisting(SuperTwistingOptions),
    /// A fuzzy table over the error. Needs no friction model.
    Fuzzy(FuzzyOptions),
}

impl Technique {
    /// Checks every field.
    ///
    /// # Errors
    /// [`ObserverError::OutOfRange`] names the field.
    pub fn check(&self) -> Result<(), ObserverError> {
        match self {
            Self::Feedback | Self::Feedforward => Ok(()),
            Self::Both { share } => within("share", *share, 0.0..=1.0, "from 0 to 1"),
            Self::Adaptive(options) => options.check(),
            Self::AdaptiveParameters(options) => options.check(),
            Self::AdaptiveStiffness(options) => options.check(),
            Self::DisturbanceObserver(options) => Ok(options.check()?),
            Self::Rbf(options) => options.check(),
            Self::SuperTwisting(options) => Ok(options.check()?),
            Self::Fuzzy(options) => Ok(options.check()?),
        }
    }

    /// Whether a friction model stands behind it.
    #[must_use]
    pub const fn needs_model(&self) -> bool {
        !matches!(
            self,
            Self::DisturbanceObserver(_) | Self::Rbf(_) | Self::SuperTwisting(_) | Self::Fuzzy(_)
        )
    }
}
