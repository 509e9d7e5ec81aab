//! Emulated rigs that run on this machine, so that whoever looks for rigs finds them.
//!
//! No system lists a pseudo-terminal among its serial ports. So an emulator announces itself in a
//! file of its own, which it holds locked while it runs: the system lets go of the lock however the
//! emulator ends, `kill -9` included, and a file that nobody holds is no rig.

use std::env;
use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Where announcements are: `frictionlab/rigs` in `XDG_RUNTIME_DIR`, else in `XDG_STATE_HOME`, else
/// in `~/.local/state`; none without any of them.
#[must_use]
pub fn folder() -> Option<PathBuf> {
    let of = |name: &str| env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    of("XDG_RUNTIME_DIR")
        .or_else(|| of("XDG_STATE_HOME"))
        .or_else(|| of("HOME").map(|home| home.join(".local/state")))
        .map(|base| base.join("frictionlab").join("rigs"))
}

/// An emulated rig that is announced. Dropped, it is not any more.
#[derive(Debug)]
pub struct Announcement {
    file: PathBuf,
    _held: File,
}

impl Announcement {
    /// Announces in `folder` that this process emulates the rig at `port`.
    ///
    /// # Errors
    /// What the system says, where the file cannot be written or locked.
    pub fn new(folder: &Path, port: &Path) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        let file = folder.join(std::process::id().to_string());
        // A file of that name is one that an earlier process left.
        let mut held = File::create(&file)?;
        held.try_lock().map_err(io::Error::from)?;
        let port = std::path::absolute(port)?;
        held.write_all(port.as_os_str().as_encoded_bytes())?;
        Ok(Self { file, _held: held })
    }
}

impl Drop for Announcement {
    fn drop(&mut self) {
        // What cannot be removed is told from a running one by its lock.
        let _ = fs::remove_file(&self.file);
    }
}

/// The ports of emulated rigs that run, in the order of their names. Files that nobody holds are
/// left out.
#[must_use]
pub fn announced(folder: &Path) -> Vec<PathBuf> {
    let runs = |file: &File| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock));
    let mut ports: Vec<PathBuf> = fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        // A FIFO would hold whoever opens it.
        .filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_file()))
        .filter(|entry| File::open(entry.path()).is_ok_and(|file| runs(&file)))
        .filter_map(|entry| fs::read_to_string(entry.path()).ok())
        .map(PathBuf::from)
        .filter(|port| port.exists())
        .collect();
    ports.sort();
    ports.dedup();
    ports
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_runs_is_found_and_who_left_a_file_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let (rigs, port) = (folder.path().join("rigs"), folder.path().join("port"));
        fs::write(&port, "").unwrap();
        assert!(announced(&rigs).is_empty());
        let running = Announcement::new(&rigs, &port).unwrap();
        fs::write(rigs.join("1"), port.display().to_string()).unwrap();
        assert_eq!(announced(&rigs), std::slice::from_ref(&port));
        // Its port is gone, as while the cable is out.
        fs::remove_file(&port).unwrap();
        assert!(announced(&rigs).is_empty());
        fs::write(&port, "").unwrap();
        drop(running);
        assert!(announced(&rigs).is_empty());
    }
}
