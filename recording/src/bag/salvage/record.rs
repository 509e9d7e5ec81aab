//! Whether bytes are a record.

use mcap::records::{Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

/// No record or chunk of a sane bag is larger; a file that claims one is damaged.
pub(in crate::bag) const LARGEST_RECORD: usize = 1 << 28;

/// Opcode and length.
pub(super) const HEAD: usize = 9;

/// Length of a record, its head included, if there is room for it.
pub(super) fn length(head: &[u8], left: u64) -> Option<usize> {
    let (&opcode, rest) = head.split_first()?;
    let content = u64::from_le_bytes(*rest.first_chunk::<8>()?);
    let whole = content.checked_add(HEAD as u64).filter(|whole| *whole <= left)?;
    let known = (op::HEADER..=op::DATA_END).contains(&opcode);
    usize::try_from(whole).ok().filter(|whole| known && *whole <= LARGEST_RECORD)
}

/// The record in the bytes, if they are one.
pub(super) fn parse(record: &[u8]) -> Option<Record<'_>> {
    let (&opcode, content) =
        record.split_first().and_then(|(opcode, rest)| Some((opcode, rest.get(8..)?)))?;
    // A length that is too long would swallow what stands behind the record; one that is too short
    // makes the library cut where nothing is.
    if !Content(content).ends_with(opcode) {
        return None;
    }
    mcap::parse_record(opcode, content).ok()
}

/// Whether what calls itself a message is the index of a chunk with a damaged opcode: a channel, the
/// length of a list, and as many pairs of a time and a place in the chunk. A message would need a
/// number of its own that is the length of its rest, and a time of publication a few bytes after 1970.
pub(super) fn is_index(record: &[u8]) -> bool {
    let Some((&op::MESSAGE, content)) =
        record.split_first().and_then(|(opcode, rest)| Some((opcode, rest.get(8..)?)))
    else {
        return false;
    };
    let place = content.get(14..22).and_then(|place| place.first_chunk::<8>());
    let inside = place.is_some_and(|place| u64::from_le_bytes(*place) <= LARGEST_RECORD as u64);
    inside && Content(content).ends_with(op::MESSAGE_INDEX) && (content.len() - 6) % 16 == 0
}

/// What is left of a record's content.
struct Content<'a>(&'a [u8]);

impl Content<'_> {
    /// Whether the content ends where its own lengths say.
    fn ends_with(mut self, opcode: u8) -> bool {
        let read = match opcode {
            op::HEADER => self.text().and_then(|()| self.text()),
            op::FOOTER => self.skip(20),
            op::SCHEMA => self
                .skip(2)
                .and_then(|()| self.text())
                .and_then(|()| self.text())
                .and_then(|()| self.text()),
            op::CHANNEL => self
                .skip(4)
                .and_then(|()| self.text())
                .and_then(|()| self.text())
                .and_then(|()| self.text()),
            // A message has no length but that of its record.
            op::MESSAGE => return self.0.len() >= 22,
            op::CHUNK => self.skip(28).and_then(|()| self.text()).and_then(|()| self.long()),
            op::MESSAGE_INDEX => self.skip(2).and_then(|()| self.text()),
            op::ATTACHMENT => self
                .skip(16)
                .and_then(|()| self.text())
                .and_then(|()| self.text())
                .and_then(|()| self.long())
                .and_then(|()| self.skip(4)),
            op::METADATA => self.text().and_then(|()| self.text()),
            op::DATA_END => self.skip(4),
            // The index at the end: it is made anew.
            _ => return true,
        };
        read.is_some() && self.0.is_empty()
    }

    fn skip(&mut self, bytes: usize) -> Option<()> {
        self.0 = self.0.get(bytes..)?;
        Some(())
    }

    /// Passes over something with its length in four bytes before it.
    fn text(&mut self) -> Option<()> {
        let (length, rest) = self.0.split_first_chunk::<4>()?;
        self.0 = rest.get(u32::from_le_bytes(*length) as usize..)?;
        Some(())
    }

    /// The same with eight bytes.
    fn long(&mut self) -> Option<()> {
        let (length, rest) = self.0.split_first_chunk::<8>()?;
        self.0 = rest.get(usize::try_from(u64::from_le_bytes(*length)).ok()?..)?;
        Some(())
    }
}

/// The records in a chunk; `None` unless all of it can be read and its checksum is right.
pub(super) fn unpack(record: &[u8]) -> Option<Vec<Vec<u8>>> {
    // The reader goes by the content's own length: with a record's that is too long it would read
    // one chunk and leave out those behind it.
    if !Content(record.get(HEAD..)?).ends_with(op::CHUNK) {
        return None;
    }
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_validate_chunk_crcs(true)
        .with_record_length_limit(LARGEST_RECORD);
    let mut reader = LinearReader::new_with_options(options);
    let mut left = record;
    let mut inside = Vec::new();
    while let Some(event) = reader.next_event() {
        match event.ok()? {
            LinearReadEvent::ReadRequest(need) => {
                let length = need.min(left.len());
                let (now, later) = left.split_at(length);
                reader.insert(length).copy_from_slice(now);
                reader.notify_read(length);
                left = later;
            }
            LinearReadEvent::Record { data, opcode } => {
                let mut record = Vec::with_capacity(HEAD + data.len());
                record.push(opcode);
                record.extend_from_slice(&(data.len() as u64).to_le_bytes());
                record.extend_from_slice(data);
                // A message that is not one makes the chunk damaged, checksum or not.
                parse(&record)?;
                inside.push(record);
            }
        }
    }
    Some(inside)
}
