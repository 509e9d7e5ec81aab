//! Errors as exceptions, with the sentences of the command.

use experiment_runner::models::file::ModelFileError;
use files::OutputError;
use identification::asked::mending::mending;
use pyo3::prelude::*;
use pyo3::types::PyType;
use recording::RecordingError;
use recording::bag::BagError;
use work::{BadInput, Interrupted};

/// Which exception of `frictionlab.errors` it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Whoever called can mend it.
    BadInput,
    /// The machine failed, or this program.
    Failure,
}

impl Kind {
    const fn name(self) -> &'static str {
        match self {
            Self::BadInput => "BadInput",
            Self::Failure => "Failure",
        }
    }
}

/// The exception of an error, with what mends it behind the sentence.
pub fn exception(py: Python<'_>, error: &anyhow::Error) -> PyErr {
    let text = work::ending::told(error) + &mending(error).unwrap_or_default();
    let says_so = error.is::<BadInput>()
        || error.is::<Interrupted>()
        || error.is::<ModelFileError>()
        || error.downcast_ref().is_some_and(RecordingError::is_bad_input)
        || error.downcast_ref().is_some_and(OutputError::is_bad_input)
        || error.downcast_ref().is_some_and(BagError::is_bad_input);
    raise(py, if says_so { Kind::BadInput } else { Kind::Failure }, text)
}

/// The exception of an input that cannot be used.
pub fn bad_input(py: Python<'_>, text: impl Into<String>) -> PyErr {
    raise(py, Kind::BadInput, text.into())
}

/// The exception of a mistake of this program.
pub fn mistake(py: Python<'_>, what: &str) -> PyErr {
    let text = format!("frictionlab made a mistake: {what}; please report it with what was called");
    raise(py, Kind::Failure, text)
}

fn raise(py: Python<'_>, kind: Kind, text: String) -> PyErr {
    let class = || -> PyResult<Bound<'_, PyType>> {
        Ok(py.import("frictionlab.errors")?.getattr(kind.name())?.cast_into::<PyType>()?)
    };
    match class() {
        Ok(class) => PyErr::from_type(class, text),
        Err(error) => error,
    }
}
