//! Takes a bag away that is to be replaced.

use std::fs;
use std::io;
use std::path::Path;

use super::BagError;
use super::recover::is_being_written;

/// Removes the bag in a folder: its MCAP files, whole or damaged, and its description. What else is
/// in the folder stays, and so does the folder. Without a folder nothing is done.
///
/// # Errors
/// [`BagError::InUse`] if it is being written, [`BagError::Write`] if it cannot be removed.
pub fn remove(dir: &Path) -> Result<(), BagError> {
    let fail = |source| BagError::Write { path: dir.to_owned(), source };
    let entries = match fs::read_dir(dir) {
        Ok(entries) => entries.collect::<Result<Vec<_>, _>>().map_err(fail)?,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(fail(error)),
    };
    let files: Vec<_> = entries
        .iter()
        .filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_file()))
        .map(fs::DirEntry::path)
        .filter(|path| is_of_a_bag(path))
        .collect();
    if let Some(path) = files.iter().find(|path| is_being_written(path)) {
        return Err(BagError::InUse { path: path.clone() });
    }
    for path in files {
        fs::remove_file(&path).map_err(|source| BagError::Write { path, source })?;
    }
    Ok(())
}

fn is_of_a_bag(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name == "metadata.yaml" || name.ends_with(".mcap") || name.contains(".mcap.damaged")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bag::{BagOptions, BagWriter};

    #[test]
    fn a_bag_is_removed_and_nothing_else() {
        let root = tempfile::tempdir().unwrap();
        let dir = root.path().join("bag");
        remove(&dir).unwrap();
        BagWriter::create(&dir, BagOptions::default()).unwrap().finish().unwrap();
        remove(&dir).unwrap();
        let writer = BagWriter::create(&dir, BagOptions::default()).unwrap();
        assert!(matches!(remove(&dir), Err(BagError::InUse { .. })), "somebody writes it");
        drop(writer);
        fs::write(dir.join("notes.txt"), "mine").unwrap();
        remove(&dir).unwrap();
        let left: Vec<_> =
            fs::read_dir(&dir).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(left, ["notes.txt"]);
    }
}
