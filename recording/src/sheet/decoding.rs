//! A text that is read as it comes, in UTF-8 whatever it was written in.

use std::io::{self, BufRead, Read};

use encoding_rs::{Decoder, UTF_16BE, UTF_16LE, WINDOWS_1252};

/// Turns what is read into UTF-8.
pub(crate) struct Decoding {
    from: Box<dyn BufRead>,
    decoder: Decoder,
    ready: Vec<u8>,
    given: usize,
    ended: bool,
}

/// Bytes that are turned at a time.
const AT_ONCE: usize = 1 << 16;

impl Decoding {
    /// As the text begins, so it goes on. `head` is how it begins; none where it needs no turning.
    pub fn of(head: &[u8], from: Box<dyn BufRead>) -> Result<Self, Box<dyn BufRead>> {
        let encoding = match super::encoding::encoding_of(head) {
            Some(super::Encoding::Utf16) if super::encoding::big_end_first(head) => UTF_16BE,
            Some(super::Encoding::Utf16) => UTF_16LE,
            Some(super::Encoding::Windows1252) => WINDOWS_1252,
            _ => return Err(from),
        };
        let decoder = encoding.new_decoder_with_bom_removal();
        Ok(Self { from, decoder, ready: Vec::new(), given: 0, ended: false })
    }

    fn turn(&mut self) -> io::Result<()> {
        let read = self.from.fill_buf()?;
        let part = read.get(..read.len().min(AT_ONCE)).unwrap_or_default();
        let last = part.is_empty();
        let room = self.decoder.max_utf8_buffer_length(part.len());
        self.ready.clear();
        self.ready.resize(room.unwrap_or(4 * AT_ONCE + 16), 0);
        let (_, taken, written, _) = self.decoder.decode_to_utf8(part, &mut self.ready, last);
        self.ready.truncate(written);
        self.given = 0;
        self.from.consume(taken);
        self.ended = last;
        Ok(())
    }
}

impl Read for Decoding {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        while self.given == self.ready.len() && !self.ended {
            self.turn()?;
        }
        let rest = self.ready.get(self.given..).unwrap_or_default();
        let count = rest.len().min(into.len());
        if let (Some(into), Some(rest)) = (into.get_mut(..count), rest.get(..count)) {
            into.copy_from_slice(rest);
        }
        self.given += count;
        Ok(count)
    }
}
