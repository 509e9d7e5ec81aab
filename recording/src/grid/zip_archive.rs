//! `.npz`: a zip archive of arrays.

use std::io::{Cursor, Read};

use zip::ZipArchive;

use super::{Contents, MOST_VALUES, numpy};

/// Room for the header of an array.
const HEADER: u64 = 1 << 16;
/// Arrays in an archive.
const MOST_FILES: usize = 10_000;

/// All arrays of an archive.
pub(super) fn read(bytes: &[u8]) -> Result<Contents, String> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| error.to_string())?;
    if archive.len() > MOST_FILES {
        return Err(format!("it holds {} files; at most {MOST_FILES} are read", archive.len()));
    }
    let mut found = Contents::default();
    for index in 0..archive.len() {
        let mut file = archive.by_index(index).map_err(|error| error.to_string())?;
        let name = file.name().map_err(|error| error.to_string())?.into_owned();
        let Some(name) = name.strip_suffix(".npy") else {
            found.leave_out(&name, "it is no array");
            continue;
        };
        let most = (MOST_VALUES - found.values) as u64 * 8 + HEADER;
        let mut array = Vec::new();
        let read = file.by_ref().take(most + 1).read_to_end(&mut array);
        read.map_err(|error| format!("`{name}`: {error}"))?;
        if array.len() as u64 > most {
            return Err(format!("it unpacks to more than {MOST_VALUES} numbers"));
        }
        numpy::add(&array, name.to_owned(), &mut found)
            .map_err(|detail| format!("`{name}`: {detail}"))?;
    }
    Ok(found)
}
