//! Reads a bag.

use std::{
    collections::BTreeMap,
    fs,
    io::{self, BufReader, Read, Seek, SeekFrom, Take},
    path::{Path, PathBuf},
};

use mcap::{
    McapError, McapResult, Summary,
    io::MessageReader,
    records::{Channel, SchemaHeader},
    sans_io::{LinearReaderOptions, SummaryReadEvent, SummaryReader, SummaryReaderOptions},
};
use msgs::{RosMessage, cdr};

use super::{
    BagError,
    guard::guarded,
    mcap_file::{McapFile, files_of, read_error},
    read_at::ReadAt,
    salvage::{Found, LARGEST_RECORD, Losses, Salvage},
    schema::{Judgement, judge},
    sqlite::{self, Database},
    topic_info::TopicInfo,
};

/// A bag that is there: a folder as rosbag2 writes it, or a bare `.mcap` or `.db3` file.
#[derive(Debug)]
pub struct BagReader {
    path: PathBuf,
    pub(super) files: Vec<OpenFile>,
    databases: Vec<Database>,
    topics: Vec<TopicInfo>,
}

#[derive(Debug)]
pub(super) struct OpenFile {
    pub(super) file: McapFile,
    pub(super) summary: Summary,
}

impl BagReader {
    /// Opens a bag and looks what is in it.
    ///
    /// # Errors
    /// [`BagError::Read`], [`BagError::NoMcap`], [`BagError::Empty`], [`BagError::NotMcap`],
    /// [`BagError::Damaged`] or [`BagError::Database`], each naming the file.
    pub fn open(path: &Path) -> Result<Self, BagError> {
        let mut topics: BTreeMap<String, TopicInfo> = BTreeMap::new();
        let mut files = Vec::new();
        let databases = sqlite::files_of(path)
            .into_iter()
            .map(Database::open)
            .collect::<Result<Vec<Database>, BagError>>()?;
        for found in databases.iter().flat_map(Database::topics) {
            let topic = topics
                .entry(found.name.clone())
                .or_insert_with(|| TopicInfo { count: 0, ..found.clone() });
            topic.count += found.count;
        }
        let mcap = if databases.is_empty() { files_of(path)? } else { Vec::new() };
        for path in mcap {
            let file = McapFile::open(&path)?;
            let (summary, counts) = guarded(&path, || inspect(&file))?;
            for (id, channel) in &summary.channels {
                let type_name =
                    channel.schema.as_ref().map(|schema| schema.name.clone()).unwrap_or_default();
                let topic = topics.entry(channel.topic.clone()).or_insert_with(|| TopicInfo {
                    name: channel.topic.clone(),
                    type_name,
                    count: 0,
                });
                topic.count += counts.get(id).copied().unwrap_or(0);
            }
            files.push(OpenFile { file, summary });
        }
        Ok(Self { path: path.into(), files, databases, topics: topics.into_values().collect() })
    }

    /// Topics of the bag, by name.
    pub fn topics(&self) -> &[TopicInfo] {
        &self.topics
    }

    /// Size of the files.
    pub fn bytes(&self) -> u64 {
        self.files
            .iter()
            .map(|file| &file.file.path)
            .chain(self.databases.iter().map(|database| &database.path))
            .filter_map(|file| fs::metadata(file).ok())
            .map(|file| file.len())
            .sum()
    }

    /// Times of the first and last message [ns since the epoch], where the files say so and hold
    /// any.
    pub fn span(&self) -> Option<(u64, u64)> {
        let stats = self.files.iter().filter_map(|file| file.summary.stats.as_ref());
        let spans = stats.filter(|stats| stats.message_count > 0);
        spans
            .map(|stats| (stats.message_start_time, stats.message_end_time))
            .chain(self.databases.iter().filter_map(|database| database.span))
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// Names of the files that were kept with the bag.
    pub fn attachment_names(&self) -> impl Iterator<Item = &str> {
        self.files
            .iter()
            .flat_map(|file| &file.summary.attachment_indexes)
            .map(|index| index.name.as_str())
    }

    /// Names under which texts were kept with the bag.
    pub fn metadata_names(&self) -> impl Iterator<Item = &str> {
        self.files
            .iter()
            .flat_map(|file| &file.summary.metadata_indexes)
            .map(|index| index.name.as_str())
    }

    /// All messages of a topic with their log times [ns since the epoch], in order of time.
    ///
    /// # Errors
    /// [`BagError::NoTopic`], [`BagError::ReadType`], [`BagError::Message`], or those of
    /// [`open`](Self::open).
    pub fn messages<M: RosMessage>(&self, topic: &str) -> Result<Vec<(u64, M)>, BagError> {
        let info = self.topics.iter().find(|info| info.name == topic).ok_or_else(|| {
            BagError::NoTopic {
                path: self.path.clone(),
                topic: topic.into(),
                present: self
                    .topics
                    .iter()
                    .map(|info| info.name.as_str())
                    .collect::<Vec<_>>()
                    .join(", "),
            }
        })?;
        if info.type_name != M::type_name() {
            return Err(BagError::ReadType {
                path: self.path.clone(),
                topic: topic.into(),
                expected: M::type_name(),
                found: match info.type_name.as_str() {
                    "" => "messages without a type".into(),
                    name => name.into(),
                },
            });
        }
        let mut messages = Vec::new();
        for file in &self.files {
            guarded(&file.file.path, || self.read_topic(&file.file, topic, &mut messages))?;
        }
        for database in &self.databases {
            database.read_topic(topic, &mut messages)?;
        }
        messages.sort_by_key(|(log_time, _)| *log_time);
        Ok(messages)
    }

    /// Adds the messages of a topic in one file.
    fn read_topic<M: RosMessage>(
        &self,
        file: &McapFile,
        topic: &str,
        messages: &mut Vec<(u64, M)>,
    ) -> Result<(), BagError> {
        for message in message_reader(file, options())? {
            let message = message.map_err(|error| damaged(&file.path, error))?;
            if message.channel.topic != topic {
                continue;
            }
            // Each message may be packed by itself; plain ones begin with a zero.
            let packed = message.data.starts_with(sqlite::ZSTD);
            let unpacked = packed
                .then(|| sqlite::unpack(&file.path, &message.data, LARGEST_RECORD as u64))
                .transpose()?;
            let bytes = unpacked.as_deref().unwrap_or(&message.data);
            let decoded = cdr::decode(bytes).map_err(|source| BagError::Message {
                path: self.path.clone(),
                topic: topic.into(),
                index: messages.len(),
                source,
            })?;
            messages.push((message.log_time, decoded));
        }
        Ok(())
    }

    /// Named texts that were kept with the bag; `None` if there are none of that name.
    ///
    /// # Errors
    /// [`BagError::Read`] or [`BagError::Damaged`].
    pub fn metadata(&self, name: &str) -> Result<Option<BTreeMap<String, String>>, BagError> {
        for file in &self.files {
            if let Some(index) =
                file.summary.metadata_indexes.iter().find(|index| index.name == name)
            {
                let record = record(&file.file, index.offset, index.length)?;
                if let mcap::records::Record::Metadata(metadata) = record {
                    return Ok(Some(metadata.metadata));
                }
                return Err(damaged(&file.file.path, McapError::BadIndex));
            }
        }
        Ok(None)
    }

    /// A file that was kept with the bag; `None` if there is none of that name.
    ///
    /// # Errors
    /// [`BagError::Read`] or [`BagError::Damaged`].
    pub fn attachment(&self, name: &str) -> Result<Option<Vec<u8>>, BagError> {
        for file in &self.files {
            if let Some(index) =
                file.summary.attachment_indexes.iter().find(|index| index.name == name)
            {
                let record = record(&file.file, index.offset, index.length)?;
                if let mcap::records::Record::Attachment { data, .. } = record {
                    return Ok(Some(data.into_owned()));
                }
                return Err(damaged(&file.file.path, McapError::BadIndex));
            }
        }
        Ok(None)
    }
}

pub(super) fn damaged(path: &Path, error: McapError) -> BagError {
    match error {
        McapError::Io(source)
            if source.kind() != io::ErrorKind::UnexpectedEof && source.raw_os_error().is_some() =>
        {
            BagError::Read { path: path.into(), source }
        }
        other => BagError::Damaged { path: path.into(), detail: other.to_string() },
    }
}

/// Whether every message of a file can be read, every checksum is right, every definition is one,
/// and its index says how many messages there are.
pub(super) fn is_whole(path: &Path) -> bool {
    let read = || -> Result<bool, BagError> {
        let file = McapFile::open(path)?;
        let (summary, _) = inspect(&file)?;
        let Some(stats) = summary.stats else { return Ok(false) };
        let mut count = 0;
        let every =
            options().with_validate_data_section_crc(true).with_validate_summary_section_crc(true);
        for message in message_reader(&file, every)? {
            message.map_err(|error| damaged(path, error))?;
            count += 1;
        }
        let mut sound = count == stats.message_count;
        // Checksums may be right and what they vouch for may not be; and those of the sections may
        // be missing.
        let salvage = Salvage::new(file.read()?);
        let take = |found: Found<'_>| -> Result<(), io::Error> {
            if let Found::Message { channel, schema: Some((header, text)), .. } = found {
                sound &= definition(channel, header, text) == Judgement::Sound;
            }
            Ok(())
        };
        let losses = salvage.run(take).map_err(read_error(path))?;
        Ok(sound && losses == Losses { closed: true, ..Losses::default() })
    };
    guarded(path, read).unwrap_or(false)
}

/// What the definition of a channel's type is worth.
pub(super) fn definition(channel: &Channel, header: &SchemaHeader, text: &[u8]) -> Judgement {
    let hash = channel.metadata.get("topic_type_hash").map(String::as_str);
    judge(&header.name, &header.encoding, text, hash)
}

/// Summary of a file and number of messages a channel; read from the end of the file, or counted
/// where it has none.
fn inspect(file: &McapFile) -> Result<(Summary, BTreeMap<u16, u64>), BagError> {
    let (bytes, size) = file.read()?;
    let summary =
        summary(&mut BufReader::new(bytes), size).map_err(|error| damaged(&file.path, error))?;
    if let Some(Summary { stats: Some(stats), .. }) = &summary {
        let counts = stats.channel_message_counts.clone();
        return Ok((summary.unwrap_or_default(), counts));
    }
    let mut found = Summary::default();
    let mut counts = BTreeMap::new();
    for message in message_reader(file, options())? {
        let message = message.map_err(|error| damaged(&file.path, error))?;
        *counts.entry(message.channel.id).or_default() += 1;
        found.channels.entry(message.channel.id).or_insert(message.channel);
    }
    Ok((found, counts))
}

fn summary(file: &mut (impl Read + Seek), size: u64) -> McapResult<Option<Summary>> {
    let options = SummaryReaderOptions::default()
        .with_file_size(size)
        .with_record_length_limit(LARGEST_RECORD);
    let mut reader = SummaryReader::new_with_options(options);
    while let Some(event) = reader.next_event() {
        match event? {
            SummaryReadEvent::ReadRequest(need) => {
                let read = file.read(reader.insert(need))?;
                reader.notify_read(read);
            }
            SummaryReadEvent::SeekRequest(to) => {
                let position = file.seek(to)?;
                reader.notify_seeked(position);
            }
        }
    }
    Ok(reader.finish())
}

/// A chunk whose checksum is wrong is damaged: what it says is not believed.
pub(super) fn options() -> LinearReaderOptions {
    LinearReaderOptions::default()
        .with_record_length_limit(LARGEST_RECORD)
        .with_validate_chunk_crcs(true)
}

/// Messages as they come.
pub(super) type Messages = MessageReader<BufReader<Take<Box<dyn ReadAt>>>>;

/// The messages of a file as long as it was when it was opened: one that grows comes to an end.
pub(super) fn message_reader(
    file: &McapFile,
    options: LinearReaderOptions,
) -> Result<Messages, BagError> {
    let (bytes, length) = file.read()?;
    let bytes = BufReader::with_capacity(1 << 18, bytes.take(length));
    Ok(MessageReader::new_with_options(bytes, options))
}

/// The record at a place that an index of the file names.
fn record(
    file: &McapFile,
    offset: u64,
    length: u64,
) -> Result<mcap::records::Record<'static>, BagError> {
    let path = &file.path;
    let (mut bytes_of, size) = file.read()?;
    // An opcode and eight bytes of length stand before the content.
    let inside = offset.checked_add(length).is_some_and(|end| end <= size);
    let length = usize::try_from(length).ok().filter(|length| inside && *length >= 9);
    let Some(length) = length else { return Err(damaged(path, McapError::BadIndex)) };
    let mut bytes = vec![0; length];
    bytes_of
        .seek(SeekFrom::Start(offset))
        .and_then(|_| bytes_of.read_exact(&mut bytes))
        .map_err(read_error(path))?;
    guarded(path, || {
        mcap::parse_record(bytes[0], &bytes[9..])
            .map(mcap::records::Record::into_owned)
            .map_err(|e| damaged(path, e))
    })
}
