//! The MCAP file of a bag while it is written, whatever is written into it.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use mcap::WriteOptions;
use mcap::records::{MessageHeader, Metadata};

use super::metadata::{Span, TopicEntry, metadata_yaml};
use super::{BagError, BagOptions, BagSummary, Compression};
use files::durable::write_one;

/// An MCAP file as rosbag2 writes it. As long as it is open, its lock tells others that somebody
/// writes.
pub(super) struct Output {
    path: PathBuf,
    mcap: mcap::Writer<BufWriter<File>>,
    span: Span,
}

/// What [`Output::finish`] needs to describe the bag.
pub(super) struct Close<'a> {
    /// Folder of the bag.
    pub(super) dir: &'a Path,
    /// The file, where it will be.
    pub(super) file: &'a Path,
    /// Its name.
    pub(super) file_name: &'a str,
    /// The topics.
    pub(super) entries: Vec<TopicEntry>,
}

/// What `metadata.yaml` is to say.
pub(super) struct Description {
    path: PathBuf,
    yaml: String,
}

impl Description {
    /// Writes it, whole or not at all.
    pub(super) fn write(self) -> Result<(), BagError> {
        let Self { path, yaml } = self;
        write_one(&path, yaml.as_bytes()).map_err(|source| BagError::Write { path, source })
    }
}

impl Output {
    /// Makes the file, which must not be there.
    pub(super) fn create(path: &Path, options: &BagOptions) -> Result<Self, BagError> {
        let handle = File::create_new(path)
            .map_err(|source| BagError::Write { path: path.into(), source })?;
        // A file system without locks only costs the warning to whoever would recover this file
        // meanwhile.
        let _ = handle.try_lock();
        let compression = match options.compression {
            Compression::None => None,
            Compression::Lz4 => Some(mcap::Compression::Lz4),
            Compression::Zstd => Some(mcap::Compression::Zstd),
        };
        let mcap = WriteOptions::new()
            .profile("ros2")
            .library(options.library.clone())
            .compression(compression)
            .compression_level(1)
            // Packing happens on the caller's thread: the other cores have loops to run.
            .compression_threads(0)
            .chunk_size(Some(options.chunk_size))
            .create(BufWriter::with_capacity(1 << 18, handle))
            .map_err(|source| BagError::WriteMcap {
                path: path.into(),
                source: Box::new(source),
            })?;
        Ok(Self { path: path.into(), mcap, span: None })
    }

    /// Opens a channel: topic, name and text of its type, and what else is said about it.
    pub(super) fn channel(
        &mut self,
        topic: &str,
        (type_name, encoding, text): (&str, &str, &[u8]),
        message_encoding: &str,
        about: &BTreeMap<String, String>,
    ) -> Result<u16, BagError> {
        // A channel of messages without a type has the schema number 0.
        let schema = if type_name.is_empty() {
            Ok(0)
        } else {
            self.mcap.add_schema(type_name, encoding, text)
        };
        let id =
            schema.and_then(|schema| self.mcap.add_channel(schema, topic, message_encoding, about));
        id.map_err(|source| self.error(source))
    }

    /// Writes a message to the channel with that number.
    pub(super) fn message(
        &mut self,
        channel_id: u16,
        header: &MessageHeader,
        data: &[u8],
    ) -> Result<(), BagError> {
        let header = MessageHeader { channel_id, ..*header };
        self.mcap.write_to_known_channel(&header, data).map_err(|source| self.error(source))?;
        let stamp = header.log_time;
        self.span = Some(self.span.map_or((stamp, stamp), |(a, b)| (a.min(stamp), b.max(stamp))));
        Ok(())
    }

    /// Time of the last message so far [ns since the epoch]; 0 without any.
    pub(super) fn end(&self) -> u64 {
        self.span.map_or(0, |(_, end)| end)
    }

    /// Keeps a file with the bag.
    pub(super) fn attach(&mut self, attachment: &mcap::Attachment<'_>) -> Result<(), BagError> {
        self.mcap.attach(attachment).map_err(|source| self.error(source))
    }

    /// Keeps named texts with the bag.
    pub(super) fn metadata(&mut self, metadata: &Metadata) -> Result<(), BagError> {
        self.mcap.write_metadata(metadata).map_err(|source| self.error(source))
    }

    /// Closes the present chunk and hands everything to the system.
    pub(super) fn flush(&mut self) -> Result<(), BagError> {
        self.mcap.flush().map_err(|source| self.error(source))
    }

    /// Closes the file and brings it to the disk. The description belongs beside it, once it has
    /// its name.
    pub(super) fn finish(self, close: Close<'_>) -> Result<(BagSummary, Description), BagError> {
        let Self { path, mut mcap, span } = self;
        let Close { dir, file, file_name, entries } = close;
        let mcap_error =
            |source| BagError::WriteMcap { path: path.clone(), source: Box::new(source) };
        let description = dir.join("metadata.yaml");
        let yaml = metadata_yaml(file_name, &entries, span)
            .map_err(|e| BagError::Describe { path: description.clone(), detail: e.to_string() })?;
        // rosbag2 keeps the description inside the file too, for those who get the file without its
        // folder.
        let inside = BTreeMap::from([("serialized_metadata".to_owned(), yaml.clone())]);
        mcap.write_metadata(&Metadata { name: "rosbag2".into(), metadata: inside })
            .map_err(mcap_error)?;
        mcap.finish().map_err(mcap_error)?;
        let write_error = |source: io::Error| BagError::Write { path: path.clone(), source };
        let handle = mcap.into_inner().into_inner().map_err(|e| write_error(e.into_error()))?;
        let bytes = handle.metadata().map_err(write_error)?.len();
        // Whoever sees a description finds the messages on the disk, after a power cut too.
        handle.sync_all().map_err(write_error)?;
        drop(handle);
        let summary = BagSummary {
            messages: entries.iter().map(|entry| entry.count).sum(),
            duration: span.map_or(0.0, |(start, end)| (end - start) as f64 * 1e-9),
            topics: entries
                .into_iter()
                .map(|entry| (entry.name, entry.type_name, entry.count))
                .collect(),
            dir: dir.into(),
            file: file.into(),
            bytes,
        };
        Ok((summary, Description { path: description, yaml }))
    }

    fn error(&self, source: mcap::McapError) -> BagError {
        BagError::WriteMcap { path: self.path.clone(), source: Box::new(source) }
    }
}
