//! What can be wrong with a protocol.

use std::fmt::Display;

/// A protocol that cannot be driven. The text says what was expected, what came and how to mend it.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ProtocolError {
    /// The text is no such protocol: not YAML, a key missing, unknown or of another kind.
    #[error("{detail}; `frictionlab protocols {name}` prints one to start from")]
    Form {
        /// What the reader says, with line and column.
        detail: String,
        /// The protocol that is nearest.
        name: &'static str,
    },
    /// An experiment that there is not.
    #[error("there is no experiment `{name}` that takes a protocol; expected one of {known}")]
    Unknown {
        /// What came.
        name: String,
        /// Those that there are.
        known: String,
    },
    /// An experiment that takes no protocol file.
    #[error("the experiment {name} takes no protocol; its options are those of `run`")]
    None {
        /// The experiment.
        name: &'static str,
    },
    /// A value that cannot be.
    #[error("`{key}` must be {expected}, but is {found}; change it there")]
    Value {
        /// Path of the key.
        key: String,
        /// What came.
        found: String,
        /// What was expected.
        expected: String,
    },
}

impl ProtocolError {
    /// A value that cannot be.
    pub(super) fn new(
        key: impl Into<String>,
        found: impl Display,
        expected: impl Into<String>,
    ) -> Self {
        Self::Value { key: key.into(), found: found.to_string(), expected: expected.into() }
    }
}
