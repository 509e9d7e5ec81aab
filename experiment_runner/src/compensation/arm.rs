//! One side of a comparison.

use std::fmt;

use friction_model::ModelName;
use serde::{Deserialize, Serialize};

use super::Means;

/// What compensates the friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Arm {
    /// Nothing: the linear controller alone.
    None,
    /// A technique that needs no model.
    Plain(Means),
    /// A technique over a model.
    Model(Means, ModelName),
}

impl Arm {
    /// The observer on the measured velocity over `model`.
    #[must_use]
    pub const fn observer(model: ModelName) -> Self {
        Self::Model(Means::Feedback, model)
    }

    /// Every technique, over each of `models` where it needs one; nothing comes first.
    #[must_use]
    pub fn all(means: &[Means], models: &[ModelName]) -> Vec<Self> {
        let of = |&means: &Means| {
            let over = if means.needs_model() { models } else { &[] };
            let plain = (!means.needs_model()).then_some(Self::Plain(means));
            over.iter().map(move |&model| Self::Model(means, model)).chain(plain)
        };
        std::iter::once(Self::None).chain(means.iter().flat_map(of)).collect()
    }

    /// By what means; `None` for nothing.
    #[must_use]
    pub const fn means(&self) -> Option<Means> {
        match self {
            Self::None => None,
            Self::Plain(means) | Self::Model(means, _) => Some(*means),
        }
    }

    /// Over which model.
    #[must_use]
    pub const fn model(&self) -> Option<ModelName> {
        match self {
            Self::None | Self::Plain(_) => None,
            Self::Model(_, model) => Some(*model),
        }
    }
}

/// The name in tables: `none`, `lugre` for the observer on the measured velocity,
/// `lugre feedforward`, `rbf`.
impl fmt::Display for Arm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.pad("none"),
            Self::Plain(means) => f.pad(means.as_str()),
            Self::Model(Means::Feedback, model) => f.pad(model.as_str()),
            Self::Model(means, model) => f.pad(&format!("{model} {}", means.as_str())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_technique_meets_every_model() {
        let models = [ModelName::LuGre, ModelName::Proposed];
        let arms = Arm::all(&[Means::Feedback, Means::Feedforward], &models);
        let names: Vec<_> = arms.iter().map(ToString::to_string).collect();
        assert_eq!(
            names,
            ["none", "lugre", "proposed", "lugre feedforward", "proposed feedforward"]
        );
    }
}
