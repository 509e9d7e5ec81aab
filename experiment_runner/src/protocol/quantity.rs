//! Numbers with their units, as files carry them: `15 s`, `0.03 rad/s`.

use std::fmt;

use serde::Deserialize;

/// What a quantity measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Time \[s\].
    Time,
    /// Angle \[rad\].
    Angle,
    /// Angular velocity, or angular frequency [rad/s].
    AngularVelocity,
    /// Voltage \[V\].
    Voltage,
    /// Torque [N m].
    Torque,
    /// Rate of a torque [N m/s].
    TorqueRate,
}

/// Every unit that is read: its name, what it measures, and its size in the SI unit.
const UNITS: [(&str, Dimension, f64); 14] = [
    ("s", Dimension::Time, 1.0),
    ("ms", Dimension::Time, 1e-3),
    ("min", Dimension::Time, 60.0),
    ("rad", Dimension::Angle, 1.0),
    ("mrad", Dimension::Angle, 1e-3),
    ("deg", Dimension::Angle, std::f64::consts::PI / 180.0),
    ("rad/s", Dimension::AngularVelocity, 1.0),
    ("deg/s", Dimension::AngularVelocity, std::f64::consts::PI / 180.0),
    ("rpm", Dimension::AngularVelocity, std::f64::consts::PI / 30.0),
    ("V", Dimension::Voltage, 1.0),
    ("mV", Dimension::Voltage, 1e-3),
    ("N m", Dimension::Torque, 1.0),
    ("mN m", Dimension::Torque, 1e-3),
    ("N m/s", Dimension::TorqueRate, 1.0),
];

impl Dimension {
    /// Its SI unit.
    #[must_use]
    pub fn unit(self) -> &'static str {
        UNITS.iter().find(|unit| unit.1 == self).map_or("", |unit| unit.0)
    }

    /// In words, with an article.
    #[must_use]
    pub const fn describe(self) -> &'static str {
        match self {
            Self::Time => "a time",
            Self::Angle => "an angle",
            Self::AngularVelocity => "an angular velocity",
            Self::Voltage => "a voltage",
            Self::Torque => "a torque",
            Self::TorqueRate => "a rate of torque",
        }
    }
}

/// A finite number with its unit.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(try_from = "String")]
pub struct Quantity {
    /// Value in the SI unit.
    pub value: f64,
    /// What it measures.
    pub dimension: Dimension,
}

/// A text that is no quantity.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum QuantityError {
    /// Not a number with a unit behind it.
    #[error("`{text}` is not a number with its unit; write it as in `15 s` (units: {})", units())]
    NoQuantity {
        /// What came.
        text: String,
    },
    /// A unit that there is not.
    #[error("`{text}`: the unit `{unit}` is not known; use one of {}", units())]
    Unit {
        /// What came.
        text: String,
        /// Its unit.
        unit: String,
    },
}

fn units() -> String {
    UNITS.map(|unit| unit.0).join(", ")
}

impl TryFrom<String> for Quantity {
    type Error = QuantityError;

    fn try_from(text: String) -> Result<Self, QuantityError> {
        let text = text.trim();
        let end = text
            .char_indices()
            .find(|&(i, c)| !(c.is_ascii_digit() || "+-.".contains(c) || is_exponent(text, i)))
            .map_or(text.len(), |(i, _)| i);
        let (number, unit) = text.split_at(end);
        let wrong = || QuantityError::NoQuantity { text: text.to_owned() };
        let number: f64 = number.trim().parse().map_err(|_| wrong())?;
        let unit = unit.split_whitespace().collect::<Vec<_>>().join(" ").replace("Nm", "N m");
        if unit.is_empty() || !number.is_finite() {
            return Err(wrong());
        }
        let found = UNITS.iter().find(|candidate| candidate.0 == unit);
        let &(_, dimension, size) =
            found.ok_or_else(|| QuantityError::Unit { text: text.to_owned(), unit })?;
        Ok(Self { value: number * size, dimension })
    }
}

/// Whether the character at `i` is the e of an exponent, as in `1e-3`.
fn is_exponent(text: &str, i: usize) -> bool {
    let next = text[i..].chars().nth(1);
    text[i..].starts_with(['e', 'E'])
        && next.is_some_and(|c| c.is_ascii_digit() || c == '-' || c == '+')
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.value, self.dimension.unit())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Quantity, QuantityError> {
        Quantity::try_from(text.to_owned())
    }

    #[test]
    fn numbers_are_turned_into_si_units() {
        for (text, value, dimension) in [
            ("15 s", 15.0, Dimension::Time),
            ("1.5e3ms", 1.5, Dimension::Time),
            ("-0.085 N m", -0.085, Dimension::Torque),
            ("2 Nm/s", 2.0, Dimension::TorqueRate),
            ("30 rpm", std::f64::consts::PI, Dimension::AngularVelocity),
            ("180 deg", std::f64::consts::PI, Dimension::Angle),
        ] {
            let found = read(text).unwrap();
            assert!(
                (found.value - value).abs() < 1e-12 && found.dimension == dimension,
                "{text}: {found:?}"
            );
        }
    }

    #[test]
    fn a_number_without_a_known_unit_is_refused_with_the_units_there_are() {
        for (text, said) in [
            ("15", "with its unit"),
            ("s", "not a number"),
            ("3 parsecs", "`parsecs` is not known"),
            ("inf s", "not a number"),
            ("1e999 s", "not a number"),
            ("", "not a number"),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(said) && message.contains("rad/s"), "{message}");
        }
    }
}
