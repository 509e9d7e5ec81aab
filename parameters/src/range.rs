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
    /// One of two whole numbers, as 1 or -1; the lower one first.
    Either(i64, i64),
    /// Every real number but zero.
    NotZero,
}

impl ValueRange {
    /// Real numbers above zero.
    pub const POSITIVE: Self = Self::Double(f64::MIN_POSITIVE, f64::MAX);
    /// Real numbers, zero or more.
    pub const NON_NEGATIVE: Self = Self::Double(0.0, f64::MAX);

    /// Whether it has no upper limit but that of its type.
    #[must_use]
    pub fn is_open(self) -> bool {
        matches!(self, Self::Double(_, f64::MAX) | Self::Integer(_, i64::MAX))
    }

    /// Whether a real number lies in the range; none that is not finite does.
    #[must_use]
    pub fn holds(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Any | Self::Integer(..) | Self::Either(..) => true,
                Self::NotZero => value != 0.0,
                Self::Double(low, high) => (low..=high).contains(&value),
            }
    }

    /// Whether a whole number lies in the range.
    #[must_use]
    pub fn holds_integer(self, value: i64) -> bool {
        match self {
            Self::Any | Self::Double(..) | Self::NotZero => true,
            Self::Integer(low, high) => (low..=high).contains(&value),
            Self::Either(low, high) => value == low || value == high,
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
            Self::Integer(low, i64::MAX) => write!(f, "at least {low}"),
            Self::Integer(low, high) => write!(f, "{low} to {high}"),
            Self::Either(low, high) => write!(f, "{high} or {low}"),
            Self::NotZero => f.write_str("not 0"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sign_is_one_of_two_numbers_and_a_gain_is_not_zero() {
        let sign = ValueRange::Either(-1, 1);
        assert!([-2, 0, 2].iter().all(|n| !sign.holds_integer(*n)));
        assert!(sign.holds_integer(1) && sign.holds_integer(-1));
        assert_eq!(sign.to_string(), "1 or -1");
        assert_eq!(ValueRange::Integer(0, i64::MAX).to_string(), "at least 0");
        assert!(ValueRange::POSITIVE.is_open() && !ValueRange::Double(0.0, 1.0).is_open());
        assert!(ValueRange::NotZero.holds(-1e-9) && !ValueRange::NotZero.holds(0.0));
        assert!(!ValueRange::NotZero.holds(f64::NAN));
    }
}
