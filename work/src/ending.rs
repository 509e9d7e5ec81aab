//! How work ends other than well.

/// Something a person gave us that cannot be used: a file, a value, a folder. The text says what
/// was expected and how to mend it; the program ends with exit code 2.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct BadInput(pub String);

/// Stopped by the user; the text says what is left. The program ends with 128 plus the number of
/// the signal: 130 after ctrl-C.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Interrupted(pub String);
