//! What can be read at any place: a file, or what one held that was packed.

use std::io::{Read, Seek};

/// What can be read at any place.
pub(super) trait ReadAt: Read + Seek {}
impl<T: Read + Seek> ReadAt for T {}
