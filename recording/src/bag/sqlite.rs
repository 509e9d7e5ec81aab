//! Bags in the storage of rosbag2 up to Humble: SQLite databases with CDR messages.
//!
//! A database may be compressed by zstd as a whole, or each of its messages may be.

use std::{
    fs::{self, File},
    io::{Cursor, Read},
    path::{Path, PathBuf},
};

use msgs::{RosMessage, cdr};
use rusqlite::{Connection, OpenFlags, limits::Limit};

use super::{BagError, salvage::LARGEST_RECORD, topic_info::TopicInfo};

/// What an SQLite database begins with.
const MAGIC: &[u8] = b"SQLite format 3\0";
/// What zstd begins with.
pub(super) const ZSTD: &[u8] = b"\x28\xb5\x2f\xfd";
/// Largest database that is unpacked \[bytes\].
const LARGEST: u64 = files::input::LARGEST_TABLE;

/// A database.
#[derive(Debug)]
pub(super) struct Database {
    pub path: PathBuf,
    topics: Vec<(i64, TopicInfo)>,
    /// First and last time \[ns\].
    pub span: Option<(u64, u64)>,
}

/// The databases of a bag, in order of their names; none where it has another storage.
pub(super) fn files_of(path: &Path) -> Vec<PathBuf> {
    let is_one = |file: &Path| {
        let name = file.to_string_lossy();
        name.ends_with(".db3") || name.ends_with(".db3.zstd")
    };
    if !path.is_dir() {
        let mut start = [0; MAGIC.len()];
        let begins = File::open(path).and_then(|mut file| file.read_exact(&mut start)).is_ok();
        let known = is_one(path) || begins && start == MAGIC;
        return if known { vec![path.into()] } else { Vec::new() };
    }
    let inside = fs::read_dir(path).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut files: Vec<PathBuf> = inside.filter(|file| is_one(file)).collect();
    // One that was unpacked stands beside the packed one.
    let packed_of = |file: &Path| PathBuf::from(format!("{}.zstd", file.display()));
    let unpacked: Vec<PathBuf> = files.iter().map(|file| packed_of(file)).collect();
    files.retain(|file| !unpacked.contains(file));
    // `bag_10.db3` comes behind `bag_9.db3`.
    files.sort_by_key(|file| (file.as_os_str().len(), file.clone()));
    files
}

impl Database {
    /// Opens a database and looks what is in it.
    pub(super) fn open(path: PathBuf) -> Result<Self, BagError> {
        let connection = connect(&path)?;
        let refuse = |error: rusqlite::Error| refused(&path, error.to_string());
        let mut topics = Vec::new();
        let mut of_topics = connection
            .prepare("SELECT id, name, type, serialization_format FROM topics ORDER BY name")
            .map_err(refuse)?;
        let mut rows = of_topics.query([]).map_err(refuse)?;
        while let Some(row) = rows.next().map_err(refuse)? {
            let id: i64 = row.get(0).map_err(refuse)?;
            let name: String = row.get(1).map_err(refuse)?;
            let form: String = row.get(3).map_err(refuse)?;
            if form != "cdr" {
                return Err(refused(
                    &path,
                    format!("topic {name} has messages in {form}, not in cdr"),
                ));
            }
            let count: i64 = connection
                .query_row("SELECT count(*) FROM messages WHERE topic_id = ?1", [id], |row| {
                    row.get(0)
                })
                .map_err(refuse)?;
            let type_name = row.get(2).map_err(refuse)?;
            topics.push((id, TopicInfo { name, type_name, count: count.unsigned_abs() }));
        }
        let span: (Option<i64>, Option<i64>) = connection
            .query_row("SELECT min(timestamp), max(timestamp) FROM messages", [], |row| {
                Ok((row.get(0)?, row.get(1)?))
            })
            .map_err(refuse)?;
        let span = span.0.zip(span.1).map(|(from, to)| (nanoseconds(from), nanoseconds(to)));
        drop(rows);
        drop(of_topics);
        Ok(Self { path, topics, span })
    }

    /// The topics.
    pub(super) fn topics(&self) -> impl Iterator<Item = &TopicInfo> {
        self.topics.iter().map(|(_, topic)| topic)
    }

    /// Adds the messages of a topic.
    pub(super) fn read_topic<M: RosMessage>(
        &self,
        topic: &str,
        messages: &mut Vec<(u64, M)>,
    ) -> Result<(), BagError> {
        let connection = connect(&self.path)?;
        let refuse = |error: rusqlite::Error| refused(&self.path, error.to_string());
        for (id, _) in self.topics.iter().filter(|(_, info)| info.name == topic) {
            let mut of_messages = connection
                .prepare(
                    "SELECT timestamp, data FROM messages WHERE topic_id = ?1 ORDER BY timestamp",
                )
                .map_err(refuse)?;
            let mut rows = of_messages.query([id]).map_err(refuse)?;
            while let Some(row) = rows.next().map_err(refuse)? {
                let time: i64 = row.get(0).map_err(refuse)?;
                let data = row.get_ref(1).map_err(refuse)?;
                let data =
                    data.as_blob().map_err(|error| refused(&self.path, error.to_string()))?;
                let unpacked =
                    data.starts_with(ZSTD).then(|| unpack(&self.path, data, LARGEST_RECORD as u64));
                let unpacked = unpacked.transpose()?;
                let bytes = unpacked.as_deref().unwrap_or(data);
                let message = cdr::decode(bytes).map_err(|source| BagError::Message {
                    path: self.path.clone(),
                    topic: topic.into(),
                    index: messages.len(),
                    source,
                })?;
                messages.push((nanoseconds(time), message));
            }
        }
        Ok(())
    }
}

fn nanoseconds(time: i64) -> u64 {
    u64::try_from(time).unwrap_or(0)
}

/// Opens the database for reading alone.
fn connect(path: &Path) -> Result<Connection, BagError> {
    let read = |source| BagError::Read { path: path.into(), source };
    let refuse = |error: rusqlite::Error| refused(path, error.to_string());
    let mut file = File::open(path).map_err(read)?;
    let size = file.metadata().map_err(read)?.len();
    if size == 0 {
        return Err(BagError::Empty { path: path.into() });
    }
    let mut start = Vec::new();
    file.by_ref().take(MAGIC.len() as u64).read_to_end(&mut start).map_err(read)?;
    let mut connection;
    if start.starts_with(ZSTD) {
        let mut packed = start;
        file.take(LARGEST).read_to_end(&mut packed).map_err(read)?;
        let bytes = unpack(path, &packed, LARGEST)?;
        connection = Connection::open_in_memory().map_err(refuse)?;
        let length = bytes.len();
        connection
            .deserialize_read_exact("main", Cursor::new(bytes), length, true)
            .map_err(refuse)?;
    } else if start == MAGIC {
        let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        connection = Connection::open_with_flags(path, flags).map_err(refuse)?;
    } else {
        return Err(refused(path, "it is no SQLite database".to_owned()));
    }
    let longest = i32::try_from(LARGEST_RECORD).unwrap_or(i32::MAX);
    connection.set_limit(Limit::SQLITE_LIMIT_LENGTH, longest).map_err(refuse)?;
    Ok(connection)
}

/// What zstd packed, up to `most` bytes.
pub(super) fn unpack(path: &Path, packed: &[u8], most: u64) -> Result<Vec<u8>, BagError> {
    let refuse = |error: std::io::Error| refused(path, format!("it cannot be unpacked: {error}"));
    let mut bytes = Vec::new();
    let reader = zstd::stream::read::Decoder::new(packed).map_err(refuse)?;
    reader.take(most + 1).read_to_end(&mut bytes).map_err(refuse)?;
    if bytes.len() as u64 > most {
        return Err(refused(path, format!("it unpacks to more than {most} bytes")));
    }
    Ok(bytes)
}

fn refused(path: &Path, detail: String) -> BagError {
    BagError::Database { path: path.into(), detail }
}
