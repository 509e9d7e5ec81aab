//! All runs of a folder.

use std::fs;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::run::{NoRun, Run};

/// What the folders of a folder are.
#[derive(Debug, Clone, Serialize)]
pub struct Listing {
    /// The folder.
    pub root: PathBuf,
    /// The runs, the newest first.
    pub runs: Vec<Run>,
    /// Folders that are none of a run, by name.
    pub others: Vec<NoRunIn>,
}

/// A folder that is none of a run.
#[derive(Debug, Clone, Serialize)]
pub struct NoRunIn {
    /// The folder.
    pub folder: PathBuf,
    /// Why.
    pub why: String,
}

/// Tells what the folders in `root` are; of a folder of a run, what it is itself. Hidden folders
/// and files are passed over.
///
/// # Errors
/// [`NoRun`] where `root` itself is no folder that can be read. What is wrong with a folder in it
/// stands in the list.
pub fn list(root: &Path) -> Result<Listing, NoRun> {
    let mut listing = Listing { root: root.to_owned(), runs: Vec::new(), others: Vec::new() };
    match Run::open(root) {
        Ok(run) => {
            listing.runs.push(run);
            return Ok(listing);
        }
        Err(NoRun::Foreign(_)) => {}
        Err(error) => return Err(error),
    }
    let unreadable = |source| NoRun::Unreadable { path: root.to_owned(), source };
    let mut folders: Vec<PathBuf> = fs::read_dir(root)
        .map_err(unreadable)?
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.is_dir() && !hidden(path))
        .collect();
    folders.sort();
    for folder in folders {
        match Run::open(&folder) {
            Ok(run) => listing.runs.push(run),
            Err(error) => listing.others.push(NoRunIn { folder, why: error.to_string() }),
        }
    }
    // Of one time, by name.
    listing.runs.sort_by(|a, b| b.made.cmp(&a.made).then_with(|| a.folder.cmp(&b.folder)));
    Ok(listing)
}

fn hidden(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'))
}
