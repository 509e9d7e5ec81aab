//! The folder of a run before it begins.

use std::fs;
use std::path::Path;

use recording::bag;
use work::progress::Progress;

use super::BAG;
use crate::run::RunError;
use files::{OutputError, is_empty_or_missing};

/// Puts the bag of a run that was stopped aside, whole as far as it goes; the name of the folder
/// that it is in then.
pub(super) fn put_aside(folder: &Path, progress: &Progress) -> Result<Option<String>, RunError> {
    let old = folder.join(BAG);
    if is_empty_or_missing(&old)
        .map_err(|source| OutputError::Write { path: old.clone(), source })?
    {
        return Ok(None);
    }
    if bag::is_cut(&old)
        && let Err(error) = bag::recover(&old)
    {
        progress.line(&format!(
            "the bag of the run before cannot be saved and is kept as it is: {error}"
        ));
    }
    let free = (1u32..)
        .map(|n| format!("{BAG}_before_resume_{n}"))
        .find(|name| !folder.join(name).exists());
    let Some(name) = free else { return Ok(None) };
    fs::rename(&old, folder.join(&name))
        .map_err(|source| OutputError::Write { path: old, source })?;
    Ok(Some(name))
}

/// Refuses a folder that holds something; one that does not exist is made later.
pub(super) fn require_empty(folder: &Path) -> Result<(), RunError> {
    match is_empty_or_missing(folder) {
        Ok(true) => Ok(()),
        Ok(false) => Err(OutputError::NotEmpty(folder.to_owned()).into()),
        Err(source) => Err(OutputError::Write { path: folder.to_owned(), source }.into()),
    }
}
