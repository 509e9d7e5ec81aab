//! The values of a node's parameters, as a whole.

use std::collections::BTreeMap;

use ros2_client::ParameterValue;

/// Values by name. Every declared parameter is among them, with a value of its declared type.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Values(pub(super) BTreeMap<String, ParameterValue>);

impl Values {
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
