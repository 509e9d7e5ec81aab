//! The values of a node's parameters, as a whole.

use std::collections::BTreeMap;

use crate::{Declaration, ParameterError, ParameterValue};

/// Values by name. Every declared parameter is among them, with a value of its declared type.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Values(BTreeMap<String, ParameterValue>);

impl From<Values> for BTreeMap<String, ParameterValue> {
    fn from(values: Values) -> Self {
        values.0
    }
}

impl Values {
    /// The defaults of what is declared.
    #[must_use]
    pub fn defaults(declared: &[Declaration]) -> Self {
        let default = |one: &Declaration| (one.name().to_owned(), one.default_value().clone());
        Self(declared.iter().map(default).collect())
    }

    /// The defaults of what is declared, but for what is `given`.
    ///
    /// # Errors
    /// [`ParameterError`] for the first value that is not taken; what nobody declared is left out.
    pub fn given(
        declared: &[Declaration],
        given: &BTreeMap<String, ParameterValue>,
    ) -> Result<Self, ParameterError> {
        let mut values = Self::defaults(declared);
        for one in declared {
            if let Some(value) = given.get(one.name()) {
                values.set(one.name(), one.accept(value)?);
            }
        }
        Ok(values)
    }

    /// Sets a value as it is.
    pub fn set(&mut self, name: impl Into<String>, value: ParameterValue) {
        self.0.insert(name.into(), value);
    }

    /// Each value by its name.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &ParameterValue)> {
        self.0.iter().map(|(name, value)| (name.as_str(), value))
    }

    /// The value, if there is such a parameter.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&ParameterValue> {
        self.0.get(name)
    }

    /// A real number; not a number if there is no such parameter.
    #[must_use]
    pub fn double(&self, name: &str) -> f64 {
        match self.0.get(name) {
            Some(ParameterValue::Double(value)) => *value,
            _ => f64::NAN,
        }
    }

    /// A whole number; zero if there is no such parameter.
    #[must_use]
    pub fn integer(&self, name: &str) -> i64 {
        match self.0.get(name) {
            Some(ParameterValue::Integer(value)) => *value,
            _ => 0,
        }
    }

    /// Yes or no; no if there is no such parameter.
    #[must_use]
    pub fn boolean(&self, name: &str) -> bool {
        matches!(self.0.get(name), Some(ParameterValue::Boolean(true)))
    }

    /// A text; empty if there is no such parameter.
    #[must_use]
    pub fn text(&self, name: &str) -> &str {
        match self.0.get(name) {
            Some(ParameterValue::String(value)) => value,
            _ => "",
        }
    }

    /// Real numbers; none if there is no such parameter.
    #[must_use]
    pub fn doubles(&self, name: &str) -> &[f64] {
        match self.0.get(name) {
            Some(ParameterValue::DoubleArray(value)) => value,
            _ => &[],
        }
    }
}
