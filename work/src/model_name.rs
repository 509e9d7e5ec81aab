//! A friction model's name as an option takes it.

use friction_model::{ModelError, ModelName};

use crate::suggestion::did_you_mean;

/// A text that names no friction model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{source}{meant}")]
pub struct UnknownModel {
    /// What there is.
    pub source: ModelError,
    /// The nearest known name, in words; nothing where none is near.
    pub meant: String,
}

/// The model of that name.
///
/// # Errors
/// [`UnknownModel`] with what was expected and the nearest known name.
pub fn model_name(text: &str) -> Result<ModelName, UnknownModel> {
    text.parse().map_err(|source| UnknownModel {
        source,
        meant: did_you_mean(text, ModelName::ALL.map(ModelName::as_str)),
    })
}
