//! What a friction observer says once a cycle.

use friction_model::{ModelName, Regime};

/// What makes an estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// A friction model, adapted or not.
    Model(ModelName),
    /// A friction model that is none of the built-in ones, by the name that it gives itself.
    OwnModel(&'static str),
    /// The disturbance observer.
    DisturbanceObserver,
    /// The compensator that learns the curve.
    RbfCompensator,
    /// The super-twisting compensator.
    SuperTwisting,
    /// The fuzzy compensator.
    Fuzzy,
}

impl Source {
    /// Its name in messages: that of the model, or `disturbance_observer`,
    /// `rbf_compensator`, `super_twisting` or `fuzzy`.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Model(model) => model.as_str(),
            Self::OwnModel(name) => name,
            Self::DisturbanceObserver => "disturbance_observer",
            Self::RbfCompensator => "rbf_compensator",
            Self::SuperTwisting => "super_twisting",
            Self::Fuzzy => "fuzzy",
        }
    }

    /// The one of that name, if there is one; models that are not built in are not known by name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        [Self::DisturbanceObserver, Self::RbfCompensator, Self::SuperTwisting, Self::Fuzzy]
            .into_iter()
            .find(|source| source.as_str() == name)
            .or_else(|| name.parse().ok().map(Self::Model))
    }
}

/// One cycle's friction estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// What made the estimate.
    pub source: Source,
    /// Friction torque \[N m\]; positive opposes positive velocity.
    pub torque: f64,
    /// Bristle deflection z \[rad\]; zero for static models and without one.
    pub deflection: f64,
    /// Stribeck state gamma [N m]: the present sliding level; zero without a model.
    pub gamma: f64,
    /// Stick or slip.
    pub regime: Regime,
    /// Velocity the estimate was made with \[rad/s\].
    pub velocity: f64,
    /// Measured torque minus `torque` \[N m\], where the rig has a torque sensor.
    pub residual: Option<f64>,
}
