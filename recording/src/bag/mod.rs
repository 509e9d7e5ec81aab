//! Bags: recordings in the form rosbag2 writes them, so that `ros2 bag`, `rosbags`, Foxglove and
//! PlotJuggler open them.
//!
//! A bag is a folder with an MCAP file and a `metadata.yaml`. Messages are CDR, schemas `ros2msg`
//! with all their dependencies; log time is the sample's own time. Bags of older distributions, which
//! are SQLite databases, are read too. [`BagWriter`] writes one,
//! [`BagReader`] reads one, or a bare `.mcap`; [`recover`] saves what is whole of one that was cut
//! off.
//!
//! ```
//! use recording::bag::{BagOptions, BagReader, BagWriter};
//! use msgs::{friction_msgs::MotorVoltage, std_msgs::Header};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir()?;
//! let dir = folder.path().join("bag");
//! let mut bag = BagWriter::create(&dir, BagOptions::default())?;
//! bag.write("/motor_voltage", 1_000, &MotorVoltage { header: Header::at(1_000), voltage: 1.5 })?;
//! bag.finish()?;
//!
//! let messages = BagReader::open(&dir)?.messages::<MotorVoltage>("/motor_voltage")?;
//! assert_eq!(messages[0].1.voltage, 1.5);
//! # Ok(())
//! # }
//! ```

mod error;
mod guard;
mod heard;
mod mcap_file;
mod metadata;
mod options;
mod output;
mod placed;
mod playing;
mod read_at;
mod reader;
mod recover;
#[cfg(test)]
mod recover_tests;
mod remove;
mod salvage;
mod schema;
mod sqlite;
#[cfg(test)]
mod sqlite_tests;
mod table;
#[cfg(test)]
mod tests;
mod topic_info;
mod writer;

pub use error::BagError;

/// How the files of a bag end.
pub(crate) const ENDINGS: [&str; 5] = [".mcap", ".mcap.zstd", ".mcap.zst", ".db3", ".db3.zstd"];

pub use heard::{Listener, listen};
pub use options::{BagOptions, BagSummary, Compression};
pub use playing::{RecordedMessage, RecordedTopic};
pub use reader::BagReader;
pub use recover::{Recovery, cut_bags, is_cut, recover};
pub use remove::remove;
pub use table::{Table, table};
pub use topic_info::TopicInfo;
pub use writer::{BagWriter, TopicHandle};
