//! What a parameter is: name, type, default, description, range.

use crate::limits::{TEXT, quoted};
use ros2_client::{
    ParameterValue,
    parameters::{NumericRange, ParameterDescriptor, raw},
};

/// Values that a number may take.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum ValueRange {
    /// All of its type.
    #[default]
    Any,
    /// From the first to the second, both allowed.
    Double(f64, f64),
    /// From the first to the second, both allowed.
    Integer(i64, i64),
}

/// A parameter as a node declares it.
#[derive(Debug, Clone, PartialEq)]
pub struct Declaration {
    pub(super) name: String,
    pub(super) default: ParameterValue,
    pub(super) description: String,
    pub(super) constraints: String,
    pub(super) range: ValueRange,
    pub(super) choices: Vec<String>,
    pub(super) read_only: bool,
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
        let range = match self.range {
            ValueRange::Any => String::new(),
            ValueRange::Double(low, high) if low == f64::MIN_POSITIVE && high == f64::MAX => {
                "above 0".to_owned()
            }
            ValueRange::Double(low, high) if high == f64::MAX => format!("at least {low}"),
            ValueRange::Double(low, high) => format!("{low} to {high}"),
            ValueRange::Integer(low, high) => format!("{low} to {high}"),
        };
        match (range.is_empty(), self.constraints.is_empty()) {
            (_, true) => range,
            (true, false) => self.constraints.clone(),
            (false, false) => format!("{range}; {}", self.constraints),
        }
    }

    /// The value as this parameter takes it, or why it does not.
    ///
    /// # Errors
    /// A sentence: what was expected, what came, how to mend it.
    pub(super) fn accept(&self, value: &ParameterValue) -> Result<ParameterValue, String> {
        let name = &self.name;
        let value = match (&self.default, value) {
            // An empty list has no type of its own.
            (
                ParameterValue::DoubleArray(_)
                | ParameterValue::IntegerArray(_)
                | ParameterValue::BooleanArray(_),
                ParameterValue::StringArray(empty),
            ) if empty.is_empty() => emptied(&self.default),
            _ => value.clone(),
        };
        if *value_kind(&value) == *"not set" {
            return Err(format!(
                "parameter '{name}' is declared and cannot be deleted; set it to another value"
            ));
        }
        if value.to_parameter_type() != self.default.to_parameter_type() {
            let (is, came) = (value_kind(&self.default), value_kind(&value));
            let hint = match (&self.default, &value) {
                (ParameterValue::Double(_), ParameterValue::Integer(n)) => format!(": write {n}.0"),
                (ParameterValue::String(_), _) => ": put it in quotes".to_owned(),
                _ => String::new(),
            };
            return Err(format!(
                "Wrong parameter type, parameter {{{name}}} is of type {{{is}}}, setting it to {{{came}}} is not allowed{hint}"
            ));
        }
        match (&value, self.range) {
            (ParameterValue::Double(x), ValueRange::Double(low, high))
                if !(low..=high).contains(x) =>
            {
                return Err(format!("{name} must be {}, but is {x}", self.allowed()));
            }
            (ParameterValue::DoubleArray(all), ValueRange::Double(low, high)) => {
                if let Some(x) = all.iter().find(|x| !(low..=high).contains(*x)) {
                    return Err(format!(
                        "each of {name} must be {}, but one is {x}",
                        self.allowed()
                    ));
                }
            }
            (ParameterValue::Double(x), _) if !x.is_finite() => {
                return Err(format!("{name} must be a finite number, but is {x}"));
            }
            (ParameterValue::Integer(n), ValueRange::Integer(low, high))
                if !(low..=high).contains(n) =>
            {
                return Err(format!("{name} must be {}, but is {n}", self.allowed()));
            }
            (ParameterValue::String(text), _)
                if !self.choices.is_empty() && !self.choices.contains(text) =>
            {
                return Err(format!(
                    "{name} must be {}, but is `{}`",
                    self.constraints,
                    quoted(text)
                ));
            }
            (ParameterValue::String(text), _) if text.len() > TEXT => {
                return Err(format!(
                    "{name} must have at most {TEXT} bytes, but has {}",
                    text.len()
                ));
            }
            _ => {}
        }
        Ok(value)
    }

    /// As `describe_parameters` tells it.
    pub(super) fn descriptor(&self) -> raw::ParameterDescriptor {
        ParameterDescriptor {
            name: self.name.clone(),
            param_type: self.default.to_parameter_type(),
            description: self.description.clone(),
            additional_constraints: self.constraints.clone(),
            read_only: self.read_only,
            dynamic_typing: false,
            range: match self.range {
                ValueRange::Any => NumericRange::NotSpecified,
                ValueRange::Double(from_value, to_value) => {
                    NumericRange::FloatingPointRange { from_value, to_value, step: 0.0 }
                }
                ValueRange::Integer(from_value, to_value) => {
                    NumericRange::IntegerRange { from_value, to_value, step: 1 }
                }
            },
        }
        .into()
    }
}

fn emptied(like: &ParameterValue) -> ParameterValue {
    match like {
        ParameterValue::DoubleArray(_) => ParameterValue::DoubleArray(Vec::new()),
        ParameterValue::IntegerArray(_) => ParameterValue::IntegerArray(Vec::new()),
        _ => ParameterValue::BooleanArray(Vec::new()),
    }
}

/// The type's name as rclcpp spells it.
pub(super) fn value_kind(value: &ParameterValue) -> &'static str {
    match value {
        ParameterValue::NotSet => "not set",
        ParameterValue::Boolean(_) => "bool",
        ParameterValue::Integer(_) => "integer",
        ParameterValue::Double(_) => "double",
        ParameterValue::String(_) => "string",
        ParameterValue::ByteArray(_) => "byte_array",
        ParameterValue::BooleanArray(_) => "bool_array",
        ParameterValue::IntegerArray(_) => "integer_array",
        ParameterValue::DoubleArray(_) => "double_array",
        ParameterValue::StringArray(_) => "string_array",
    }
}
