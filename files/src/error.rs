//! What is wrong with a place for results.

use std::error::Error;
use std::io::{self, ErrorKind};
use std::path::PathBuf;

/// Results that could not be written, or may not be.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OutputError {
    /// A folder or file cannot be made or written.
    #[error("{} cannot be written: {}{}", path.display(), said(source), mend(source))]
    Write {
        /// The folder or file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The folder holds something already.
    #[error(
        "the output folder {} is not empty: its results would be mixed with others; choose another with --out DIR, or say --force \
         to write into it and replace files of the same names",
        .0.display()
    )]
    NotEmpty(PathBuf),
    /// The file is there already.
    #[error("{} is there already; choose another file with --out FILE, or say --force to replace it", .0.display())]
    Exists(PathBuf),
    /// A folder was named where a file is written.
    #[error("{} is a folder; --out must name a file, as in friction.csv, or - for standard output", .0.display())]
    IsFolder(PathBuf),
    /// Something else was named where a folder is made.
    #[error("{} is no folder; name another with --out DIR", .0.display())]
    NoFolder(PathBuf),
}

impl OutputError {
    /// Whether whoever started the program can mend it by naming another place. A full disk is a
    /// failure of the work itself.
    #[must_use]
    pub fn is_bad_input(&self) -> bool {
        !is_full(self)
    }

    /// What the system says, where the system refused.
    #[must_use]
    pub const fn system(&self) -> Option<&io::Error> {
        match self {
            Self::Write { source, .. } => Some(source),
            _ => None,
        }
    }
}

/// Whether no space on a disk, or a used up quota, is behind an error.
#[must_use]
pub fn is_full(error: &(dyn Error + 'static)) -> bool {
    let full = |error: &io::Error| {
        matches!(error.kind(), ErrorKind::StorageFull | ErrorKind::QuotaExceeded)
    };
    let mut next = Some(error);
    while let Some(error) = next {
        if error.downcast_ref::<io::Error>().is_some_and(full) {
            return true;
        }
        // What an `io::Error` wraps is left out by its `source`, which goes to the wrapped one's
        // source at once.
        let wrapped = error.downcast_ref::<io::Error>().and_then(io::Error::get_ref);
        next = match wrapped {
            Some(wrapped) => Some(wrapped),
            None => error.source(),
        };
    }
    false
}

/// What the system says, without the names of what stands between.
#[must_use]
pub fn said(source: &(dyn Error + 'static)) -> String {
    if is_full(source) { "no space left on device".to_owned() } else { source.to_string() }
}

fn mend(source: &io::Error) -> &'static str {
    match source.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "; make room and start again",
        _ => "; choose another place with --out",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_disk_is_found_behind_other_errors() {
        let full = || io::Error::from(ErrorKind::StorageFull);
        let direct = OutputError::Write { path: "runs/a/report.html".into(), source: full() };
        assert_eq!(
            direct.to_string(),
            "runs/a/report.html cannot be written: no space left on device; make room and start again"
        );
        assert!(is_full(&direct) && !direct.is_bad_input());
        assert!(is_full(&io::Error::other(full())));
        let quota =
            OutputError::Write { path: "x".into(), source: ErrorKind::QuotaExceeded.into() };
        assert!(is_full(&quota));
        let denied =
            OutputError::Write { path: "x".into(), source: ErrorKind::PermissionDenied.into() };
        assert!(!is_full(&denied) && denied.is_bad_input() && denied.to_string().contains("--out"));
    }
}
