//! The messages of an MCAP file from a moment on: the index at its end tells where to begin.

use std::collections::BTreeMap;
use std::io::{BufReader, Read, Seek, SeekFrom, Take};
use std::sync::Arc;

use mcap::records::{MessageHeader, Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader};
use mcap::{McapError, McapResult};

use super::BagError;
use super::mcap_file::read_error;
use super::read_at::ReadAt;
use super::reader::{OpenFile, options};

/// What is read at once \[bytes\].
const AT_ONCE: usize = 1 << 18;

/// Messages from a chunk of the file on, in the order in which they lie there.
pub(super) struct Placed<'a> {
    bytes: BufReader<Take<Box<dyn ReadAt>>>,
    reader: LinearReader,
    channels: &'a BTreeMap<u16, Arc<mcap::Channel<'static>>>,
}

impl<'a> Placed<'a> {
    /// Messages of a file from that time \[ns since the epoch\] on, and a few before it.
    ///
    /// # Errors
    /// [`BagError::Read`].
    pub(super) fn from(
        file: &OpenFile,
        channels: &'a BTreeMap<u16, Arc<mcap::Channel<'static>>>,
        start: u64,
    ) -> Result<Self, BagError> {
        let (mut bytes, size) = file.file.read()?;
        // An index that points beyond the file points nowhere.
        let place = place(file, start).filter(|place| *place < size);
        let begin = place.unwrap_or(0);
        bytes.seek(SeekFrom::Start(begin)).map_err(read_error(&file.file.path))?;
        let options = options().with_skip_start_magic(place.is_some());
        Ok(Self {
            bytes: BufReader::with_capacity(AT_ONCE, bytes.take(size - begin)),
            reader: LinearReader::new_with_options(options),
            channels,
        })
    }

    /// The next message: its channel, its time \[ns since the epoch\], its bytes.
    ///
    /// # Errors
    /// [`McapError`] for what is damaged.
    pub(super) fn next(
        &mut self,
    ) -> McapResult<Option<(&'a mcap::Channel<'static>, u64, Vec<u8>)>> {
        while let Some(event) = self.reader.next_event() {
            match event? {
                LinearReadEvent::ReadRequest(need) => {
                    let read = self.bytes.read(self.reader.insert(need))?;
                    self.reader.notify_read(read);
                }
                LinearReadEvent::Record { opcode: op::MESSAGE, data } => {
                    let Record::Message { header, data } = mcap::parse_record(op::MESSAGE, data)?
                    else {
                        continue;
                    };
                    let MessageHeader { channel_id, sequence, log_time, .. } = header;
                    let channel = self.channels.get(&channel_id);
                    let channel = channel.ok_or(McapError::UnknownChannel(sequence, channel_id))?;
                    return Ok(Some((channel, log_time, data.into_owned())));
                }
                // What is behind it is no message.
                LinearReadEvent::Record { opcode: op::DATA_END, .. } => return Ok(None),
                LinearReadEvent::Record { .. } => {}
            }
        }
        Ok(None)
    }
}

/// Where the first chunk begins that has a message of that time or later: nothing where no index
/// tells, and the file is read from its beginning.
fn place(file: &OpenFile, start: u64) -> Option<u64> {
    let later = file.summary.chunk_indexes.iter().filter(|chunk| chunk.message_end_time >= start);
    later.map(|chunk| chunk.chunk_start_offset).min()
}
