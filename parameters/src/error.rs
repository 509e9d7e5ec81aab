//! Why a value is not taken.

/// Why a parameter does not take a value. The text says what was expected, what came and how to
/// mend it.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// A value lies outside its range.
    #[error("{name} must be {expected}, but is {came}")]
    OutOfRange {
        /// The parameter.
        name: String,
        /// What was expected.
        expected: String,
        /// What came.
        came: String,
    },
    /// A value of another type.
    #[error(
        "Wrong parameter type, parameter {{{name}}} is of type {{{expected}}}, setting it to {{{came}}} is not allowed{hint}"
    )]
    WrongType {
        /// The parameter.
        name: String,
        /// Its type.
        expected: &'static str,
        /// The type that came.
        came: &'static str,
        /// How to write it, behind a colon; empty if there is nothing to say.
        hint: String,
    },
    /// A declared parameter would be deleted.
    #[error("parameter '{name}' is declared and cannot be deleted; set it to another value")]
    Deleted {
        /// The parameter.
        name: String,
    },
    /// A text is too long.
    #[error("{name} must have at most {most} bytes, but has {came}")]
    TooLong {
        /// The parameter.
        name: String,
        /// Bytes allowed.
        most: usize,
        /// Bytes that came.
        came: usize,
    },
    /// Nobody declared a parameter of that name.
    #[error("there is no parameter `{name}`{}", meant(nearest.as_deref()))]
    Unknown {
        /// The name.
        name: String,
        /// The declared name that looks most like it, if any does.
        nearest: Option<String>,
    },
    /// The parameter is set when the program starts only.
    #[error(
        "parameter '{name}' cannot be set because it is read-only; give it when the program starts"
    )]
    ReadOnly {
        /// The parameter.
        name: String,
    },
    /// Whoever judges the values as a whole refuses them.
    #[error("{0}")]
    Refused(String),
}

impl ParameterError {
    /// A refusal with the reason of whoever refuses.
    pub fn refused(reason: impl std::fmt::Display) -> Self {
        Self::Refused(reason.to_string())
    }
}

/// A reason in words is a refusal.
impl From<String> for ParameterError {
    fn from(reason: String) -> Self {
        Self::Refused(reason)
    }
}

fn meant(nearest: Option<&str>) -> String {
    nearest.map(|nearest| format!("; is `{nearest}` meant?")).unwrap_or_default()
}
