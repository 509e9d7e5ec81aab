//! One file, or whatever else a path or `-` names.

use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::{Growing, OutputError, first_missing, remove_empty};
use crate::durable;
use crate::target::{folder_of, is_special};

/// Where the one file of a command goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OutputFile {
    to: To,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum To {
    Stdout,
    /// A regular file, there or not yet; whether it may be replaced.
    File(PathBuf, bool),
    /// A pipe, a device or a symbolic link: written through.
    Special(PathBuf),
}

impl OutputFile {
    /// The file of that path, which must not be there unless `force`; `-` is standard output. What
    /// is no regular file is written through. Nothing is written yet, but a place that cannot be
    /// written is told.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn new(path: &Path, force: bool) -> Result<Self, OutputError> {
        if path.as_os_str() == "-" {
            return Ok(Self { to: To::Stdout });
        }
        if path.is_dir() || path.file_name().is_none() {
            return Err(OutputError::IsFolder(path.to_owned()));
        }
        // A link to a file is that file.
        if path.is_file() && !force {
            return Err(OutputError::Exists(path.to_owned()));
        }
        if is_special(path) {
            return Ok(Self { to: To::Special(path.to_owned()) });
        }
        let file = Self { to: To::File(path.to_owned(), force) };
        file.probe(path)?;
        Ok(file)
    }

    /// A folder can be there and still take no file.
    fn probe(&self, path: &Path) -> Result<(), OutputError> {
        let folder = folder_of(path);
        if !folder.exists() {
            return Ok(());
        }
        let probe = durable::draft(path);
        fs::write(&probe, "")
            .and_then(|()| fs::remove_file(&probe))
            .map_err(|source| OutputError::Write { path: path.to_owned(), source })
    }

    /// Whether it is standard output: then nothing else may be printed there.
    #[must_use]
    pub fn is_stdout(&self) -> bool {
        self.to == To::Stdout
    }

    /// Its name, for a message.
    #[must_use]
    pub fn name(&self) -> String {
        match &self.to {
            To::Stdout => "standard output".to_owned(),
            To::File(path, _) | To::Special(path) => path.display().to_string(),
        }
    }

    /// Begins to write what is too long to stand in memory.
    ///
    /// # Errors
    /// [`OutputError`] where it cannot be opened.
    pub fn grow(&self) -> Result<Growing, OutputError> {
        match &self.to {
            To::Stdout => Ok(Growing::stdout()),
            To::Special(path) => Growing::through(path),
            To::File(path, force) => Growing::draft(path, *force),
        }
    }

    /// Writes it: a regular file whole or not at all, with the mode that it had.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn write(&self, content: &[u8]) -> Result<(), OutputError> {
        let (path, written) = match &self.to {
            To::Stdout => {
                let mut out = io::stdout().lock();
                (Path::new("standard output"), out.write_all(content).and_then(|()| out.flush()))
            }
            To::Special(path) => (path.as_path(), write_through(path, content)),
            To::File(path, force) => {
                if !force && path.exists() {
                    return Err(OutputError::Exists(path.clone()));
                }
                (path.as_path(), write_regular(path, content))
            }
        };
        match written {
            // Whoever reads has seen enough (`| head`): that is no error.
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
            Err(source) => Err(OutputError::Write { path: path.to_owned(), source }),
            Ok(()) => Ok(()),
        }
    }
}

fn write_regular(path: &Path, content: &[u8]) -> io::Result<()> {
    let folder = folder_of(path);
    let made = first_missing(folder);
    let written = fs::create_dir_all(folder).and_then(|()| durable::write_one(path, content));
    if let (Err(_), Some(top)) = (&written, &made) {
        remove_empty(folder, top);
    }
    written
}

/// Writes into what is there: a pipe, a device, or the file that a link leads to.
pub(super) fn write_through(path: &Path, content: &[u8]) -> io::Result<()> {
    if let Ok(real) = fs::canonicalize(path)
        && real.is_file()
    {
        // The link stays, and the file behind it is whole or as it was.
        return durable::write_one(&real, content);
    }
    let mut file = match path.symlink_metadata() {
        // A link that leads nowhere yet.
        Ok(found) if found.is_symlink() => File::create(path)?,
        _ => OpenOptions::new().write(true).open(path)?,
    };
    file.write_all(content)?;
    file.flush()
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
    use std::process::Command;

    use super::*;

    #[test]
    fn a_file_that_is_there_is_refused_and_forced_keeps_its_mode() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("deep/friction.csv");
        OutputFile::new(&path, false).unwrap().write(b"one").unwrap();
        let error = OutputFile::new(&path, false).unwrap_err();
        assert!(
            matches!(error, OutputError::Exists(_)) && error.to_string().contains("replaced"),
            "{error}"
        );
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        OutputFile::new(&path, true).unwrap().write(b"two").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(path.metadata().unwrap().permissions().mode() & 0o7777, 0o640);
        assert!(matches!(OutputFile::new(root.path(), true), Err(OutputError::IsFolder(_))));
    }

    #[test]
    fn a_file_that_came_meanwhile_is_not_replaced() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("friction.csv");
        let file = OutputFile::new(&path, false).unwrap();
        fs::write(&path, "mine").unwrap();
        assert!(matches!(file.write(b"other"), Err(OutputError::Exists(_))));
        assert_eq!(fs::read(&path).unwrap(), b"mine");
    }

    #[test]
    fn a_pipe_is_written_through_and_stays_a_pipe() {
        let root = tempfile::tempdir().unwrap();
        let pipe = root.path().join("pipe");
        assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let end = pipe.clone();
        let reader = std::thread::spawn(move || fs::read(end).unwrap());
        OutputFile::new(&pipe, false).unwrap().write(b"t_s,torque_Nm\n").unwrap();
        assert_eq!(reader.join().unwrap(), b"t_s,torque_Nm\n");
        assert!(pipe.symlink_metadata().unwrap().file_type().is_fifo());
        // In a folder of results too.
        let end = pipe.clone();
        let reader = std::thread::spawn(move || fs::read(end).unwrap());
        super::super::write_all(root.path(), &[("pipe", "again".to_owned())]).unwrap();
        assert_eq!(reader.join().unwrap(), b"again");
        assert!(pipe.symlink_metadata().unwrap().file_type().is_fifo());
    }

    #[test]
    fn a_link_stays_a_link_and_its_file_is_guarded_like_any_other() {
        let root = tempfile::tempdir().unwrap();
        let (link, real) = (root.path().join("link.csv"), root.path().join("real.csv"));
        symlink("real.csv", &link).unwrap();
        // It leads nowhere yet.
        OutputFile::new(&link, false).unwrap().write(b"one").unwrap();
        assert_eq!(fs::read(&real).unwrap(), b"one");
        assert!(matches!(OutputFile::new(&link, false), Err(OutputError::Exists(_))));
        OutputFile::new(&link, true).unwrap().write(b"two").unwrap();
        assert_eq!(fs::read(&real).unwrap(), b"two");
        assert!(link.symlink_metadata().unwrap().is_symlink());
    }

    #[test]
    fn a_minus_is_standard_output() {
        let file = OutputFile::new(Path::new("-"), false).unwrap();
        assert!(file.is_stdout() && file.name() == "standard output");
    }
}
