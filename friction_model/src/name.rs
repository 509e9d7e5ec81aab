//! The models by name, as files, parameters and the command line spell them.

use core::fmt;

use crate::ModelName;

#[cfg(feature = "std")]
impl ModelName {
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

#[cfg(feature = "std")]
impl std::str::FromStr for ModelName {
    type Err = crate::ModelError;

    /// Reads a name; upper case counts as lower, a dash as an underscore.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let wanted = text.trim().replace('-', "_");
        Self::ALL
            .into_iter()
            .find(|name| name.as_str().eq_ignore_ascii_case(&wanted))
            .ok_or_else(|| crate::ModelError::UnknownModel(text.to_owned()))
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
        assert!(message.contains("lugree") && message.contains("lugre, "), "{message}");
    }
}
