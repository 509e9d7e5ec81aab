//! Where the vendor's library is.

use std::path::{Path, PathBuf};

use super::QuanserError;
use super::hil::Hil;

/// Names under which installations have it.
const NAMES: [&str; 4] = [
    "libhil.so",
    "libhil.so.1",
    "/opt/quanser/lib/libhil.so",
    "/opt/quanser/hil_sdk/lib/libhil.so",
];

/// Looks for a HIL library that loads, without opening a card. Returns its name.
///
/// # Errors
/// [`QuanserError::NoLibrary`] tells what was tried; [`QuanserError::NoFunction`] that it is no HIL
/// library.
pub fn find_library() -> Result<PathBuf, QuanserError> {
    load(None).map(|hil| hil.name().to_owned())
}

/// Loads `library`, or else the first of the usual names that there is.
pub(super) fn load(library: Option<&Path>) -> Result<Hil, QuanserError> {
    let mut tried = Vec::new();
    for name in library.map_or_else(|| NAMES.map(Path::new).to_vec(), |library| vec![library]) {
        match Hil::load(name) {
            Ok(hil) => return Ok(hil),
            Err(QuanserError::NoLibrary { tried: said }) => tried.push(said),
            Err(other) => return Err(other),
        }
    }
    Err(QuanserError::NoLibrary { tried: tried.join(", ") })
}
