//! Files that are whole after a power cut: the old ones or the new ones, never half of one.
//!
//! A file system keeps what is written to it in memory for a while, contents and names apart and in
//! any order. So a draft is written and brought to the disk, takes the place of the file by its
//! name, and then the names are brought to the disk too.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// What a durable file asks of the file system; a test loses power between any two of these.
pub trait Disk {
    /// Writes a file, in memory at least.
    fn write(&mut self, path: &Path, content: &[u8]) -> io::Result<()>;

    /// Brings a file's content to the disk.
    fn sync(&mut self, path: &Path) -> io::Result<()>;

    /// Gives a file the name of another, which it replaces, in memory at least.
    fn rename(&mut self, from: &Path, to: &Path) -> io::Result<()>;

    /// Brings the names in a folder to the disk.
    fn sync_folder(&mut self, folder: &Path) -> io::Result<()>;
}

/// The machine's.
pub struct System;

impl Disk for System {
    fn write(&mut self, path: &Path, content: &[u8]) -> io::Result<()> {
        File::create(path)?.write_all(content)
    }

    fn sync(&mut self, path: &Path) -> io::Result<()> {
        // Writable: some file systems refuse to sync what was opened for reading.
        File::options().append(true).open(path)?.sync_all()
    }

    fn rename(&mut self, from: &Path, to: &Path) -> io::Result<()> {
        // Who may read and write the file stays as it was.
        if let Ok(old) = to.metadata() {
            fs::set_permissions(from, old.permissions())?;
        }
        fs::rename(from, to)
    }

    fn sync_folder(&mut self, folder: &Path) -> io::Result<()> {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        match File::open(folder)?.sync_all() {
            // Some network file systems cannot: there names are as safe as their server makes them.
            Err(error)
                if matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported) =>
            {
                Ok(())
            }
            other => other,
        }
    }
}

/// A file to be written: under the name of the draft first.
#[derive(Debug, Clone)]
pub struct Draft<'a> {
    /// Where it is written; in the folder of the target.
    pub draft: PathBuf,
    /// What it becomes.
    pub target: PathBuf,
    /// What is in it.
    pub content: &'a [u8],
}

/// Writes all files in `folder`: no target changes before all drafts are on the disk.
///
/// # Errors
/// The path that failed, and what the system says; drafts may be left.
pub fn write(
    disk: &mut impl Disk,
    folder: &Path,
    files: &[Draft<'_>],
) -> Result<(), (PathBuf, io::Error)> {
    let fail = |path: &Path| {
        let path = path.to_owned();
        move |error| (path, error)
    };
    for Draft { draft, content, .. } in files {
        disk.write(draft, content).and_then(|()| disk.sync(draft)).map_err(fail(draft))?;
    }
    for Draft { draft, target, .. } in files {
        disk.rename(draft, target).map_err(fail(target))?;
    }
    disk.sync_folder(folder).map_err(fail(folder))
}

/// Writes one file.
///
/// # Errors
/// What the system says; what was there before is there then.
pub fn write_one(path: &Path, content: &[u8]) -> io::Result<()> {
    let draft = draft(path);
    let folder = path.parent().unwrap_or(Path::new(""));
    let files = [Draft { draft: draft.clone(), target: path.to_owned(), content }];
    write(&mut System, folder, &files).map_err(|(_, error)| {
        // A draft that was never made is no second error.
        let _ = fs::remove_file(&draft);
        error
    })
}

/// The name of a draft beside a file.
pub fn draft(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".{name}.{}.tmp", std::process::id()))
}

/// Brings the names of folders to the disk that were made, from `top` down to `folder`.
///
/// # Errors
/// What the system says.
pub fn sync_made(folder: &Path, top: &Path) -> io::Result<()> {
    for path in folder.ancestors() {
        System.sync_folder(path.parent().unwrap_or(Path::new("")))?;
        if path == top {
            break;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    type Names = BTreeMap<PathBuf, usize>;

    /// A disk in memory that loses what was not synced. Contents are known by number, so that a
    /// name can come to the disk without what it names.
    #[derive(Clone, Default)]
    struct Lossy {
        contents: Vec<Vec<u8>>,
        synced: Vec<bool>,
        now: Names,
        /// Every state of the names since they were synced last: any of them may be what the disk
        /// has.
        on_disk: Vec<Names>,
        /// Calls that succeed before the power goes; none for all.
        left: Option<usize>,
    }

    impl Lossy {
        fn with(files: &[(&str, &str)]) -> Self {
            let mut disk = Self { on_disk: vec![Names::new()], ..Self::default() };
            for (name, content) in files {
                disk.write(Path::new(name), content.as_bytes()).unwrap();
                disk.sync(Path::new(name)).unwrap();
            }
            disk.sync_folder(Path::new("")).unwrap();
            disk
        }

        fn step(&mut self) -> io::Result<()> {
            match &mut self.left {
                Some(0) => Err(io::Error::other("no power")),
                Some(left) => {
                    *left -= 1;
                    Ok(())
                }
                None => Ok(()),
            }
        }

        fn named(&mut self, change: impl FnOnce(&mut Names)) {
            change(&mut self.now);
            self.on_disk.push(self.now.clone());
        }

        /// What may be found when the power is back: content that was not synced is lost.
        fn found(&self) -> Vec<BTreeMap<String, Option<String>>> {
            let text = |content: usize| {
                self.synced[content]
                    .then(|| String::from_utf8(self.contents[content].clone()).unwrap())
            };
            let name = |path: &PathBuf| path.display().to_string();
            self.on_disk
                .iter()
                .map(|names| names.iter().map(|(path, at)| (name(path), text(*at))).collect())
                .collect()
        }
    }

    impl Disk for Lossy {
        fn write(&mut self, path: &Path, content: &[u8]) -> io::Result<()> {
            self.step()?;
            self.contents.push(content.to_vec());
            self.synced.push(false);
            let at = self.contents.len() - 1;
            self.named(|names| _ = names.insert(path.to_owned(), at));
            Ok(())
        }

        fn sync(&mut self, path: &Path) -> io::Result<()> {
            self.step()?;
            self.synced[self.now[path]] = true;
            Ok(())
        }

        fn rename(&mut self, from: &Path, to: &Path) -> io::Result<()> {
            self.step()?;
            self.named(|names| {
                let content = names.remove(from).expect("it is there");
                names.insert(to.to_owned(), content);
            });
            Ok(())
        }

        fn sync_folder(&mut self, _: &Path) -> io::Result<()> {
            self.step()?;
            self.on_disk = vec![self.now.clone()];
            Ok(())
        }
    }

    fn drafts() -> [Draft<'static>; 2] {
        ["run.json", "parameters.yaml"].map(|name| Draft {
            draft: format!(".{name}.tmp").into(),
            target: name.into(),
            content: b"new",
        })
    }

    #[test]
    fn whenever_the_power_goes_each_file_is_the_old_or_the_new_one() {
        let before = Lossy::with(&[("run.json", "old"), ("parameters.yaml", "old")]);
        for left in 0.. {
            let mut disk = Lossy { left: Some(left), ..before.clone() };
            let done = write(&mut disk, Path::new(""), &drafts()).is_ok();
            for found in disk.found() {
                for target in ["run.json", "parameters.yaml"] {
                    let content = found[target].as_deref();
                    assert!(
                        matches!(content, Some("old" | "new")),
                        "after {left} steps: {target}: {content:?}"
                    );
                    assert!(
                        !done || content == Some("new"),
                        "what was told to be written is there"
                    );
                }
            }
            if done {
                assert_eq!(
                    left, 7,
                    "two files are written, synced, renamed, and their names synced"
                );
                return;
            }
        }
    }

    /// The test above finds what it looks for.
    #[test]
    fn without_syncing_the_draft_a_file_may_be_empty() {
        let mut disk = Lossy::with(&[("run.json", "old")]);
        let [Draft { draft, target, content }, _] = drafts();
        disk.write(&draft, content).unwrap();
        disk.rename(&draft, &target).unwrap();
        assert!(disk.found().iter().any(|found| found["run.json"].is_none()));
    }

    #[test]
    fn a_file_is_replaced_and_no_draft_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("metadata.yaml");
        for content in ["one", "two"] {
            write_one(&path, content.as_bytes()).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), content);
        }
        assert!(write_one(&folder.path().join("no/such"), b"").is_err());
        fs::create_dir(folder.path().join("taken")).unwrap();
        assert!(write_one(&folder.path().join("taken"), b"").is_err());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
        sync_made(folder.path(), folder.path()).unwrap();
    }
}
