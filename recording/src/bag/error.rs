//! What can go wrong with a bag.

use std::{io, path::PathBuf};

use msgs::cdr::CdrError;

use files::{is_of_the_path, said};

/// A bag that cannot be written or read. Each message names the file, what was expected and how to
/// mend it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BagError {
    /// The folder for a new bag is there and holds something.
    #[error(
        "the bag cannot be written to {}: the folder is not empty; name a new folder, or empty this one first",
        path.display()
    )]
    NotEmpty {
        /// The folder.
        path: PathBuf,
    },
    /// The folder's name cannot name a file.
    #[error(
        "the bag cannot be written to {}: expected a folder whose last part is a plain UTF-8 name, as in runs/bag",
        path.display()
    )]
    Name {
        /// The folder.
        path: PathBuf,
    },
    /// A file or folder cannot be created or written.
    #[error(
        "the bag cannot be written to {}: {}; check that the folder may be written and that the disk has room",
        path.display(),
        said(source)
    )]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The MCAP library refused to write.
    #[error(
        "the bag {} cannot be written further: {}; what was written before is kept, and can be recovered once the disk has room", path.display(), said(source.as_ref())
    )]
    WriteMcap {
        /// The file.
        path: PathBuf,
        /// What the library said.
        source: Box<mcap::McapError>,
    },
    /// The description of the bag could not be put into YAML.
    #[error("the description of the bag cannot be written to {}: {detail}", path.display())]
    Describe {
        /// The file.
        path: PathBuf,
        /// What the YAML library said.
        detail: String,
    },
    /// A topic carries one type only.
    #[error(
        "the topic {topic} of the bag carries {expected}, but a {found} came; use another topic for it"
    )]
    TopicType {
        /// The topic.
        topic: String,
        /// Type it was opened with.
        expected: String,
        /// Type that came.
        found: String,
    },
    /// A file or folder cannot be read.
    #[error(
        "the bag {} cannot be read: {source}; name a bag folder, or an .mcap or .db3 file that exists and may be read",
        path.display()
    )]
    Read {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A folder without an MCAP file.
    #[error(
        "{} holds no bag: expected a folder with an .mcap or .db3 file and a metadata.yaml; name the folder a run wrote, \
         as in runs/NAME/bag",
        path.display()
    )]
    NoMcap {
        /// The folder.
        path: PathBuf,
    },
    /// A file without a byte in it.
    #[error(
        "the bag {} is empty (0 bytes): the recording stopped before anything was written; record it again",
        path.display()
    )]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// A file of some other kind.
    #[error(
        "{} is not an MCAP file: expected the eight bytes 89 'MCAP0' 0d 0a at its start; name an .mcap file or a bag \
         folder, and convert older bags first (`ros2 bag convert`)",
        path.display()
    )]
    NotMcap {
        /// The file.
        path: PathBuf,
    },
    /// A file that stops short or is damaged.
    #[error(
        "the bag {} is cut off or damaged ({detail}): expected an MCAP file that was closed at its end; \
         what is whole can be recovered",
        path.display()
    )]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        detail: String,
    },
    /// A bag in SQLite that cannot be read.
    #[error(
        "the bag {} cannot be read as a database of rosbag2: {detail}; `ros2 bag convert` may still read it", path.display()
    )]
    Database {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        detail: String,
    },
    /// A bag of several files.
    #[error("the bag {} has {files} MCAP files, but one was expected; recover them one by one, naming the file", path.display())]
    SeveralFiles {
        /// The folder.
        path: PathBuf,
        /// How many.
        files: usize,
    },
    /// Some program holds the file's lock.
    #[error("the bag {} is being written; wait until that run has ended, then recover it if need be", path.display())]
    InUse {
        /// The file.
        path: PathBuf,
    },
    /// A topic that the bag does not have.
    #[error("the bag {} has no topic {topic}; it has: {present}", path.display())]
    NoTopic {
        /// The bag.
        path: PathBuf,
        /// Topic that was asked for.
        topic: String,
        /// Topics it has, with commas.
        present: String,
    },
    /// A topic of another type than was asked for.
    #[error("the topic {topic} of the bag {} carries {found}, but {expected} was expected; name another topic", path.display())]
    ReadType {
        /// The bag.
        path: PathBuf,
        /// The topic.
        topic: String,
        /// Type that was asked for.
        expected: String,
        /// Type in the bag, or `messages without a type`.
        found: String,
    },
    /// A message whose bytes are not of its type.
    #[error("message {index} of {topic} in the bag {} cannot be read: {source}", path.display())]
    Message {
        /// The bag.
        path: PathBuf,
        /// The topic.
        topic: String,
        /// Number of the message in its topic, from 0.
        index: usize,
        /// What is wrong with it.
        source: CdrError,
    },
    /// A message that cannot be turned into bytes.
    #[error(transparent)]
    Encode(#[from] CdrError),
}

impl BagError {
    /// Whether whoever named the bag, or a topic of it, can mend it. What cannot be written further
    /// is no such thing.
    #[must_use]
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Write { source, .. } | Self::Read { source, .. } => is_of_the_path(source),
            Self::NotEmpty { .. }
            | Self::Name { .. }
            | Self::NoMcap { .. }
            | Self::Empty { .. }
            | Self::NotMcap { .. }
            | Self::Damaged { .. }
            | Self::Database { .. }
            | Self::SeveralFiles { .. }
            | Self::InUse { .. }
            | Self::NoTopic { .. }
            | Self::ReadType { .. }
            | Self::Message { .. } => true,
            Self::WriteMcap { .. }
            | Self::Describe { .. }
            | Self::TopicType { .. }
            | Self::Encode(_) => false,
        }
    }
}
