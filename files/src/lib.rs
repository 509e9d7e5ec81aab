//! Files in and out: where results go, one rule for every command, and how files are read.
//!
//! A command that writes several files gets a [`Folder`] of its own, numbered under `runs/` unless
//! one is named. A command that writes one file has an [`OutputFile`]. What exists is refused
//! unless it may be replaced, and what is no regular file is never replaced. Files appear whole or
//! not at all, and outlive a power cut.

pub mod durable;
mod error;
mod file;
mod folder;
pub mod input;
pub mod ros_parameters;
mod stream;
mod target;

pub use error::{OutputError, is_full, is_of_the_path, said};
pub use file::OutputFile;
pub use folder::{Folder, first_free, is_empty_or_missing};
pub use stream::Growing;

use std::path::{Path, PathBuf};
use std::{fs, io};

use crate::durable::{Draft, System, sync_made};

/// Writes the files (name, content) into `folder`, which is made if need be.
///
/// Each goes to a temporary name first; only when all are on the disk are they renamed, and when
/// this returns the names are on the disk too. On an error nothing of it stays behind, and files of
/// an earlier run are as they were; a kill or a power cut leaves each file as it was or as it was
/// to be. A file that is replaced keeps its mode; what is no regular file is written through.
///
/// # Errors
/// [`OutputError`] with the path that failed.
pub fn write_all(folder: &Path, files: &[(&str, String)]) -> Result<(), OutputError> {
    let fail = |path: &Path| {
        let path = path.to_owned();
        move |source| OutputError::Write { path, source }
    };
    let made = first_missing(folder);
    let mut drafts = Vec::with_capacity(files.len());
    let mut through = Vec::new();
    let written = fs::create_dir_all(folder).map_err(fail(folder)).and_then(|()| {
        for (name, content) in files {
            let target = folder.join(name);
            if target.is_dir() {
                return Err(fail(&target)(io::Error::from(io::ErrorKind::IsADirectory)));
            }
            if target::is_special(&target) {
                through.push((target, content));
            } else {
                let draft = durable::draft(&target);
                drafts.push(Draft { draft, target, content: content.as_bytes() });
            }
        }
        durable::write(&mut System, folder, &drafts)
            .map_err(|(path, source)| OutputError::Write { path: named(&drafts, path), source })?;
        for (target, content) in &through {
            file::write_through(target, content.as_bytes()).map_err(fail(target))?;
        }
        made.as_ref().map_or(Ok(()), |top| sync_made(folder, top)).map_err(fail(folder))
    });
    if written.is_err() {
        for Draft { draft, .. } in &drafts {
            // A draft that was never made, or was renamed already, is no second error.
            let _ = fs::remove_file(draft);
        }
        if let Some(made) = made {
            remove_empty(folder, &made);
        }
    }
    written
}

/// The file that a person knows, where a draft of it failed.
fn named(drafts: &[Draft<'_>], failed: PathBuf) -> PathBuf {
    drafts.iter().find(|draft| draft.draft == failed).map_or(failed, |draft| draft.target.clone())
}

/// The topmost folder of the path that does not exist yet.
fn first_missing(folder: &Path) -> Option<PathBuf> {
    folder
        .ancestors()
        .take_while(|path| !path.as_os_str().is_empty() && !path.exists())
        .last()
        .map(Path::to_owned)
}

/// Removes the folders from `folder` up to `top`, as far as they are empty.
fn remove_empty(folder: &Path, top: &Path) {
    for path in folder.ancestors() {
        if fs::remove_dir(path).is_err() || path == top {
            break;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn writes_and_replaces() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("a/b");
        for content in ["one", "two"] {
            write_all(&folder, &[("x.json", content.into()), ("y.html", content.into())]).unwrap();
            assert_eq!(fs::read_to_string(folder.join("y.html")).unwrap(), content);
        }
        assert_eq!(names(&folder), ["x.json", "y.html"]);
    }

    #[test]
    fn leaves_nothing_behind() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("out");
        // The second target is a folder: the first file must not appear either.
        fs::create_dir_all(folder.join("y.html")).unwrap();
        let error = write_all(&folder, &[("x.json", String::new()), ("y.html", String::new())])
            .unwrap_err();
        assert!(
            error.to_string().contains("y.html") && error.to_string().contains("another place"),
            "{error}"
        );
        assert_eq!(names(&folder), ["y.html"]);

        fs::write(root.path().join("file"), "").unwrap();
        assert!(write_all(&root.path().join("file/sub"), &[("x", String::new())]).is_err());
        assert_eq!(names(root.path()), ["file", "out"]);

        // A name that cannot be made, in a folder that was not there.
        let fresh = root.path().join("new/deep");
        assert!(write_all(&fresh, &[("no/such", String::new())]).is_err());
        assert_eq!(names(root.path()), ["file", "out"]);
    }
}
