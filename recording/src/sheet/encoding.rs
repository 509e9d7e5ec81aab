//! How the characters of a text are written. Spreadsheets write UTF-16, measuring programs the code
//! page of Western Europe.

use std::borrow::Cow;

use encoding_rs::{UTF_16BE, UTF_16LE, WINDOWS_1252};
use serde::Serialize;

/// How the characters of a text are written.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Encoding {
    /// UTF-8, or what is to be refused as none.
    #[default]
    Utf8,
    /// UTF-16, as in `Unicode text` of a spreadsheet.
    Utf16,
    /// Windows-1252, which holds Latin-1.
    Windows1252,
}

impl Encoding {
    /// In words; none for what needs none.
    #[must_use]
    pub const fn describe(self) -> Option<&'static str> {
        match self {
            Self::Utf8 => None,
            Self::Utf16 => Some("text in UTF-16"),
            Self::Windows1252 => Some("text that is no UTF-8, read as Windows-1252 (Latin-1)"),
        }
    }
}

/// How a text that begins so is written; none for UTF-8, and for what is no text.
pub(super) fn encoding_of(bytes: &[u8]) -> Option<Encoding> {
    match bytes.get(..4) {
        Some([0xff, 0xfe, ..] | [1..=255, 0, 1..=255, 0]) => return Some(Encoding::Utf16),
        Some([0xfe, 0xff, ..] | [0, 1..=255, 0, 1..=255]) => return Some(Encoding::Utf16),
        _ => {}
    }
    // What holds bytes of control is no text in any code page.
    let control = |byte: &u8| matches!(byte, 0..=8 | 14..=31 | 127);
    let code_page = std::str::from_utf8(bytes).is_err() && !bytes.iter().any(control);
    code_page.then_some(Encoding::Windows1252)
}

/// Whether the characters of a text in UTF-16 have their big end first.
pub(super) fn big_end_first(bytes: &[u8]) -> bool {
    matches!(bytes.get(..2), Some([0xfe, 0xff] | [0, _]))
}

/// The text in UTF-8, and how it was written. What is no text stays as it is.
pub(super) fn decoded(bytes: Cow<'_, [u8]>) -> (Cow<'_, [u8]>, Encoding) {
    let by = |encoding: &'static encoding_rs::Encoding| {
        Cow::Owned(encoding.decode(&bytes).0.into_owned().into_bytes())
    };
    match encoding_of(&bytes) {
        Some(Encoding::Utf16) if big_end_first(&bytes) => (by(UTF_16BE), Encoding::Utf16),
        Some(Encoding::Utf16) => (by(UTF_16LE), Encoding::Utf16),
        Some(Encoding::Windows1252) => (by(WINDOWS_1252), Encoding::Windows1252),
        _ => (bytes, Encoding::Utf8),
    }
}
