//! Finds what is whole in a damaged MCAP file.
//!
//! A record is an opcode, a length of eight bytes and its content. The file is followed from record
//! to record; where that breaks off, the next chunk, attachment or metadata record that its own
//! checksum or its successor vouches for is looked for byte by byte. A chunk counts only whole,
//! with the right checksum.

mod record;

use std::collections::HashMap;
use std::io::{self, Read, Seek, SeekFrom};

use mcap::records::{Channel, MessageHeader, Record, SchemaHeader, op};

use super::read_at::ReadAt;

pub(super) use self::record::LARGEST_RECORD;
use self::record::{HEAD, is_index, length, parse, unpack};

/// Bytes looked at in one go while searching.
const WINDOW: usize = 1 << 20;

/// One thing that was found whole, in the order of the file.
pub(super) enum Found<'a> {
    /// A message with its channel and that one's schema, if it has one.
    Message {
        channel: &'a Channel,
        schema: Option<&'a (SchemaHeader, Vec<u8>)>,
        header: MessageHeader,
        data: &'a [u8],
    },
    /// A file that was kept with the bag.
    Attachment(mcap::Attachment<'a>),
    /// Named texts.
    Metadata(mcap::records::Metadata),
}

/// What was not whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Losses {
    /// Bytes that belong to no whole record.
    pub(super) bytes: u64,
    /// Chunks whose content is damaged.
    pub(super) chunks: u64,
    /// Messages whose channel was not found.
    pub(super) messages: u64,
    /// Definitions that stand in the file more than once, and differ.
    pub(super) definitions: u64,
    /// The file ends as a closed file does.
    pub(super) closed: bool,
}

/// Walks through a file.
pub(super) struct Salvage {
    file: Box<dyn ReadAt>,
    size: u64,
    schemas: HashMap<u16, (SchemaHeader, Vec<u8>)>,
    channels: HashMap<u16, Channel>,
    losses: Losses,
}

impl Salvage {
    /// Reads `file` of `size` bytes, which is an MCAP file at least by its first ones.
    pub(super) fn new((file, size): (Box<dyn ReadAt>, u64)) -> Self {
        let (schemas, channels) = (HashMap::new(), HashMap::new());
        Self { file, size, schemas, channels, losses: Losses::default() }
    }

    /// Hands everything whole to `take`, then says what was not.
    pub(super) fn run<E: From<io::Error>>(
        mut self,
        mut take: impl FnMut(Found<'_>) -> Result<(), E>,
    ) -> Result<Losses, E> {
        // Channels are repeated at the end of a closed file: there they are found if their first
        // chunk is damaged.
        self.definitions_at_the_end()?;
        let mut at = mcap::MAGIC.len() as u64;
        while at < self.size {
            if self.size - at == mcap::MAGIC.len() as u64
                && self.bytes(at, mcap::MAGIC.len())? == mcap::MAGIC
            {
                self.losses.closed = true;
                break;
            }
            let record = self.record(at)?;
            if let Some(record) = &record
                && self.take(record, &mut take)?
            {
                at += record.len() as u64;
                continue;
            }
            self.losses.chunks += u64::from(record.is_some_and(|record| record[0] == op::CHUNK));
            // A length that is damaged would lead past what is whole: nothing behind it is
            // believed.
            let next = self.search(at + 1)?;
            self.losses.bytes += next - at;
            at = next;
        }
        Ok(self.losses)
    }

    /// Notes schemas and channels of the summary section, if there is one.
    fn definitions_at_the_end(&mut self) -> io::Result<()> {
        // Footer: opcode, length, start of the summary, start of its offsets, checksum; then the
        // magic bytes.
        const FOOTER: u64 = HEAD as u64 + 20;
        let Some(footer) = self.size.checked_sub(FOOTER + mcap::MAGIC.len() as u64) else {
            return Ok(());
        };
        let Some(record) = self.record(footer)? else { return Ok(()) };
        let Some(Record::Footer(found)) = parse(&record) else { return Ok(()) };
        let mut at = found.summary_start;
        while at >= mcap::MAGIC.len() as u64 && at < footer {
            let Some(record) = self.record(at)? else { break };
            self.define(&record);
            at += record.len() as u64;
        }
        Ok(())
    }

    /// Notes a schema or a channel.
    fn define(&mut self, record: &[u8]) {
        match parse(record) {
            Some(Record::Schema { header, data }) => {
                let new = (header, data.into_owned());
                let old = self.schemas.insert(new.0.id, new.clone());
                self.losses.definitions += u64::from(old.is_some_and(|old| old != new));
            }
            Some(Record::Channel(channel)) => {
                let old = self.channels.insert(channel.id, channel.clone());
                self.losses.definitions += u64::from(old.is_some_and(|old| old != channel));
            }
            _ => {}
        }
    }

    /// Takes a record of the file; false if it is not whole.
    fn take<E: From<io::Error>>(
        &mut self,
        record: &[u8],
        take: &mut impl FnMut(Found<'_>) -> Result<(), E>,
    ) -> Result<bool, E> {
        match record[0] {
            op::CHUNK => {
                let Some(inside) = unpack(record) else { return Ok(false) };
                for record in inside {
                    self.take_inner(&record, take)?;
                }
                Ok(true)
            }
            op::SCHEMA | op::CHANNEL | op::MESSAGE => {
                if parse(record).is_none() || is_index(record) {
                    return Ok(false);
                }
                self.take_inner(record, take)?;
                Ok(true)
            }
            op::ATTACHMENT => {
                let Some(Record::Attachment { header, data, .. }) = parse(record) else {
                    return Ok(false);
                };
                take(Found::Attachment(mcap::Attachment {
                    log_time: header.log_time,
                    create_time: header.create_time,
                    name: header.name,
                    media_type: header.media_type,
                    data,
                }))?;
                Ok(true)
            }
            op::METADATA => {
                let Some(Record::Metadata(metadata)) = parse(record) else { return Ok(false) };
                take(Found::Metadata(metadata))?;
                Ok(true)
            }
            _ => Ok(parse(record).is_some()),
        }
    }

    /// Takes a record that stands in a chunk, or would.
    fn take_inner<E: From<io::Error>>(
        &mut self,
        record: &[u8],
        take: &mut impl FnMut(Found<'_>) -> Result<(), E>,
    ) -> Result<(), E> {
        let Some(Record::Message { header, data }) = parse(record) else {
            self.define(record);
            return Ok(());
        };
        let Some(channel) = self.channels.get(&header.channel_id) else {
            self.losses.messages += 1;
            return Ok(());
        };
        let schema = self.schemas.get(&channel.schema_id);
        take(Found::Message { channel, schema, header, data: &data })
    }

    /// The record at that place; `None` where none can stand.
    fn record(&mut self, at: u64) -> io::Result<Option<Vec<u8>>> {
        let Some(length) = self.length(at)? else { return Ok(None) };
        self.bytes(at, length).map(Some)
    }

    /// Length of the record at that place, its head included; `None` where none can stand.
    fn length(&mut self, at: u64) -> io::Result<Option<usize>> {
        if self.size.saturating_sub(at) < HEAD as u64 {
            return Ok(None);
        }
        let head = self.bytes(at, HEAD)?;
        Ok(length(&head, self.size - at))
    }

    /// Whether a record can begin there, or the file ends.
    fn is_head(&mut self, at: u64) -> io::Result<bool> {
        let left = self.size.saturating_sub(at);
        if left == 0 || left == mcap::MAGIC.len() as u64 {
            return Ok(true);
        }
        Ok(self.length(at)?.is_some())
    }

    /// The next place, from `from`, where a whole chunk, attachment or metadata record stands; else
    /// the end of the file.
    fn search(&mut self, from: u64) -> io::Result<u64> {
        let mut at = from;
        while self.size.saturating_sub(at) >= HEAD as u64 {
            let window = usize::try_from(self.size - at).unwrap_or(WINDOW).min(WINDOW);
            let bytes = self.bytes(at, window)?;
            for (offset, head) in bytes.windows(HEAD).enumerate() {
                let place = at + offset as u64;
                if matches!(head[0], op::CHUNK | op::ATTACHMENT | op::METADATA)
                    && length(head, self.size - place).is_some()
                    && self.vouched(place)?
                {
                    return Ok(place);
                }
            }
            // The last bytes are the head of something that reaches into the next window.
            at += (window + 1 - HEAD) as u64;
        }
        Ok(self.size)
    }

    /// Whether the bytes at that place cannot be a record by chance.
    fn vouched(&mut self, at: u64) -> io::Result<bool> {
        let Some(record) = self.record(at)? else { return Ok(false) };
        Ok(match record[0] {
            op::CHUNK => unpack(&record).is_some(),
            // A checksum of zero says that there is none.
            op::ATTACHMENT => {
                matches!(parse(&record), Some(Record::Attachment { crc, .. }) if crc != 0)
            }
            _ => parse(&record).is_some() && self.is_head(at + record.len() as u64)?,
        })
    }

    fn bytes(&mut self, at: u64, length: usize) -> io::Result<Vec<u8>> {
        let mut bytes = vec![0; length];
        self.file.seek(SeekFrom::Start(at))?;
        self.file.read_exact(&mut bytes)?;
        Ok(bytes)
    }
}
