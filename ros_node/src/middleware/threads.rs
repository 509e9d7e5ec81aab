//! What the system tells of the middleware's threads, and of this process's memory.

use std::{collections::BTreeMap, fs, io, path::Path, time::Duration};

/// What the names of the middleware's threads begin with.
const NAME: &str = "RustDDS";

/// What the system tells of a thread.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Told {
    pub(super) name: String,
    /// How often it has waited.
    pub(super) waits: u64,
    /// Processor time that it has taken.
    pub(super) taken: Duration,
}

/// The middleware's threads in this process, by their number. `None` if the system does not tell
/// now: it has no file left, or no `/proc`.
pub(super) fn threads() -> Option<BTreeMap<u32, Told>> {
    let mut all = BTreeMap::new();
    for task in fs::read_dir("/proc/self/task").ok()? {
        let folder = task.ok()?.path();
        let Some(name) = read(&folder, "comm")? else { continue };
        if !name.starts_with(NAME) {
            continue;
        }
        let (Some(status), Some(schedstat)) =
            (read(&folder, "status")?, read(&folder, "schedstat")?)
        else {
            continue;
        };
        let id = folder.file_name()?.to_str()?.parse().ok()?;
        // Where the system keeps no such books, no thread is ever stuck.
        let (waits, taken) = waits(&status).zip(taken(&schedstat)).unwrap_or_default();
        all.insert(id, Told { name: name.trim_end().to_owned(), waits, taken });
    }
    Some(all)
}

/// A file of a thread; `Some(None)` if the thread has ended meanwhile or keeps no such file, `None`
/// if it cannot be read for another reason.
fn read(folder: &Path, file: &str) -> Option<Option<String>> {
    /// No such process: its folder was still there.
    const ENDED: i32 = 3;
    match fs::read_to_string(folder.join(file)) {
        Ok(text) => Some(Some(text)),
        Err(error) if error.raw_os_error() == Some(ENDED) => Some(None),
        Err(error) if error.kind() == io::ErrorKind::NotFound && !folder.exists() => Some(None),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Some(Some(String::new())),
        Err(_) => None,
    }
}

/// Memory of this process that is resident \[bytes\]; nothing where the system does not tell.
pub(super) fn memory() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let kilobytes = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    kilobytes
        .and_then(|told| told.trim().strip_suffix("kB")?.trim().parse::<u64>().ok())
        .unwrap_or_default()
        << 10
}

/// How often a thread has waited, from its `status`.
fn waits(status: &str) -> Option<u64> {
    status
        .lines()
        .find_map(|line| line.strip_prefix("voluntary_ctxt_switches:"))?
        .trim()
        .parse()
        .ok()
}

/// Processor time that a thread has taken, from its `schedstat`.
fn taken(schedstat: &str) -> Option<Duration> {
    schedstat.split_whitespace().next()?.parse().ok().map(Duration::from_nanos)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread;

    #[test]
    fn the_books_of_the_system_are_read() {
        let here = thread::Builder::new().name("RustDDS books".into()).spawn(|| {
            thread::sleep(Duration::from_millis(5));
            threads().unwrap().into_values().find(|told| told.name == "RustDDS books")
        });
        let told = here.unwrap().join().unwrap().unwrap();
        assert!(told.waits > 0 && told.taken > Duration::ZERO, "{told:?}");
        assert!(memory() > 1 << 20);
    }
}
