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
        "the output folder {} is not empty: its results would be mixed with others; choose another, or ask for files of the same names to be \
         replaced",
        .0.display()
    )]
    NotEmpty(PathBuf),
    /// The file is there already.
    #[error("{} is there already; choose another file, or ask for it to be replaced", .0.display())]
    Exists(PathBuf),
    /// A folder was named where a file is written.
    #[error("{} is a folder; expected a file, as in friction.csv, or - for standard output", .0.display())]
    IsFolder(PathBuf),
    /// Something else was named where a folder is made.
    #[error("{} is no folder; name another place", .0.display())]
    NoFolder(PathBuf),
}

impl OutputError {
    /// Whether whoever named the place can mend it by naming another. A full disk is a failure of
    /// the work itself.
    #[must_use]
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Write { source, .. } => is_of_the_path(source),
            Self::NotEmpty(_) | Self::Exists(_) | Self::IsFolder(_) | Self::NoFolder(_) => true,
        }
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

/// Whether what the system says is about the path that was named: nothing is there, it may not be
/// used, it is something else. Whoever named it can name another. A full disk, a device that fails
/// or memory that ran out are the machine's.
#[must_use]
pub fn is_of_the_path(error: &io::Error) -> bool {
    match error.kind() {
        ErrorKind::NotFound
        | ErrorKind::PermissionDenied
        | ErrorKind::AlreadyExists
        | ErrorKind::InvalidInput
        | ErrorKind::InvalidData
        | ErrorKind::InvalidFilename
        | ErrorKind::NotADirectory
        | ErrorKind::IsADirectory
        | ErrorKind::DirectoryNotEmpty
        | ErrorKind::ReadOnlyFilesystem
        | ErrorKind::CrossesDevices
        | ErrorKind::TooManyLinks
        | ErrorKind::NotSeekable
        | ErrorKind::Unsupported => true,
        // Of a file to be read this program says so; the system says it of one that is written.
        ErrorKind::FileTooLarge => error.raw_os_error().is_none(),
        _ => false,
    }
}

/// What the system says, without the names of what stands between.
#[must_use]
pub fn said(source: &(dyn Error + 'static)) -> String {
    if is_full(source) { "no space left on device".to_owned() } else { source.to_string() }
}

fn mend(source: &io::Error) -> &'static str {
    match source.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "; make room and start again",
        _ if is_of_the_path(source) => "; choose another place",
        _ => "",
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
        assert!(!is_full(&denied) && denied.is_bad_input());
        assert!(denied.to_string().ends_with("choose another place"), "{denied}");
    }

    #[test]
    fn a_path_can_be_mended_by_its_user_and_a_machine_cannot() {
        for kind in [ErrorKind::NotFound, ErrorKind::IsADirectory, ErrorKind::ReadOnlyFilesystem] {
            assert!(is_of_the_path(&kind.into()), "{kind}");
        }
        for kind in [ErrorKind::StorageFull, ErrorKind::QuotaExceeded, ErrorKind::OutOfMemory] {
            assert!(!is_of_the_path(&kind.into()), "{kind}");
        }
        assert!(is_of_the_path(&io::Error::new(ErrorKind::FileTooLarge, "above 1 MiB")));
        #[cfg(target_os = "linux")]
        for (number, what) in [(5, "EIO"), (27, "EFBIG"), (28, "ENOSPC"), (122, "EDQUOT")] {
            assert!(!is_of_the_path(&io::Error::from_raw_os_error(number)), "{what}");
        }
    }
}
