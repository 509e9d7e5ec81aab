//! A friction model's name as an option takes it.

use friction_model::{ModelError, ModelName};

use crate::suggestion::did_you_mean;

/// The model of that name.
///
/// # Errors
/// What was expected, with the nearest known name.
pub fn model_name(text: &str) -> Result<ModelName, String> {
    text.parse().map_err(|error: ModelError| {
        format!("{error}{}", did_you_mean(text, ModelName::ALL.map(ModelName::as_str)))
    })
}
