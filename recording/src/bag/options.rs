//! How a bag is written, and what is left when it is.

use std::path::PathBuf;

/// How chunks of messages are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Compression {
    /// Not at all.
    None,
    /// LZ4, for readers that have nothing else.
    Lz4,
    /// Zstandard at its fastest level: on the loop's messages a fifth smaller than LZ4 for a tenth
    /// of the speed, which is still above a million messages a second.
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
    /// Time between the first and the last message \[s\].
    pub duration: f64,
    /// Name, type and number of messages of each topic, in order of their opening.
    pub topics: Vec<(String, String, u64)>,
}
