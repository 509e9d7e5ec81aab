//! Writes a bag.

use std::{
    collections::{BTreeMap, HashMap},
    fs::{self, File},
    io::{self, BufWriter},
    path::{Path, PathBuf},
};

use mcap::{WriteOptions, records::MessageHeader};
use msgs::{RosMessage, cdr, topics};

use super::{
    BagError,
    metadata::{Span, TopicEntry, metadata_yaml, qos_yaml},
};

/// How chunks of messages are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Compression {
    /// Not at all.
    None,
    /// LZ4, for readers that have nothing else.
    Lz4,
    /// Zstandard at its fastest level: on the loop's messages a fifth smaller than LZ4 for a tenth of the speed, which is
    /// still above a million messages a second.
    #[default]
    Zstd,
}

/// How a bag is written. The default suits recordings of the laboratory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BagOptions {
    /// Packing of the chunks.
    pub compression: Compression,
    /// Bytes of messages, before packing, that make a chunk.
    pub chunk_size: u64,
    /// Program and version that wrote the bag.
    pub library: String,
}

impl Default for BagOptions {
    fn default() -> Self {
        Self {
            compression: Compression::default(),
            chunk_size: 1 << 20,
            library: concat!("frictionlab ", env!("CARGO_PKG_VERSION")).to_owned(),
        }
    }
}

/// A topic of a bag that is being written; only good for the [`BagWriter`] it came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct TopicHandle(usize);

/// What a finished bag holds.
#[derive(Debug, Clone, PartialEq)]
pub struct BagSummary {
    /// The folder.
    pub dir: PathBuf,
    /// The MCAP file in it.
    pub file: PathBuf,
    /// Size of the MCAP file.
    pub bytes: u64,
    /// Messages of all topics.
    pub messages: u64,
    /// Time between the first and the last message [s].
    pub duration: f64,
    /// Name, type and number of messages of each topic, in order of their opening.
    pub topics: Vec<(String, String, u64)>,
}

/// A bag that is being written.
///
/// It keeps no thread and never waits for anything but the disk; a single write can take some 20 ms, so nobody with a
/// deadline should hold it. Dropped without [`finish`](Self::finish), it closes the MCAP file as well as it can, but
/// writes no `metadata.yaml`; killed, it leaves every chunk that was [flushed](Self::flush).
pub struct BagWriter {
    dir: PathBuf,
    file: PathBuf,
    file_name: String,
    mcap: mcap::Writer<BufWriter<File>>,
    topics: Vec<Channel>,
    by_name: HashMap<String, TopicHandle>,
    span: Span,
    scratch: Vec<u8>,
}

struct Channel {
    entry: TopicEntry,
    id: u16,
    sequence: u32,
}

impl BagWriter {
    /// Starts a bag in the folder, which is made if it is not there.
    ///
    /// # Errors
    /// [`BagError::NotEmpty`] if the folder holds something, [`BagError::Name`] if its name cannot name a file,
    /// [`BagError::Write`] if it cannot be written.
    pub fn create(dir: &Path, options: BagOptions) -> Result<Self, BagError> {
        let name = dir
            .file_name()
            .and_then(|name| name.to_str())
            .ok_or_else(|| BagError::Name { path: dir.into() })?;
        let file_name = format!("{name}_0.mcap");
        let file = dir.join(&file_name);
        let write_error = |path: &Path| {
            let path = path.to_owned();
            move |source: io::Error| BagError::Write { path, source }
        };
        fs::create_dir_all(dir).map_err(write_error(dir))?;
        if fs::read_dir(dir).map_err(write_error(dir))?.next().is_some() {
            return Err(BagError::NotEmpty { path: dir.into() });
        }
        let handle = File::create_new(&file).map_err(write_error(&file))?;
        let compression = match options.compression {
            Compression::None => None,
            Compression::Lz4 => Some(mcap::Compression::Lz4),
            Compression::Zstd => Some(mcap::Compression::Zstd),
        };
        let mcap = WriteOptions::new()
            .profile("ros2")
            .library(options.library)
            .compression(compression)
            .compression_level(1)
            // Packing happens on the caller's thread: the other cores have loops to run.
            .compression_threads(0)
            .chunk_size(Some(options.chunk_size))
            .create(BufWriter::with_capacity(1 << 18, handle))
            .map_err(|source| BagError::WriteMcap { path: file.clone(), source: Box::new(source) })?;
        Ok(Self {
            dir: dir.into(),
            file,
            file_name,
            mcap,
            topics: Vec::new(),
            by_name: HashMap::new(),
            span: None,
            scratch: Vec::with_capacity(256),
        })
    }

    /// Opens a topic, or finds it again. Its quality of service is that of [`msgs::topics`].
    ///
    /// # Errors
    /// [`BagError::TopicType`] if the topic was opened with another type, [`BagError::WriteMcap`] if writing fails.
    pub fn topic<M: RosMessage>(&mut self, name: &str) -> Result<TopicHandle, BagError> {
        if let Some(&handle) = self.by_name.get(name) {
            let entry = &self.topics[handle.0].entry;
            if entry.type_hash == M::TYPE_HASH {
                return Ok(handle);
            }
            return Err(BagError::TopicType {
                topic: name.into(),
                expected: entry.type_name.clone(),
                found: M::type_name(),
            });
        }
        let qos = topics::qos_of(name);
        let profiles = qos_yaml(qos)
            .map_err(|e| BagError::Describe { path: self.file.clone(), detail: e.to_string() })?;
        let metadata = BTreeMap::from([
            ("offered_qos_profiles".to_owned(), profiles),
            ("topic_type_hash".to_owned(), M::TYPE_HASH.to_owned()),
        ]);
        let type_name = M::type_name();
        let id = self
            .mcap
            .add_schema(&type_name, "ros2msg", M::schema().as_bytes())
            .and_then(|schema| self.mcap.add_channel(schema, name, "cdr", &metadata))
            .map_err(|source| self.mcap_error(source))?;
        let entry = TopicEntry { name: name.into(), type_name, type_hash: M::TYPE_HASH, qos, count: 0 };
        let handle = TopicHandle(self.topics.len());
        self.topics.push(Channel { entry, id, sequence: 0 });
        self.by_name.insert(name.into(), handle);
        Ok(handle)
    }

    /// Writes a message, opening its topic at the first. `stamp_ns` is its time, in nanoseconds since the epoch.
    ///
    /// # Errors
    /// Those of [`topic`](Self::topic) and [`write_cdr`](Self::write_cdr); [`BagError::Encode`].
    pub fn write<M: RosMessage>(&mut self, topic: &str, stamp_ns: u64, message: &M) -> Result<(), BagError> {
        let handle = self.topic::<M>(topic)?;
        let mut bytes = std::mem::take(&mut self.scratch);
        let sequence = self.topics[handle.0].sequence;
        let result = cdr::encode_into(message, &mut bytes)
            .map_err(BagError::from)
            .and_then(|()| self.write_cdr(handle, stamp_ns, sequence, &bytes));
        self.scratch = bytes;
        result
    }

    /// Writes a message that was encoded elsewhere by [`cdr::encode`](msgs::cdr::encode), so that several threads can
    /// share that work. `sequence` numbers the messages of a topic; [`write`](Self::write) goes on behind it.
    ///
    /// # Errors
    /// [`BagError::WriteMcap`] if the disk refuses.
    pub fn write_cdr(
        &mut self,
        topic: TopicHandle,
        stamp_ns: u64,
        sequence: u32,
        bytes: &[u8],
    ) -> Result<(), BagError> {
        let channel = &mut self.topics[topic.0];
        let header =
            MessageHeader { channel_id: channel.id, sequence, log_time: stamp_ns, publish_time: stamp_ns };
        if let Err(source) = self.mcap.write_to_known_channel(&header, bytes) {
            return Err(self.mcap_error(source));
        }
        channel.entry.count += 1;
        channel.sequence = sequence.wrapping_add(1);
        self.span = Some(self.span.map_or((stamp_ns, stamp_ns), |(a, b)| (a.min(stamp_ns), b.max(stamp_ns))));
        Ok(())
    }

    /// Keeps a whole file with the bag: the protocol, a parameter file.
    ///
    /// # Errors
    /// [`BagError::WriteMcap`] if the disk refuses.
    pub fn attach(&mut self, name: &str, media_type: &str, bytes: &[u8]) -> Result<(), BagError> {
        let stamp = self.span.map_or(0, |(_, end)| end);
        let attachment = mcap::Attachment {
            log_time: stamp,
            create_time: stamp,
            name: name.into(),
            media_type: media_type.into(),
            data: bytes.into(),
        };
        self.mcap.attach(&attachment).map_err(|source| self.mcap_error(source))
    }

    /// Keeps named texts with the bag: the seed, the version of the program.
    ///
    /// # Errors
    /// [`BagError::WriteMcap`] if the disk refuses.
    pub fn metadata(&mut self, name: &str, entries: BTreeMap<String, String>) -> Result<(), BagError> {
        let metadata = mcap::records::Metadata { name: name.into(), metadata: entries };
        self.mcap.write_metadata(&metadata).map_err(|source| self.mcap_error(source))
    }

    /// Closes the present chunk and hands everything to the system, so that it outlives the program. Two times a
    /// second is often enough; each time costs some packing.
    ///
    /// # Errors
    /// [`BagError::WriteMcap`] if the disk refuses.
    pub fn flush(&mut self) -> Result<(), BagError> {
        self.mcap.flush().map_err(|source| self.mcap_error(source))
    }

    /// Closes the bag and describes it in `metadata.yaml`.
    ///
    /// # Errors
    /// [`BagError::WriteMcap`] or [`BagError::Write`] if the disk refuses.
    pub fn finish(self) -> Result<BagSummary, BagError> {
        let Self { dir, file, file_name, mut mcap, topics, span, .. } = self;
        let mcap_error = |source| BagError::WriteMcap { path: file.clone(), source: Box::new(source) };
        let entries: Vec<TopicEntry> = topics.into_iter().map(|channel| channel.entry).collect();
        let description = dir.join("metadata.yaml");
        let yaml = metadata_yaml(&file_name, &entries, span)
            .map_err(|e| BagError::Describe { path: description.clone(), detail: e.to_string() })?;
        // rosbag2 keeps the description inside the file too, for those who get the file without its folder.
        let inside = BTreeMap::from([("serialized_metadata".to_owned(), yaml.clone())]);
        mcap.write_metadata(&mcap::records::Metadata { name: "rosbag2".into(), metadata: inside })
            .map_err(mcap_error)?;
        mcap.finish().map_err(mcap_error)?;
        let write_error = |source| BagError::Write { path: file.clone(), source };
        let handle = mcap.into_inner().into_inner().map_err(|e| write_error(e.into_error()))?;
        let bytes = handle.metadata().map_err(write_error)?.len();
        drop(handle);
        fs::write(&description, yaml).map_err(|source| BagError::Write { path: description, source })?;
        Ok(BagSummary {
            messages: entries.iter().map(|entry| entry.count).sum(),
            duration: span.map_or(0.0, |(start, end)| (end - start) as f64 * 1e-9),
            topics: entries.into_iter().map(|entry| (entry.name, entry.type_name, entry.count)).collect(),
            dir,
            file,
            bytes,
        })
    }

    fn mcap_error(&self, source: mcap::McapError) -> BagError {
        BagError::WriteMcap { path: self.file.clone(), source: Box::new(source) }
    }
}
