//! Versions of targets: the numbers that a change of meaning goes by.

use std::fmt;
use std::str::FromStr;

/// A version, to its second number: what a patch release changes is no meaning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Version {
    major: u16,
    minor: u16,
}

impl Version {
    /// `major.minor`.
    #[must_use]
    pub const fn new(major: u16, minor: u16) -> Self {
        Self { major, minor }
    }
}

/// A text that is no version.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no version; expected one such as 3.12")]
pub struct NotAVersion(String);

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.major, self.minor)
    }
}

impl FromStr for Version {
    type Err = NotAVersion;

    /// Reads `4`, `3.12`, `3.8.1` or `v3.7`.
    fn from_str(text: &str) -> Result<Self, NotAVersion> {
        let parts: Vec<&str> = text.trim().trim_start_matches('v').split('.').collect();
        let number = |place: usize| parts.get(place).map_or(Ok(0), |part| part.parse::<u16>());
        let rest = parts.iter().skip(2).all(|part| part.parse::<u16>().is_ok());
        match (number(0), number(1)) {
            (Ok(major), Ok(minor)) if rest && parts.len() <= 3 => Ok(Self { major, minor }),
            _ => Err(NotAVersion(text.to_owned())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_compared_as_numbers() {
        let version = |text: &str| text.parse::<Version>().unwrap();
        assert!(version("3.7") < version("3.12"));
        assert_eq!(version("v3.8.1"), version("3.8"));
        assert_eq!(version("4").to_string(), "4.0");
        for text in ["", "x", "3.x", "3..1", "3.1.2.3", "-1", "3.7rc1"] {
            assert!(text.parse::<Version>().is_err(), "{text}");
        }
    }
}
