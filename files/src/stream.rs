//! One file that grows as it is computed: nothing of it needs to stand in memory.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::target::{folder_of, is_special};
use super::{OutputError, first_missing, remove_empty};
use crate::durable::{self, Disk, System};

/// The content of an `OutputFile` on its way. A regular file appears under its name when
/// [`finish`](Self::finish) says so, whole; dropped before that, nothing of it stays. Standard
/// output, pipes and devices get what is written at once.
#[derive(Debug)]
pub struct Growing {
    /// Its name in messages.
    path: PathBuf,
    to: Open,
    /// Whoever read has seen enough (`| head`): what comes now goes nowhere.
    unheard: bool,
}

#[derive(Debug)]
enum Open {
    Stdout(BufWriter<io::Stdout>),
    Through(BufWriter<File>),
    Draft(Draft),
}

/// A file under the name of its draft.
#[derive(Debug)]
struct Draft {
    file: BufWriter<File>,
    draft: PathBuf,
    target: PathBuf,
    replace: bool,
    /// The highest folder that was made for it.
    made: Option<PathBuf>,
    kept: bool,
}

impl Growing {
    pub(super) fn stdout() -> Self {
        let to = Open::Stdout(BufWriter::new(io::stdout()));
        Self { path: "standard output".into(), to, unheard: false }
    }

    /// Into what is there: a pipe, a device, or the file that a link leads to, which stays whole.
    pub(super) fn through(path: &Path) -> Result<Self, OutputError> {
        let fail = |source| OutputError::Write { path: path.to_owned(), source };
        if let Some(real) = fs::canonicalize(path).ok().filter(|real| real.is_file()) {
            return Self::draft(&real, true);
        }
        let dangling = path.symlink_metadata().is_ok_and(|found| found.is_symlink());
        let opened = match dangling {
            true => File::create(path),
            false => OpenOptions::new().write(true).open(path),
        };
        let to = Open::Through(BufWriter::new(opened.map_err(fail)?));
        Ok(Self { path: path.to_owned(), to, unheard: false })
    }

    pub(super) fn draft(target: &Path, replace: bool) -> Result<Self, OutputError> {
        let fail = |source| OutputError::Write { path: target.to_owned(), source };
        let folder = folder_of(target);
        let made = first_missing(folder);
        let draft = durable::draft(target);
        let opened = fs::create_dir_all(folder).and_then(|()| File::create(&draft));
        let file = opened.map_err(|error| {
            if let Some(top) = &made {
                remove_empty(folder, top);
            }
            fail(error)
        })?;
        let file = BufWriter::new(file);
        let target = target.to_owned();
        let path = target.clone();
        let to = Open::Draft(Draft { file, draft, target, replace, made, kept: false });
        Ok(Self { path, to, unheard: false })
    }

    /// Brings everything to its place. A file that came there meanwhile is not replaced, unless it
    /// may be.
    ///
    /// # Errors
    /// [`OutputError`]; nothing stays of a regular file then.
    pub fn finish(mut self) -> Result<(), OutputError> {
        let flushed = self.flush();
        let path = self.path.clone();
        let fail = |source| OutputError::Write { path, source };
        flushed.map_err(fail.clone())?;
        match &mut self.to {
            Open::Stdout(_) | Open::Through(_) => Ok(()),
            Open::Draft(draft) => {
                if !draft.replace && (draft.target.exists() || is_special(&draft.target)) {
                    return Err(OutputError::Exists(draft.target.clone()));
                }
                draft.keep().map_err(fail)
            }
        }
    }

    fn writer(&mut self) -> &mut dyn Write {
        match &mut self.to {
            Open::Stdout(out) => out,
            Open::Through(file) => file,
            Open::Draft(draft) => &mut draft.file,
        }
    }

    fn heard<T>(&mut self, written: io::Result<T>, all: T) -> io::Result<T> {
        match written {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => {
                self.unheard = true;
                Ok(all)
            }
            other => other,
        }
    }
}

impl Write for Growing {
    fn write(&mut self, content: &[u8]) -> io::Result<usize> {
        if self.unheard {
            return Ok(content.len());
        }
        let written = self.writer().write(content);
        self.heard(written, content.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.unheard {
            return Ok(());
        }
        let flushed = self.writer().flush();
        self.heard(flushed, ())
    }
}

impl Draft {
    fn keep(&mut self) -> io::Result<()> {
        System.sync(&self.draft)?;
        System.rename(&self.draft, &self.target)?;
        self.kept = true;
        System.sync_folder(folder_of(&self.target))
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        if self.kept {
            return;
        }
        // Nobody is left to be told that a draft could not be removed.
        let _ = fs::remove_file(&self.draft);
        if let Some(top) = &self.made {
            remove_empty(folder_of(&self.target), top);
        }
    }
}
