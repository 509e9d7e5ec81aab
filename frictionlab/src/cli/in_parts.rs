//! How a part of a long work ends, and a work that was joined of parts.

use files::Folder;
use serde::Serialize;
use work::part::{Part, document};
use work::saying::Saying;

/// What is said of a part that was stopped.
pub const STOPPED: &str =
    "stopped before the end; a part counts only as a whole, so nothing is kept";

/// Writes what a part found, and says how it goes on.
///
/// # Errors
/// If it cannot be written or printed.
pub fn wrote(
    work: &str,
    part: Part,
    result: &impl Serialize,
    (folder, saying, quiet): (&Folder, Saying, bool),
) -> anyhow::Result<()> {
    let document = document(work, part, result)?;
    let name = part.file_name();
    folder.write(&[(&name, document.clone())])?;
    let path = folder.join(&name);
    let text = format!(
        "Part {part}  {}\nPut the documents of all parts into one folder and give the same options with --join FOLDER\n",
        path.display()
    );
    saying.result(quiet, &document, &text)
}

/// What is said in the end where a work was joined of fewer parts than there are.
///
/// # Errors
/// The sentence that parts are missing.
pub fn joined(lacking: Option<String>) -> anyhow::Result<()> {
    lacking.map_or(Ok(()), |lacking| Err(anyhow::Error::msg(lacking)))
}
