//! A bag as it happened: every message as bytes, one after the other.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::Arc;

use super::guard::guarded;
use super::placed::Placed;
use super::reader::{BagReader, damaged};
use super::{BagError, salvage::LARGEST_RECORD, sqlite};

/// A topic as the bag describes it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordedTopic {
    /// Its name.
    pub name: String,
    /// Its type, as in `sensor_msgs/msg/JointState`.
    pub type_name: String,
    /// How its messages are written, as in `cdr`.
    pub encoding: String,
    /// How its schema is written, as in `ros2msg`.
    pub schema_encoding: String,
    /// What its messages have in them.
    pub schema: String,
}

/// A message as it was recorded.
#[derive(Debug, Clone, Copy)]
pub struct RecordedMessage<'a> {
    /// Name of its topic.
    pub topic: &'a str,
    /// When it was recorded \[ns since the epoch\].
    pub time: u64,
    /// What it says.
    pub bytes: &'a [u8],
}

impl BagReader {
    /// The topics of the bag's MCAP files, with their schemas; none for a bag of Humble.
    #[must_use]
    pub fn recorded_topics(&self) -> Vec<RecordedTopic> {
        let mut topics = BTreeMap::new();
        for file in &self.files {
            for channel in file.summary.channels.values() {
                let schema = channel.schema.as_ref();
                let text = |of: fn(&mcap::Schema<'_>) -> String| {
                    schema.map(|schema| of(schema)).unwrap_or_default()
                };
                topics.entry(channel.topic.clone()).or_insert_with(|| RecordedTopic {
                    name: channel.topic.clone(),
                    type_name: text(|schema| schema.name.clone()),
                    encoding: channel.message_encoding.clone(),
                    schema_encoding: text(|schema| schema.encoding.clone()),
                    schema: text(|schema| String::from_utf8_lossy(&schema.data).into_owned()),
                });
            }
        }
        topics.into_values().collect()
    }

    /// Hands over every message from `start` \[ns since the epoch\] on, in the order of the files,
    /// until `take` breaks. The file's index tells where to begin, so that a late `start` costs no more
    /// than an early one. Returns whether it came to the end.
    ///
    /// # Errors
    /// [`BagError::Read`] or [`BagError::Damaged`]; what came before was handed over.
    pub fn play(
        &self,
        start: u64,
        mut take: impl FnMut(RecordedMessage<'_>) -> ControlFlow<()>,
    ) -> Result<bool, BagError> {
        for file in &self.files {
            let path = &file.file.path;
            let later = file.summary.stats.as_ref();
            if later.is_some_and(|stats| stats.message_count > 0 && stats.message_end_time < start)
            {
                continue;
            }
            let channels = file.summary.channels.iter();
            let channels = channels.map(|(id, channel)| (*id, Arc::clone(channel))).collect();
            let mut messages = guarded(path, || Placed::from(file, &channels, start))?;
            loop {
                let next = guarded(path, || messages.next().map_err(|error| damaged(path, error)))?;
                let Some((channel, time, data)) = next else { break };
                if time < start {
                    continue;
                }
                let packed = data.starts_with(sqlite::ZSTD);
                let unpacked = packed
                    .then(|| sqlite::unpack(path, &data, LARGEST_RECORD as u64))
                    .transpose()?;
                let bytes = unpacked.as_deref().unwrap_or(&data);
                if take(RecordedMessage { topic: &channel.topic, time, bytes }).is_break() {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use msgs::friction_msgs::MotorVoltage;

    use super::*;
    use crate::bag::{BagOptions, BagWriter};

    /// What lies before the chunk of the moment is not even looked at.
    #[test]
    fn a_late_moment_is_found_by_the_index() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bag");
        let options = BagOptions { chunk_size: 512, ..BagOptions::default() };
        let mut bag = BagWriter::create(&path, options).unwrap();
        for time in 0..1000 {
            let message = MotorVoltage { voltage: time as f64, ..MotorVoltage::default() };
            bag.write("/motor_voltage", time, &message).unwrap();
        }
        bag.finish().unwrap();
        let file = first_mcap(&path);
        let mut bytes = std::fs::read(&file).unwrap();
        let end = bytes.len() / 2;
        // The head of the file, which is read whoever opens it, stays.
        bytes[200..end].fill(0xff);
        std::fs::write(&file, bytes).unwrap();
        let bag = BagReader::open(&path).unwrap();
        let mut times = Vec::new();
        let whole = bag.play(900, |message| {
            times.push(message.time);
            ControlFlow::Continue(())
        });
        assert!(whole.unwrap());
        assert_eq!(times, (900..1000).collect::<Vec<u64>>());
        // From the beginning on, the damage shows.
        assert!(bag.play(0, |_| ControlFlow::Continue(())).is_err());
    }

    fn first_mcap(folder: &std::path::Path) -> std::path::PathBuf {
        let mut files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        files.find(|file| file.extension().is_some_and(|end| end == "mcap")).unwrap()
    }

    #[test]
    fn what_was_written_is_played_from_any_moment() {
        let folder = tempfile::tempdir().unwrap();
        let mut bag = BagWriter::create(&folder.path().join("bag"), BagOptions::default()).unwrap();
        for time in 0..10 {
            let message = MotorVoltage { voltage: time as f64, ..MotorVoltage::default() };
            bag.write("/motor_voltage", time, &message).unwrap();
        }
        bag.finish().unwrap();
        let bag = BagReader::open(&folder.path().join("bag")).unwrap();
        let topics = bag.recorded_topics();
        assert_eq!(topics[0].type_name, "friction_msgs/msg/MotorVoltage");
        assert!(topics[0].schema.contains("float64 voltage"));
        let mut times = Vec::new();
        let end = bag.play(4, |message| {
            times.push(message.time);
            if message.time == 7 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert_eq!((times, end.unwrap()), (vec![4, 5, 6, 7], false));
        assert!(bag.play(9, |_| ControlFlow::Continue(())).unwrap());
    }
}
