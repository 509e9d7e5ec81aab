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

/// The text in UTF-8, and how it was written. What is no text stays as it is.
pub(super) fn decoded(bytes: Cow<'_, [u8]>) -> (Cow<'_, [u8]>, Encoding) {
    let by = |encoding: &'static encoding_rs::Encoding| {
        Cow::Owned(encoding.decode(&bytes).0.into_owned().into_bytes())
    };
    let utf16 = match bytes.get(..4) {
        Some([0xff, 0xfe, ..] | [1..=255, 0, 1..=255, 0]) => Some(UTF_16LE),
        Some([0xfe, 0xff, ..] | [0, 1..=255, 0, 1..=255]) => Some(UTF_16BE),
        _ => None,
    };
    if let Some(encoding) = utf16 {
        return (by(encoding), Encoding::Utf16);
    }
    // What holds bytes of control is no text in any code page.
    let control = |byte: &u8| matches!(byte, 0..=8 | 14..=31 | 127);
    if std::str::from_utf8(&bytes).is_err() && !bytes.iter().any(control) {
        return (by(WINDOWS_1252), Encoding::Windows1252);
    }
    (bytes, Encoding::Utf8)
}
