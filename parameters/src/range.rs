//! Values that a number may take.

use std::fmt;

/// Values that a number may take.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum ValueRange {
    /// All of its type; a real number must be finite.
    #[default]
    Any,
    /// From the first to the second, both allowed.
    Double(f64, f64),
    /// From the first to the second, both allowed.
    Integer(i64, i64),
}

impl ValueRange {
    /// Real numbers above zero.
    pub const POSITIVE: Self = Self::Double(f64::MIN_POSITIVE, f64::MAX);
    /// Real numbers, zero or more.
    pub const NON_NEGATIVE: Self = Self::Double(0.0, f64::MAX);

    /// Whether a real number lies in the range; none that is not finite does.
    #[must_use]
    pub fn holds(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Any | Self::Integer(..) => true,
                Self::Double(low, high) => (low..=high).contains(&value),
            }
    }

    /// Whether a whole number lies in the range.
    #[must_use]
    pub fn holds_integer(self, value: i64) -> bool {
        match self {
            Self::Any | Self::Double(..) => true,
            Self::Integer(low, high) => (low..=high).contains(&value),
        }
    }
}

/// In words, as in `above 0`; nothing for all values.
impl fmt::Display for ValueRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Any => Ok(()),
            Self::POSITIVE => f.write_str("above 0"),
            Self::Double(low, f64::MAX) => write!(f, "at least {low}"),
            Self::Double(low, high) => write!(f, "{low} to {high}"),
            Self::Integer(low, high) => write!(f, "{low} to {high}"),
        }
    }
}
