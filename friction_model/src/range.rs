//! Values that a parameter may take.

use core::fmt;

use crate::Real;

/// Values a parameter may take. None of them allows a value that is not finite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Range {
    /// Any number.
    Any,
    /// Above zero.
    Positive,
    /// Zero or more.
    NonNegative,
    /// Above the first, at most the second.
    Within(f64, f64),
    /// From the first to the second, both allowed.
    FromTo(f64, f64),
    /// A condition in words, for conditions between parameters.
    Such(&'static str),
}

impl Range {
    /// Whether `value` lies in the range; conditions in words hold for every finite number.
    #[must_use]
    pub fn holds<T: Real>(self, value: T) -> bool {
        let value = value.double();
        value.is_finite()
            && match self {
                Self::Any | Self::Such(_) => true,
                Self::Positive => value > 0.0,
                Self::NonNegative => value >= 0.0,
                Self::Within(low, high) => value > low && value <= high,
                Self::FromTo(low, high) => value >= low && value <= high,
            }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Any => f.write_str("a finite number"),
            Self::Positive => f.write_str("a finite number above zero"),
            Self::NonNegative => f.write_str("a finite number, zero or more"),
            Self::Within(low, high) => write!(f, "above {low} and at most {high}"),
            Self::FromTo(low, high) => write!(f, "from {low} to {high}"),
            Self::Such(condition) => f.write_str(condition),
        }
    }
}
