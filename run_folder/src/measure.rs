//! How much a folder takes.

use std::fs;
use std::path::Path;

/// Folders within folders that are looked into: a commission within a trial has two.
const DEEP: usize = 6;

/// Bytes of all files beneath. Links are not followed, and what cannot be read is not counted.
pub(crate) fn bytes(folder: &Path) -> u64 {
    beneath(folder, DEEP)
}

fn beneath(folder: &Path, deep: usize) -> u64 {
    let Ok(entries) = fs::read_dir(folder) else { return 0 };
    let sizes = entries.flatten().map(|entry| match entry.metadata() {
        Ok(about) if about.is_file() => about.len(),
        Ok(about) if about.is_dir() && deep > 0 => beneath(&entry.path(), deep - 1),
        _ => 0,
    });
    sizes.sum()
}
