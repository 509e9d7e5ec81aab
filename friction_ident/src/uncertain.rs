//! A number and how sure it is.

use serde::{Deserialize, Serialize};

/// A number and its standard error, in the same unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Uncertain {
    /// Best value.
    pub value: f64,
    /// Standard error, zero or more.
    pub standard_error: f64,
}

impl Uncertain {
    /// A value known to a fraction of itself.
    #[must_use]
    pub fn relative(value: f64, fraction: f64) -> Self {
        Self { value, standard_error: value.abs() * fraction }
    }

    /// A number without error.
    #[must_use]
    pub const fn exact(value: f64) -> Self {
        Self { value, standard_error: 0.0 }
    }
}
