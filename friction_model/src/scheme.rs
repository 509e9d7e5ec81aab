//! How a model that is stepped once a period takes the velocity between two steps.

#[cfg(feature = "serde")]
use serde::{Deserialize, Serialize};

/// How the velocity between two steps is taken.
///
/// Both are as stable as the model's fixed-step form, at any period. What each is worth for each
/// model is a table in the book, "Steps of the models".
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, strum::Display, strum::EnumString)]
#[strum(serialize_all = "snake_case")]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize), serde(rename_all = "snake_case"))]
pub enum Scheme {
    /// The velocity of a step is held until the next one ([`FrictionModel::step`]): of first order.
    /// After a step the state is that of the next moment already.
    ///
    /// [`FrictionModel::step`]: crate::FrictionModel::step
    #[default]
    Held,
    /// From one step to the next the velocity is the mean of both ([`FrictionModel::advance`]): of
    /// second order for models without jumps. After a step the state is that of the same moment.
    ///
    /// [`FrictionModel::advance`]: crate::FrictionModel::advance
    Mean,
}
