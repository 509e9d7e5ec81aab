//! An MCAP file to be read: bare, or compressed by zstd as a whole, as rosbag2 does with
//! `--compression-mode file`.

use std::{
    fs::{self, File},
    io::{self, Cursor, Read},
    path::{Path, PathBuf},
    sync::Arc,
};

use super::BagError;
use super::read_at::ReadAt;
use super::sqlite::{ZSTD, unpack};

/// Largest file that is unpacked \[bytes\].
const LARGEST: u64 = files::input::LARGEST_TABLE;

/// Ends of the name of a packed file.
const PACKED: [&str; 2] = [".zstd", ".zst"];

/// An MCAP file.
#[derive(Debug, Clone)]
pub(super) struct McapFile {
    /// Where it is.
    pub path: PathBuf,
    /// What was in it, where it was compressed.
    unpacked: Option<Arc<[u8]>>,
}

impl McapFile {
    /// Looks at its first bytes, and unpacks what is compressed.
    pub(super) fn open(path: &Path) -> Result<Self, BagError> {
        let mut start = Vec::new();
        let mut file = File::open(path).map_err(read_error(path))?;
        file.by_ref().take(ZSTD.len() as u64).read_to_end(&mut start).map_err(read_error(path))?;
        if start != ZSTD {
            check_magic(path)?;
            return Ok(Self { path: path.into(), unpacked: None });
        }
        file.take(LARGEST).read_to_end(&mut start).map_err(read_error(path))?;
        let bytes = unpack(path, &start, LARGEST).map_err(|error| match error {
            BagError::Database { path, detail } => BagError::Damaged {
                path,
                detail: format!("{detail}; `unzstd` may still unpack a part of it"),
            },
            other => other,
        })?;
        if !bytes.starts_with(mcap::MAGIC) {
            return Err(BagError::NotMcap { path: path.into() });
        }
        Ok(Self { path: path.into(), unpacked: Some(bytes.into()) })
    }

    /// Its bytes, from the first one on, and how many there are by now.
    pub(super) fn read(&self) -> Result<(Box<dyn ReadAt>, u64), BagError> {
        if let Some(bytes) = &self.unpacked {
            return Ok((Box::new(Cursor::new(Arc::clone(bytes))), bytes.len() as u64));
        }
        let open = || -> io::Result<(Box<dyn ReadAt>, u64)> {
            let file = File::open(&self.path)?;
            let length = file.metadata()?.len();
            Ok((Box::new(file), length))
        };
        open().map_err(read_error(&self.path))
    }
}

/// The MCAP files of a bag, in order of their names, which rosbag2 numbers. Of one that was unpacked
/// beside the packed one it is the unpacked one.
pub(super) fn files_of(path: &Path) -> Result<Vec<PathBuf>, BagError> {
    if !fs::metadata(path).map_err(read_error(path))?.is_dir() {
        return Ok(vec![path.into()]);
    }
    let mut files = Vec::new();
    for entry in fs::read_dir(path).map_err(read_error(path))? {
        let file = entry.map_err(read_error(path))?.path();
        let name = file.to_string_lossy();
        if name.ends_with(".mcap") || bare(&file).is_some() {
            files.push(file);
        }
    }
    let known = files.clone();
    files.retain(|file| bare(file).is_none_or(|bare| !known.contains(&bare)));
    // `bag_10.mcap` comes behind `bag_9.mcap`.
    files.sort_by_key(|file| (file.as_os_str().len(), file.clone()));
    if files.is_empty() { Err(BagError::NoMcap { path: path.into() }) } else { Ok(files) }
}

/// What a packed MCAP file is called once it is unpacked; none for what is not packed by its name.
pub(super) fn bare(file: &Path) -> Option<PathBuf> {
    let name = file.file_name()?.to_string_lossy();
    let bare = PACKED.iter().find_map(|ending| name.strip_suffix(ending))?;
    bare.ends_with(".mcap").then(|| file.with_file_name(bare))
}

/// Unpacks as much of a file as there is into another one.
pub(super) fn unpack_into(packed: &Path, to: &Path) -> Result<(), BagError> {
    let file = File::open(packed).map_err(read_error(packed))?;
    let mut bytes =
        zstd::stream::read::Decoder::new(file).map_err(read_error(packed))?.take(LARGEST);
    let write_error = |source| BagError::Write { path: to.into(), source };
    let mut out = File::create(to).map_err(write_error)?;
    let mut buffer = vec![0; 1 << 16];
    let mut nothing = true;
    // What cannot be unpacked ends it: what comes behind is lost.
    while let Ok(count @ 1..) = bytes.read(&mut buffer) {
        io::Write::write_all(&mut out, buffer.get(..count).unwrap_or_default())
            .map_err(write_error)?;
        nothing = false;
    }
    if nothing {
        let detail = "nothing of it can be unpacked".to_owned();
        return Err(BagError::Damaged { path: packed.into(), detail });
    }
    Ok(())
}

pub(super) fn read_error(path: &Path) -> impl FnOnce(io::Error) -> BagError {
    let path = path.to_owned();
    move |source| BagError::Read { path, source }
}

/// The file, at the place behind its first bytes, which are those of an MCAP file, and its size.
pub(super) fn check_magic(path: &Path) -> Result<(File, u64), BagError> {
    let mut file = File::open(path).map_err(read_error(path))?;
    let size = file.metadata().map_err(read_error(path))?.len();
    if size == 0 {
        return Err(BagError::Empty { path: path.into() });
    }
    let mut magic = [0; mcap::MAGIC.len()];
    let known = match file.read_exact(&mut magic) {
        Ok(()) => magic == mcap::MAGIC,
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => false,
        Err(error) => return Err(read_error(path)(error)),
    };
    if known { Ok((file, size)) } else { Err(BagError::NotMcap { path: path.into() }) }
}
