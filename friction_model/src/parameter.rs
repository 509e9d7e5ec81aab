//! Parameters: their names, units and ranges in one table per model, and the checks that every set
//! passes before a model exists.

use core::fmt;

use crate::{Elements, ModelError, Real};

/// Unit of a parameter, for a linear axis and for a rotary one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "snake_case"))]
pub enum Unit {
    /// N or N m
    Force,
    /// N/m or N m/rad
    Stiffness,
    /// N s/m or N m s/rad
    Damping,
    /// m or rad
    Deflection,
    /// m/s or rad/s
    Speed,
    /// s/m or s/rad
    PerSpeed,
    /// m/s^2 or rad/s^2
    Acceleration,
    /// N/s or N m/s
    ForceRate,
    /// s
    Time,
    /// A pure number
    None,
}

impl Unit {
    /// The unit on a linear axis; empty for a pure number.
    #[must_use]
    pub const fn linear(self) -> &'static str {
        match self {
            Self::Force => "N",
            Self::Stiffness => "N/m",
            Self::Damping => "N s/m",
            Self::Deflection => "m",
            Self::Speed => "m/s",
            Self::PerSpeed => "s/m",
            Self::Acceleration => "m/s^2",
            Self::ForceRate => "N/s",
            Self::Time => "s",
            Self::None => "",
        }
    }

    /// The unit on a rotary axis; empty for a pure number.
    #[must_use]
    pub const fn rotary(self) -> &'static str {
        match self {
            Self::Force => "N m",
            Self::Stiffness => "N m/rad",
            Self::Damping => "N m s/rad",
            Self::Deflection => "rad",
            Self::Speed => "rad/s",
            Self::PerSpeed => "s/rad",
            Self::Acceleration => "rad/s^2",
            Self::ForceRate => "N m/s",
            Self::Time => "s",
            Self::None => "",
        }
    }
}

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

/// One row of a model's parameter table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Name in files.
    pub name: &'static str,
    /// What it is, in a sentence; with its unit in brackets.
    pub meaning: &'static str,
    /// Its unit.
    pub unit: Unit,
    /// What each of its values must satisfy; conditions between parameters are checked when the
    /// model is built.
    pub range: Range,
    /// Whether a file may leave it out.
    pub optional: bool,
}

/// What a parameter's field can hold: one number, a list with one number an element, or a whole
/// number.
pub trait Value {
    /// Calls `f` with every number.
    fn each(&self, f: &mut dyn FnMut(f64));

    /// Multiplies every number by `factor`. Whole numbers are rounded.
    fn scale(&mut self, factor: f64);

    /// Becomes `value`; false for a list, which one number does not determine.
    fn set(&mut self, value: f64) -> bool;

    /// The number at `index` becomes `value`; false if there is none. A parameter that is no list
    /// has the index 0 only.
    fn set_at(&mut self, index: usize, value: f64) -> bool {
        index == 0 && self.set(value)
    }
}

macro_rules! number {
    ($($number:ty),+) => {
        $(
            impl Value for $number {
                fn each(&self, f: &mut dyn FnMut(f64)) {
                    f(self.double());
                }
                fn scale(&mut self, factor: f64) {
                    *self = Self::of(self.double() * factor);
                }
                fn set(&mut self, value: f64) -> bool {
                    *self = Self::of(value);
                    true
                }
            }
        )+
    };
}

number!(f32, f64);

impl<T: Real> Value for Option<T> {
    fn each(&self, f: &mut dyn FnMut(f64)) {
        if let Some(value) = self {
            f(value.double());
        }
    }
    fn scale(&mut self, factor: f64) {
        if let Some(value) = self {
            value.scale(factor);
        }
    }
    fn set(&mut self, value: f64) -> bool {
        *self = Some(T::of(value));
        true
    }
}

impl<const CAPACITY: usize, T: Real> Value for Elements<CAPACITY, T> {
    fn each(&self, f: &mut dyn FnMut(f64)) {
        self.iter().for_each(|value| f(value.double()));
    }
    fn scale(&mut self, factor: f64) {
        self.iter_mut().for_each(|value| value.scale(factor));
    }
    fn set(&mut self, _: f64) -> bool {
        false
    }
    fn set_at(&mut self, index: usize, value: f64) -> bool {
        self.get_mut(index).map(|place| *place = T::of(value)).is_some()
    }
}

impl Value for u32 {
    fn each(&self, f: &mut dyn FnMut(f64)) {
        f(f64::from(*self));
    }
    fn scale(&mut self, factor: f64) {
        // A float becomes a whole number by saturation: nothing overflows.
        *self = (f64::from(*self) * factor + 0.5) as u32;
    }
    fn set(&mut self, value: f64) -> bool {
        *self = (value + 0.5) as u32;
        true
    }
}

/// The parameters of a model as files carry them: plain numbers, not yet checked against each
/// other.
pub trait ParameterSet: Clone + fmt::Debug + PartialEq {
    /// One row a field, in the order of the fields.
    const TABLE: &'static [Parameter];

    /// Calls `f` with every number of the parameter `name`; not at all if there is none of that
    /// name.
    fn each(&self, name: &str, f: &mut dyn FnMut(f64));

    /// Multiplies the parameter `name` by `factor`; false if there is none of that name.
    fn scale(&mut self, name: &str, factor: f64) -> bool;

    /// Sets the parameter `name` to `value`; false if there is none of that name, or if it is a
    /// list.
    fn set(&mut self, name: &str, value: f64) -> bool;

    /// Sets the number at `index` of the parameter `name` to `value`; false if there is none.
    fn set_at(&mut self, name: &str, index: usize, value: f64) -> bool;

    /// Checks every number against its range.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for the first that lies outside.
    fn check(&self, model: &'static str) -> Result<(), ModelError> {
        let mut outcome = Ok(());
        for row in Self::TABLE {
            self.each(row.name, &mut |value| {
                if outcome.is_ok() && !row.range.holds(value) {
                    outcome = Err(row.refusal(model, value, row.range));
                }
            });
        }
        outcome
    }

    /// Checks a condition between parameters: an error naming `parameter` unless `holds`.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`].
    fn require<T: Real>(
        &self,
        model: &'static str,
        holds: bool,
        parameter: &'static str,
        value: T,
        condition: &'static str,
    ) -> Result<(), ModelError> {
        if holds {
            return Ok(());
        }
        let unit =
            Self::TABLE.iter().find(|row| row.name == parameter).map_or(Unit::None, |row| row.unit);
        Err(ModelError::OutOfRange {
            model,
            parameter,
            value: value.double(),
            unit,
            expected: Range::Such(condition),
        })
    }
}

impl Parameter {
    fn refusal(&self, model: &'static str, value: f64, expected: Range) -> ModelError {
        ModelError::OutOfRange { model, parameter: self.name, value, unit: self.unit, expected }
    }
}
