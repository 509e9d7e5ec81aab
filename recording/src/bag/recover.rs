//! Makes a bag that was cut off or damaged whole again, as far as it goes.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use mcap::records::Channel;

use super::guard::guarded;
use super::mcap_file::{McapFile, bare, check_magic, files_of, unpack_into};
use super::metadata::{TopicEntry, entry_of};
use super::output::{Close, Description, Output};
use super::reader::{definition, is_whole};
use super::salvage::{Found, Losses, Salvage};
use super::schema::Judgement;
use super::{BagError, BagOptions, BagSummary};
use files::durable::{Disk, System};

/// Behind the name of a damaged file once a whole one has taken its place.
const ORIGINAL: &str = "damaged";
/// Behind the name of a file that is being made.
const DRAFT: &str = "recovering";

/// Behind the name of what a packed file holds, until it is rewritten.
const UNPACKED: &str = "unpacking";

/// What became of a bag.
#[derive(Debug, Clone, PartialEq)]
pub enum Recovery {
    /// There was nothing to do.
    Whole,
    /// It is whole now.
    Recovered {
        /// What it holds.
        bag: BagSummary,
        /// Where the damaged file is kept.
        original: PathBuf,
        /// Bytes of it that belong to no whole record.
        lost_bytes: u64,
        /// Chunks of it whose content is damaged.
        lost_chunks: u64,
        /// Messages of it whose channel was not found.
        lost_messages: u64,
        /// Topics whose definition was damaged, and is now the one that its hash names.
        mended_definitions: Vec<String>,
        /// Topics whose definition was damaged and is not known here: their messages are kept,
        /// without a type.
        lost_definitions: Vec<String>,
    },
}

/// Whether a folder holds a bag that was cut off: an MCAP file that nobody is writing, and no
/// `metadata.yaml`. Looks at names and the lock only, so that it is quick.
#[must_use]
pub fn is_cut(dir: &Path) -> bool {
    !dir.join("metadata.yaml").exists()
        && files_of(dir)
            .is_ok_and(|files| dir.is_dir() && files.iter().all(|file| !is_being_written(file)))
}

/// Bags beneath a folder of runs that were cut off: `RUN/bag` for each run.
#[must_use]
pub fn cut_bags(runs: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(runs) else { return Vec::new() };
    let mut found: Vec<PathBuf> = entries
        .flatten()
        .map(|entry| entry.path().join("bag"))
        .filter(|bag| bag.is_dir() && is_cut(bag))
        .collect();
    found.sort();
    found
}

/// Makes the bag in a folder whole: its MCAP file gets its index and loses what is damaged, and
/// `metadata.yaml` is written. The original stays beside it with `.damaged` behind its name. One
/// that is packed as a whole, and was cut, is unpacked as far as it goes. A bag that is whole stays
/// as it is.
///
/// # Errors
/// [`BagError`] that names the file: no bag, a bag that is being written, a file of another kind, a
/// folder that cannot be written. The original is as it was then.
pub fn recover(dir: &Path) -> Result<Recovery, BagError> {
    let files = files_of(dir)?;
    let [file] = &files[..] else {
        return Err(BagError::SeveralFiles { path: dir.into(), files: files.len() });
    };
    if is_being_written(file) {
        return Err(BagError::InUse { path: file.clone() });
    }
    let folder = file.parent().unwrap_or(dir).to_owned();
    let described = dir.is_file() || folder.join("metadata.yaml").exists();
    if described && is_whole(file) {
        return Ok(Recovery::Whole);
    }
    let Some(target) = bare(file) else { return replaced(file, file, file, &folder) };
    if target.exists() {
        let source = io::Error::new(io::ErrorKind::AlreadyExists, "it is there already");
        return Err(BagError::Write { path: target, source });
    }
    let unpacked = beside(&target, UNPACKED, false);
    let done =
        unpack_into(file, &unpacked).and_then(|()| replaced(file, &unpacked, &target, &folder));
    let _ = fs::remove_file(&unpacked);
    done
}

/// Puts what is whole of `source` into `target`, and keeps `file` under another name.
fn replaced(
    file: &Path,
    source: &Path,
    target: &Path,
    folder: &Path,
) -> Result<Recovery, BagError> {
    check_magic(source)?;
    let write_error = |path: &Path| {
        let path = path.to_owned();
        move |source: io::Error| BagError::Write { path, source }
    };
    let draft = beside(target, DRAFT, false);
    let Rewritten { bag, description, losses, definitions } =
        match guarded(file, || rewrite(source, target, &draft, folder)) {
            Ok(done) => done,
            Err(error) => {
                // A draft that was never made is no second error.
                let _ = fs::remove_file(&draft);
                return Err(error);
            }
        };
    let original = beside(file, ORIGINAL, true);
    // A second name for the damaged file where that can be had: so there is a file of the bag's
    // name at any moment.
    let linked = if file == target {
        fs::hard_link(file, &original)
    } else {
        Err(io::ErrorKind::Unsupported.into())
    };
    linked.or_else(|_| fs::rename(file, &original)).map_err(write_error(&original))?;
    System
        .rename(&draft, target)
        .and_then(|()| System.sync_folder(folder))
        .map_err(write_error(target))?;
    // Last: a bag that is described is taken for whole.
    description.write()?;
    Ok(Recovery::Recovered {
        bag,
        original,
        lost_bytes: losses.bytes,
        lost_chunks: losses.chunks,
        lost_messages: losses.messages,
        mended_definitions: definitions.mended,
        lost_definitions: definitions.lost,
    })
}

/// `file` with `.suffix` behind its name; with a number too if `fresh` and that is taken.
fn beside(file: &Path, suffix: &str, fresh: bool) -> PathBuf {
    let named = |suffix: &str| {
        let mut name = file.file_name().unwrap_or_default().to_owned();
        name.push(".");
        name.push(suffix);
        file.with_file_name(name)
    };
    let first = named(suffix);
    if !fresh || !first.exists() {
        return first;
    }
    (2..).map(|n: u32| named(&format!("{suffix}{n}"))).find(|path| !path.exists()).unwrap_or(first)
}

/// Whether some program holds the file's lock, as a writer does.
pub(super) fn is_being_written(file: &Path) -> bool {
    let Ok(handle) = File::open(file) else { return false };
    matches!(handle.try_lock_shared(), Err(fs::TryLockError::WouldBlock))
}

/// Copies everything whole into the draft.
fn rewrite(file: &Path, target: &Path, draft: &Path, folder: &Path) -> Result<Rewritten, BagError> {
    let name =
        target.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let salvage = Salvage::new(McapFile::open(file)?.read()?);
    if draft.exists() {
        fs::remove_file(draft).map_err(|source| BagError::Write { path: draft.into(), source })?;
    }
    let mut output = Output::create(draft, &BagOptions::default())?;
    let mut entries: Vec<TopicEntry> = Vec::new();
    let mut channels: BTreeMap<u16, (u16, usize)> = BTreeMap::new();
    let mut definitions = Definitions::default();
    let losses = salvage
        .run(|found| -> Result<(), Stop> {
            match found {
                Found::Message { channel, schema, header, data } => {
                    let (id, entry) = match channels.get(&channel.id) {
                        Some(known) => *known,
                        None => {
                            let mended;
                            let of_type = match schema {
                                None => ("", "", &[][..]),
                                Some((header, text)) => {
                                    let (name, encoding) =
                                        (header.name.as_str(), header.encoding.as_str());
                                    match definition(channel, header, text) {
                                        Judgement::Sound => (name, encoding, &text[..]),
                                        Judgement::Mended(text) => {
                                            definitions.mended.push(channel.topic.clone());
                                            mended = text;
                                            (name, encoding, mended.as_bytes())
                                        }
                                        Judgement::Damaged => {
                                            definitions.lost.push(channel.topic.clone());
                                            ("", "", &[][..])
                                        }
                                    }
                                }
                            };
                            let Channel { topic, message_encoding, metadata, .. } = channel;
                            let id = output.channel(topic, of_type, message_encoding, metadata)?;
                            let entry = entries.iter().position(|entry| entry.name == *topic);
                            let entry = entry.unwrap_or_else(|| {
                                entries.push(entry_of(topic, of_type.0, metadata));
                                entries.len() - 1
                            });
                            channels.insert(channel.id, (id, entry));
                            (id, entry)
                        }
                    };
                    output.message(id, &header, data)?;
                    entries[entry].count += 1;
                    Ok(())
                }
                Found::Attachment(attachment) => Ok(output.attach(&attachment)?),
                // The description of before is replaced by that of now.
                Found::Metadata(metadata) if metadata.name == "rosbag2" => Ok(()),
                Found::Metadata(metadata) => Ok(output.metadata(&metadata)?),
            }
        })
        .map_err(|stop| match stop {
            Stop::Read(source) => BagError::Read { path: file.into(), source },
            Stop::Bag(error) => error,
        })?;
    let close = Close { dir: folder, file: target, file_name: &name, entries };
    let (bag, description) = output.finish(close)?;
    Ok(Rewritten { bag, description, losses, definitions })
}

/// A draft that is whole.
struct Rewritten {
    bag: BagSummary,
    description: Description,
    losses: Losses,
    definitions: Definitions,
}

/// Topics whose definitions were damaged.
#[derive(Default)]
struct Definitions {
    mended: Vec<String>,
    lost: Vec<String>,
}

/// What ends the copying.
enum Stop {
    Read(io::Error),
    Bag(BagError),
}

impl From<io::Error> for Stop {
    fn from(error: io::Error) -> Self {
        Self::Read(error)
    }
}

impl From<BagError> for Stop {
    fn from(error: BagError) -> Self {
        Self::Bag(error)
    }
}
