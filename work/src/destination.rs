//! The options that say where results go; the same for every command.

use std::path::{Path, PathBuf};

use files::{Folder, OutputError, OutputFile};

/// Folder of the numbered folders.
pub const RUNS: &str = "runs";

/// Where a command with several files puts them.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct ToFolder {
    /// Folder for the results, new or empty
    /// [default: a new one under runs/, named after the command and numbered]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Write into a folder that is not empty, and replace files of the same names
    #[arg(long)]
    pub force: bool,
    /// Where the new folder is made; under `runs/` if this says nothing.
    #[arg(skip)]
    pub runs: Option<PathBuf>,
}

impl ToFolder {
    /// The folder, made; `name` is what it is called under `runs/`.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn reserve(&self, name: &str) -> Result<Folder, OutputError> {
        let runs = self.runs.as_deref().unwrap_or(Path::new(RUNS));
        Folder::reserve(self.out.as_deref(), runs, name, self.force)
    }
}

/// Where a command with one file puts it, unless it is told.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Force {
    /// Replace a file that is there
    #[arg(long)]
    pub force: bool,
}

impl Force {
    /// The file of that path.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn file(&self, path: &Path) -> Result<OutputFile, OutputError> {
        OutputFile::new(path, self.force)
    }
}
