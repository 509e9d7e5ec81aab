//! How work ends other than well.

use files::is_full;

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

/// What a person is told of an error: each cause once, and of a full disk nothing but that it is
/// full.
#[must_use]
pub fn told(error: &anyhow::Error) -> String {
    let mut text = error.to_string();
    if !is_full(error.as_ref()) {
        for cause in error.chain().skip(1).map(ToString::to_string) {
            if !text.contains(&cause) {
                text = format!("{text}: {cause}");
            }
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use std::io::{Error, ErrorKind};

    use files::OutputError;

    use super::*;

    #[test]
    fn each_cause_is_told_once_and_of_a_full_disk_that_it_is_full() {
        let wrapped = anyhow::anyhow!("inner").context("outer");
        assert_eq!(told(&wrapped), "outer: inner");
        for (kind, said) in [
            (ErrorKind::StorageFull, "no space left"),
            (ErrorKind::PermissionDenied, "permission denied"),
        ] {
            let error = OutputError::Write { path: "a.csv".into(), source: Error::from(kind) };
            let told = told(&error.into());
            assert_eq!(told.matches(said).count(), 1, "{told}");
        }
    }
}
