//! How much of what others send is said back, and how long an answer may be.
//!
//! Whoever asks must not make a node repeat without measure: a question of a few kilobytes can ask
//! for the same parameter a thousand times.

use std::{borrow::Cow, io};

use cdr_encoding::to_writer;

/// Longest piece of a foreign text that is repeated, in characters.
const QUOTED: usize = 80;
/// Longest line of the log, in characters.
const LINE: usize = 4000;
/// Longest answer \[bytes\]. The longest that a question with sense has is some 50 kB. RustDDS cuts
/// what needs more than one datagram into fragments, and sends again what the client's socket
/// drops: on ordinary Linux that begins at some 100 kB, and a megabyte takes about a second.
pub(crate) const ANSWER: usize = 1 << 20;

/// A foreign text as it may be repeated: whole, or its beginning and its length.
#[must_use]
pub fn quoted(text: &str) -> Cow<'_, str> {
    cut(text, QUOTED)
}

/// A text as a line of the log.
pub(crate) fn line(text: &str) -> Cow<'_, str> {
    cut(text, LINE)
}

fn cut(text: &str, longest: usize) -> Cow<'_, str> {
    match text.char_indices().nth(longest) {
        None => Cow::Borrowed(text),
        Some((end, _)) => Cow::Owned(format!("{}... ({} bytes)", &text[..end], text.len())),
    }
}

/// Whether a message is longer than an answer may be.
pub(crate) fn is_too_long<M: serde::Serialize>(message: &M) -> bool {
    // Only the count can fail.
    to_writer::<M, byteorder::LittleEndian, _>(Count { left: ANSWER }, message).is_err()
}

/// Takes so many bytes and no more.
struct Count {
    left: usize,
}

impl io::Write for Count {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.left = self.left.checked_sub(bytes.len()).ok_or_else(|| {
            io::Error::new(io::ErrorKind::StorageFull, "longer than an answer may be")
        })?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_short_stays_and_what_is_long_is_cut_between_characters() {
        assert_eq!(quoted("lugre"), "lugre");
        assert_eq!(quoted(&"ä".repeat(80)), "ä".repeat(80));
        assert_eq!(quoted(&"ä".repeat(81)), format!("{}... (162 bytes)", "ä".repeat(80)));
    }

    #[test]
    fn an_answer_is_measured_as_it_is_sent() {
        // A length of four bytes, the text, and its closing zero.
        assert!(!is_too_long(&"x".repeat(ANSWER - 5)));
        assert!(is_too_long(&"x".repeat(ANSWER - 4)));
    }
}
