//! What a parameter is: name, type, default, description, range.

use std::mem::discriminant;

use crate::{ParameterError, ParameterValue, ValueRange};

/// Longest text that a parameter takes \[bytes\].
const LONGEST: usize = 4096;
/// Longest piece of a text that is refused, as it is said back, in characters.
const QUOTED: usize = 80;

/// A parameter as a node declares it.
#[derive(Debug, Clone, PartialEq)]
pub struct Declaration {
    name: String,
    default: ParameterValue,
    description: String,
    constraints: String,
    range: ValueRange,
    choices: Vec<String>,
    read_only: bool,
}

impl Declaration {
    /// A parameter of the type of its default. The description says what it is, with the unit in
    /// brackets.
    pub fn new(
        name: impl Into<String>,
        default: ParameterValue,
        description: impl Into<String>,
    ) -> Self {
        Self {
            name: name.into(),
            default,
            description: description.into(),
            constraints: String::new(),
            range: ValueRange::Any,
            choices: Vec::new(),
            read_only: false,
        }
    }

    /// A real number.
    pub fn double(name: impl Into<String>, default: f64, description: impl Into<String>) -> Self {
        Self::new(name, ParameterValue::Double(default), description)
    }

    /// A whole number.
    pub fn integer(name: impl Into<String>, default: i64, description: impl Into<String>) -> Self {
        Self::new(name, ParameterValue::Integer(default), description)
    }

    /// Yes or no.
    pub fn boolean(name: impl Into<String>, default: bool, description: impl Into<String>) -> Self {
        Self::new(name, ParameterValue::Boolean(default), description)
    }

    /// A text.
    pub fn text(
        name: impl Into<String>,
        default: impl Into<String>,
        description: impl Into<String>,
    ) -> Self {
        Self::new(name, ParameterValue::String(default.into()), description)
    }

    /// Only within these bounds, both allowed.
    #[must_use]
    pub fn range(mut self, range: ValueRange) -> Self {
        self.range = range;
        self
    }

    /// Only one of these texts.
    #[must_use]
    pub fn choices<S: AsRef<str>>(mut self, choices: impl IntoIterator<Item = S>) -> Self {
        self.choices = choices.into_iter().map(|choice| choice.as_ref().to_owned()).collect();
        self.constraints = format!("one of {}", self.choices.join(", "));
        self
    }

    /// What else it must satisfy, in words.
    #[must_use]
    pub fn constraint(mut self, words: impl Into<String>) -> Self {
        self.constraints = words.into();
        self
    }

    /// Only when the program starts.
    #[must_use]
    pub const fn read_only(mut self) -> Self {
        self.read_only = true;
        self
    }

    /// The name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The default.
    #[must_use]
    pub const fn default_value(&self) -> &ParameterValue {
        &self.default
    }

    /// What it is.
    #[must_use]
    pub fn description(&self) -> &str {
        &self.description
    }

    /// Range and constraints in words; empty if there are none.
    #[must_use]
    pub fn allowed(&self) -> String {
        let range = self.range.to_string();
        match (range.is_empty(), self.constraints.is_empty()) {
            (_, true) => range,
            (true, false) => self.constraints.clone(),
            (false, false) => format!("{range}; {}", self.constraints),
        }
    }

    /// What else it must satisfy, in words; empty if there is nothing.
    #[must_use]
    pub fn constraints(&self) -> &str {
        &self.constraints
    }

    /// The range of its numbers.
    #[must_use]
    pub const fn value_range(&self) -> ValueRange {
        self.range
    }

    /// Whether it is set when the program starts only.
    #[must_use]
    pub const fn is_read_only(&self) -> bool {
        self.read_only
    }

    /// The value as this parameter takes it.
    ///
    /// # Errors
    /// [`ParameterError`] if it does not.
    pub fn accept(&self, value: &ParameterValue) -> Result<ParameterValue, ParameterError> {
        use ParameterValue as V;
        let name = || self.name.clone();
        let value = match (&self.default, value) {
            // An empty list has no type of its own.
            (
                V::DoubleArray(_) | V::IntegerArray(_) | V::BooleanArray(_),
                V::StringArray(empty),
            ) if empty.is_empty() => emptied(&self.default),
            _ => value.clone(),
        };
        if value == V::NotSet {
            return Err(ParameterError::Deleted { name: name() });
        }
        if discriminant(&value) != discriminant(&self.default) {
            let hint = match (&self.default, &value) {
                (V::Double(_), V::Integer(n)) => format!(": write {n}.0"),
                (V::String(_), _) => ": put it in quotes".to_owned(),
                _ => String::new(),
            };
            let (expected, came) = (self.default.kind(), value.kind());
            return Err(ParameterError::WrongType { name: name(), expected, came, hint });
        }
        let outside = |came: String| {
            let expected = match (self.range, self.choices.is_empty()) {
                (ValueRange::Any, true) => "a finite number".to_owned(),
                (ValueRange::Any, false) => self.constraints.clone(),
                _ => self.allowed(),
            };
            Err(ParameterError::OutOfRange { name: name(), expected, came })
        };
        match &value {
            V::Double(x) if !self.range.holds(*x) => outside(x.to_string()),
            V::Integer(n) if !self.range.holds_integer(*n) => outside(n.to_string()),
            V::DoubleArray(all) => match all.iter().find(|x| !self.range.holds(**x)) {
                Some(x) => outside(format!("{x} in one place")),
                None => Ok(value),
            },
            V::String(text) if !self.choices.is_empty() && !self.choices.contains(text) => {
                let cut = match text.char_indices().nth(QUOTED) {
                    Some((end, _)) => format!("{}... ({} bytes)", &text[..end], text.len()),
                    None => text.clone(),
                };
                outside(format!("`{cut}`"))
            }
            V::String(text) if text.len() > LONGEST => {
                Err(ParameterError::TooLong { name: name(), most: LONGEST, came: text.len() })
            }
            _ => Ok(value),
        }
    }
}

fn emptied(like: &ParameterValue) -> ParameterValue {
    match like {
        ParameterValue::DoubleArray(_) => ParameterValue::DoubleArray(Vec::new()),
        ParameterValue::IntegerArray(_) => ParameterValue::IntegerArray(Vec::new()),
        _ => ParameterValue::BooleanArray(Vec::new()),
    }
}
