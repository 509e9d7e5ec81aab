//! The models by name, as files, parameters and the command line spell them.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::ModelError;

/// Which friction model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ModelName {
    /// [`crate::Coulomb`]
    Coulomb,
    /// [`crate::Viscous`]
    Viscous,
    /// [`crate::Stribeck`]
    Stribeck,
    /// [`crate::LuGre`]
    LuGre,
    /// [`crate::Proposed`]
    Proposed,
}

impl ModelName {
    /// Every model, in the order of the documentation.
    pub const ALL: [Self; 5] = [Self::Coulomb, Self::Viscous, Self::Stribeck, Self::LuGre, Self::Proposed];

    /// The name in files and on the command line.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Coulomb => "coulomb",
            Self::Viscous => "viscous",
            Self::Stribeck => "stribeck",
            Self::LuGre => "lugre",
            Self::Proposed => "proposed",
        }
    }

    /// All names, separated by commas, for messages.
    #[must_use]
    pub fn list() -> String {
        Self::ALL.map(Self::as_str).join(", ")
    }
}

impl fmt::Display for ModelName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

impl FromStr for ModelName {
    type Err = ModelError;

    fn from_str(text: &str) -> Result<Self, ModelError> {
        Self::ALL
            .into_iter()
            .find(|name| name.as_str().eq_ignore_ascii_case(text.trim()))
            .ok_or_else(|| ModelError::UnknownModel(text.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_reads_back() {
        for name in ModelName::ALL {
            assert_eq!(name.as_str().parse::<ModelName>().unwrap(), name);
            assert_eq!(serde_json::to_string(&name).unwrap(), format!("\"{name}\""));
        }
    }

    #[test]
    fn an_unknown_name_is_told_the_known_ones() {
        let message = "lugree".parse::<ModelName>().unwrap_err().to_string();
        assert!(message.contains("lugree") && message.contains("lugre, proposed"), "{message}");
    }
}
