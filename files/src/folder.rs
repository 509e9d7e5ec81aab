//! A folder for the results of one command.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use super::{OutputError, first_missing, remove_empty, write_all};
use crate::durable;

/// How often the folder of runs may vanish while a folder is made in it.
const VANISHES: u32 = 1000;

/// A folder for the results of one command. It is there from the start, so that a folder that
/// cannot be written is told before the work and not after it, and is removed when nothing was
/// written.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    /// The topmost folder that was made for it.
    made: Option<PathBuf>,
}

impl Folder {
    /// The folder `given`, which must be new or empty unless `force`; without one a new folder
    /// `NAME-N` in `runs` with the first free N. Programs that start at once get one each.
    ///
    /// # Errors
    /// [`OutputError`] if it holds something or cannot be written. Nothing is made then.
    pub fn reserve(
        given: Option<&Path>,
        runs: &Path,
        name: &str,
        force: bool,
    ) -> Result<Self, OutputError> {
        let folder = match given {
            Some(path) => Self::given(path, force)?,
            None => Self::numbered(runs, name)?,
        };
        folder
            .probe()
            .map_err(|source| OutputError::Write { path: folder.path.clone(), source })?;
        Ok(folder)
    }

    fn given(path: &Path, force: bool) -> Result<Self, OutputError> {
        if path.symlink_metadata().is_ok() && !path.is_dir() {
            return Err(OutputError::NoFolder(path.to_owned()));
        }
        let fail = |source| OutputError::Write { path: path.to_owned(), source };
        if !force && !is_empty_or_missing(path).map_err(fail)? {
            return Err(OutputError::NotEmpty(path.to_owned()));
        }
        let made = first_missing(path);
        fs::create_dir_all(path).map_err(|source| {
            made.iter().for_each(|top| remove_empty(path, top));
            fail(source)
        })?;
        Ok(Self { path: path.to_owned(), made })
    }

    /// Makes `NAME-N`: whoever makes the folder has it, so that no two ever get the same.
    fn numbered(runs: &Path, name: &str) -> Result<Self, OutputError> {
        let fail = |source| OutputError::Write { path: runs.to_owned(), source };
        let mut number: u64 = 1;
        // Another program may remove the folder of runs, which it made in vain, between any two steps,
        // also those within `create_dir_all`.
        let mut vanished = 0;
        loop {
            let top = first_missing(runs);
            match fs::create_dir_all(runs) {
                Ok(()) => {}
                Err(error)
                    if matches!(error.kind(), ErrorKind::AlreadyExists | ErrorKind::NotFound)
                        && vanished < VANISHES
                        && runs.symlink_metadata().map_or(true, |found| found.is_dir()) =>
                {
                    vanished += 1;
                    continue;
                }
                Err(source) => return Err(fail(source)),
            }
            let path = runs.join(format!("{name}-{number}"));
            match fs::create_dir(&path) {
                Ok(()) => {
                    let made = Some(top.unwrap_or_else(|| path.clone()));
                    return Ok(Self { path, made });
                }
                Err(error) if error.kind() == ErrorKind::AlreadyExists => number += 1,
                Err(error) if error.kind() == ErrorKind::NotFound && vanished < VANISHES => {
                    vanished += 1
                }
                Err(source) => return Err(OutputError::Write { path, source }),
            }
        }
    }

    /// A folder can be there and still take no file.
    fn probe(&self) -> io::Result<()> {
        let probe = durable::draft(&self.path.join("probe"));
        fs::write(&probe, "")?;
        fs::remove_file(&probe)
    }

    /// The folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The folder, which stays even if nothing is written into it.
    #[must_use]
    pub fn into_path(mut self) -> PathBuf {
        self.made = None;
        std::mem::take(&mut self.path)
    }

    /// The path of a file in it.
    #[must_use]
    pub fn join(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Writes the files (name, content), all of them or none.
    ///
    /// # Errors
    /// [`OutputError`] with the file that failed.
    pub fn write(&self, files: &[(&str, String)]) -> Result<(), OutputError> {
        write_all(&self.path, files)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        if let Some(top) = &self.made {
            // A folder with something in it stays.
            remove_empty(&self.path, top);
        }
    }
}

/// Whether nothing is in a folder, or it is not there.
///
/// # Errors
/// What the system says of a folder that cannot be looked into.
pub fn is_empty_or_missing(folder: &Path) -> io::Result<bool> {
    match fs::read_dir(folder) {
        Ok(mut entries) => Ok(entries.next().is_none()),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(true),
        Err(error) => Err(error),
    }
}

/// The first name `NAME-N` in `runs` that is free, for a program that makes the folder itself.
#[must_use]
pub fn first_free(runs: &Path, name: &str) -> PathBuf {
    let candidate = |n: u64| runs.join(format!("{name}-{n}"));
    (1..).map(candidate).find(|folder| !folder.exists()).unwrap_or_else(|| candidate(0))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::sync::Barrier;
    use std::thread;

    use super::*;

    #[test]
    fn eleven_that_start_at_once_get_a_folder_each() {
        let root = tempfile::tempdir().unwrap();
        let runs = root.path().join("runs");
        let (start, end) = (Barrier::new(11), Barrier::new(11));
        let one = || {
            start.wait();
            let folder = Folder::reserve(None, &runs, "all", false).unwrap();
            folder.write(&[("run.json", "{}".to_owned())]).unwrap();
            end.wait();
            folder.path().to_owned()
        };
        let folders: BTreeSet<PathBuf> = thread::scope(|scope| {
            let all: Vec<_> = (0..11).map(|_| scope.spawn(one)).collect();
            all.into_iter().map(|thread| thread.join().unwrap()).collect()
        });
        let expected: BTreeSet<PathBuf> = (1..=11).map(|n| runs.join(format!("all-{n}"))).collect();
        assert_eq!(folders, expected);
    }

    #[test]
    fn eleven_that_leave_nothing_do_not_take_the_folder_of_runs_from_each_other() {
        let root = tempfile::tempdir().unwrap();
        let runs = root.path().join("runs");
        thread::scope(|scope| {
            for _ in 0..11 {
                scope.spawn(|| {
                    for _ in 0..50 {
                        drop(Folder::reserve(None, &runs, "all", false).unwrap());
                    }
                });
            }
        });
        assert!(is_empty_or_missing(&runs).unwrap(), "what was made in vain is gone");
    }

    #[test]
    fn a_folder_that_was_named_is_new_or_empty_unless_forced() {
        let root = tempfile::tempdir().unwrap();
        let reserve =
            |path: &Path, force| Folder::reserve(Some(path), Path::new("unused"), "unused", force);
        let out = root.path().join("deep/out");
        drop(reserve(&out, false).unwrap());
        assert!(!root.path().join("deep").exists(), "nothing was written into it");
        let folder = reserve(&out, false).unwrap();
        folder.write(&[("report.html", "one".to_owned())]).unwrap();
        drop(folder);
        let error = reserve(&out, false).unwrap_err();
        assert!(
            matches!(error, OutputError::NotEmpty(_)) && error.to_string().contains("replaced"),
            "{error}"
        );
        reserve(&out, true).unwrap().write(&[("report.html", "two".to_owned())]).unwrap();
        assert_eq!(fs::read_to_string(out.join("report.html")).unwrap(), "two");
        let error = reserve(&out.join("report.html"), true).unwrap_err();
        assert!(matches!(error, OutputError::NoFolder(_)), "{error}");
        assert!(reserve(&out.join("report.html/below"), false).is_err());
    }
}
