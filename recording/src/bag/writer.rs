//! Writes a bag.

use std::{
    collections::{BTreeMap, HashMap},
    fs, io,
    path::{Path, PathBuf},
};

use mcap::records::MessageHeader;
use msgs::{RosMessage, cdr, topics};

use super::{
    BagError, BagOptions, BagSummary, heard,
    metadata::{TopicEntry, entry_of, qos_yaml},
    output::{Close, Output},
};

/// A topic of a bag that is being written; only good for the [`BagWriter`] it came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct TopicHandle(usize);

/// A bag that is being written.
///
/// It keeps no thread and never waits for anything but the disk; a single write can take some 20
/// ms, so nobody with a deadline should hold it. Dropped without [`finish`](Self::finish), it
/// closes the MCAP file as well as it can, but writes no `metadata.yaml`; killed, it leaves every
/// chunk that was [flushed](Self::flush).
pub struct BagWriter {
    dir: PathBuf,
    file: PathBuf,
    file_name: String,
    output: Output,
    topics: Vec<Channel>,
    by_name: HashMap<String, TopicHandle>,
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
    /// [`BagError::NotEmpty`] if the folder holds something, [`BagError::Name`] if its name cannot
    /// name a file, [`BagError::Write`] if it cannot be written.
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
        let output = Output::create(&file, &options)?;
        Ok(Self {
            dir: dir.into(),
            file,
            file_name,
            output,
            topics: Vec::new(),
            by_name: HashMap::new(),
            scratch: Vec::with_capacity(256),
        })
    }

    /// Opens a topic, or finds it again. Its quality of service is that of [`msgs::topics`].
    ///
    /// # Errors
    /// [`BagError::TopicType`] if the topic was opened with another type, [`BagError::WriteMcap`]
    /// if writing fails.
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
        let schema = M::schema();
        let id = self.output.channel(
            name,
            (&type_name, "ros2msg", schema.as_bytes()),
            "cdr",
            &metadata,
        )?;
        let entry = entry_of(name, &type_name, &metadata);
        let handle = TopicHandle(self.topics.len());
        self.topics.push(Channel { entry, id, sequence: 0 });
        self.by_name.insert(name.into(), handle);
        Ok(handle)
    }

    /// Writes a message, opening its topic at the first. `stamp_ns` is its time, in nanoseconds
    /// since the epoch.
    ///
    /// # Errors
    /// Those of [`topic`](Self::topic) and [`write_cdr`](Self::write_cdr); [`BagError::Encode`].
    pub fn write<M: RosMessage>(
        &mut self,
        topic: &str,
        stamp_ns: u64,
        message: &M,
    ) -> Result<(), BagError> {
        let handle = self.topic::<M>(topic)?;
        let mut bytes = std::mem::take(&mut self.scratch);
        let sequence = self.topics[handle.0].sequence;
        let result = cdr::encode_into(message, &mut bytes)
            .map_err(BagError::from)
            .and_then(|()| self.write_cdr(handle, stamp_ns, sequence, &bytes));
        self.scratch = bytes;
        result
    }

    /// Writes a message that was encoded elsewhere by [`cdr::encode`](msgs::cdr::encode), so that
    /// several threads can share that work. `sequence` numbers the messages of a topic;
    /// [`write`](Self::write) goes on behind it.
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
        let header = MessageHeader {
            channel_id: channel.id,
            sequence,
            log_time: stamp_ns,
            publish_time: stamp_ns,
        };
        self.output.message(channel.id, &header, bytes)?;
        heard::hear(&channel.entry.name, stamp_ns, bytes);
        channel.entry.count += 1;
        channel.sequence = sequence.wrapping_add(1);
        Ok(())
    }

    /// Keeps a whole file with the bag: the protocol, a parameter file.
    ///
    /// # Errors
    /// [`BagError::WriteMcap`] if the disk refuses.
    pub fn attach(&mut self, name: &str, media_type: &str, bytes: &[u8]) -> Result<(), BagError> {
        let stamp = self.output.end();
        let attachment = mcap::Attachment {
            log_time: stamp,
            create_time: stamp,
            name: name.into(),
            media_type: media_type.into(),
            data: bytes.into(),
        };
        self.output.attach(&attachment)
    }

    /// Keeps named texts with the bag: the seed, the version of the program.
    ///
    /// # Errors
    /// [`BagError::WriteMcap`] if the disk refuses.
    pub fn metadata(
        &mut self,
        name: &str,
        entries: BTreeMap<String, String>,
    ) -> Result<(), BagError> {
        self.output.metadata(&mcap::records::Metadata { name: name.into(), metadata: entries })
    }

    /// Closes the present chunk and hands everything to the system, so that it outlives the
    /// program, but not a power cut: that only [`finish`](Self::finish) waits for. Two times a
    /// second is often enough; each time costs some packing.
    ///
    /// # Errors
    /// [`BagError::WriteMcap`] if the disk refuses.
    pub fn flush(&mut self) -> Result<(), BagError> {
        self.output.flush()
    }

    /// Brings what was [flushed](Self::flush) to the disk, where it outlives a power cut.
    ///
    /// # Errors
    /// [`BagError::Write`] if the disk refuses.
    pub fn sync(&self) -> Result<(), BagError> {
        let synced =
            fs::File::options().append(true).open(&self.file).and_then(|file| file.sync_data());
        synced.map_err(|source| BagError::Write { path: self.file.clone(), source })
    }

    /// Closes the bag, brings it to the disk and describes it in `metadata.yaml`.
    ///
    /// # Errors
    /// [`BagError::WriteMcap`] or [`BagError::Write`] if the disk refuses.
    pub fn finish(self) -> Result<BagSummary, BagError> {
        let Self { dir, file, file_name, output, topics, .. } = self;
        let entries = topics.into_iter().map(|channel| channel.entry).collect();
        let (summary, description) =
            output.finish(Close { dir: &dir, file: &file, file_name: &file_name, entries })?;
        description.write()?;
        Ok(summary)
    }
}
