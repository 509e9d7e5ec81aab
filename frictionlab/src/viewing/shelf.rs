//! Folders of results with their reports and bags, for viewers: those in one folder of runs, and
//! that of the work at hand.
//!
//! A viewer names a folder by its number in the list and a file by its name, and no path. Links are
//! not followed, neither to a folder nor to a file in it, and only files that the commands write are
//! shown.

use std::ffi::OsString;
use std::fs::{self, DirEntry, File, Metadata};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::UNIX_EPOCH;

use serde_json::{Value, json};
use view::{Access, Parameter, Playback, PlaybackRequest, Service, Shown, Steering};

/// The service that lists the folders.
const LIST: &str = "/view/list_runs";
/// The report of a folder.
const REPORT: &str = "report.html";
/// The folder of its bag.
const BAG: &str = "bag";
/// Files that are shown beside the report, which names them.
const BESIDE: [&str; 8] = [
    "parameters.yaml",
    "controller.yaml",
    "drive.yaml",
    "calibration.yaml",
    "rig.yaml",
    "run.json",
    "commission.json",
    "results.json",
];
/// How tables end.
const TABLE: &str = ".csv";
/// Folders that are listed at most, the newest first.
const LISTED: usize = 200;
/// Entries of the folder of runs that are looked at.
const LOOKED: usize = 10_000;
/// Largest file that is shown \[bytes\].
const LARGEST: u64 = 64 << 20;

/// Folders of results.
#[derive(Debug)]
pub struct Shelf {
    root: PathBuf,
    known: Mutex<Vec<Place>>,
}

/// Where a folder is. Its number is its place in the list of those that are known.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Place {
    /// In the folder of runs.
    Run(OsString),
    /// Wherever the user wants it.
    Own(PathBuf),
}

impl Shelf {
    /// Of a folder of runs, which need not be there.
    #[must_use]
    pub fn new(root: &Path) -> Arc<Self> {
        Arc::new(Self { root: root.to_owned(), known: Mutex::default() })
    }

    /// Has the folder of the work at hand listed too.
    pub fn add(&self, folder: &Path) {
        let inside = folder.parent() == Some(&self.root);
        let place = match folder.file_name().filter(|_| inside) {
            Some(name) => Place::Run(name.to_owned()),
            None => Place::Own(folder.to_owned()),
        };
        number(&mut self.known(), &place);
    }

    /// All folders that have something to show, the newest first.
    fn list(&self) -> Value {
        let inside = fs::read_dir(&self.root).into_iter().flatten().take(LOOKED);
        // What cannot be looked at is not shown.
        let runs = inside.flatten().filter(is_folder).map(|entry| Place::Run(entry.file_name()));
        let mut known = self.known();
        let own: Vec<Place> =
            known.iter().filter(|place| matches!(place, Place::Own(_))).cloned().collect();
        let mut all: Vec<(u64, Value)> = own
            .into_iter()
            .chain(runs)
            .filter_map(|place| {
                let path = self.path(&place);
                let (when, mut told) = told(&path)?;
                told["folder"] = json!(number(&mut known, &place));
                Some((when, told))
            })
            .collect();
        all.sort_by_key(|(when, _)| std::cmp::Reverse(*when));
        let left_out = all.len().saturating_sub(LISTED);
        let runs: Vec<Value> = all.into_iter().take(LISTED).map(|(_, told)| told).collect();
        json!({ "root": self.root.display().to_string(), "left_out": left_out, "runs": runs })
    }

    /// A file of a folder that was listed.
    fn file(&self, folder: u32, name: &str) -> Option<Shown> {
        let kind = kind(name)?;
        let place = self.known().get(usize::try_from(folder).ok()?)?.clone();
        let file = match &place {
            Place::Run(run) => open::inside(&self.root, run, name),
            Place::Own(folder) => open::of(folder, name),
        };
        read(file.ok()?).ok().flatten().map(|bytes| Shown { kind, bytes })
    }

    fn path(&self, place: &Place) -> PathBuf {
        match place {
            Place::Run(name) => self.root.join(name),
            Place::Own(path) => path.clone(),
        }
    }

    fn known(&self) -> MutexGuard<'_, Vec<Place>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The number of a place, which stays as it is.
fn number(known: &mut Vec<Place>, place: &Place) -> usize {
    known.iter().position(|one| one == place).unwrap_or_else(|| {
        known.push(place.clone());
        known.len() - 1
    })
}

/// Whether it is a folder itself, and no link to one.
fn is_folder(entry: &DirEntry) -> bool {
    entry.file_type().is_ok_and(|kind| kind.is_dir())
}

/// What a folder has, and when it was changed; nothing where that is neither report nor bag.
fn told(path: &Path) -> Option<(u64, Value)> {
    let is_file = |name: &str| path.join(name).symlink_metadata().is_ok_and(|it| it.is_file());
    let is_bag = path.join(BAG).symlink_metadata().is_ok_and(|it| it.is_dir());
    let report = is_file(REPORT);
    if !report && !is_bag {
        return None;
    }
    let changed = |it: Metadata| it.modified().ok()?.duration_since(UNIX_EPOCH).ok();
    let when = fs::metadata(path).ok().and_then(changed).map_or(0, |since| since.as_secs());
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    let beside: Vec<&str> = BESIDE.into_iter().filter(|name| is_file(name)).collect();
    let bag = is_bag.then(|| path.join(BAG).display().to_string());
    Some((
        when,
        json!({
            "name": name,
            "path": path.display().to_string(),
            "changed": when,
            "report": report,
            "bag": bag,
            "files": beside,
        }),
    ))
}

/// What a file is to the browser; nothing for a name that is not shown.
fn kind(name: &str) -> Option<&'static str> {
    if name == REPORT {
        return Some("text/html; charset=utf-8");
    }
    let shown = BESIDE.contains(&name) || name.ends_with(TABLE);
    shown.then(|| match name.rsplit('.').next() {
        Some("json") => "application/json",
        Some("csv") => "text/csv; charset=utf-8",
        _ => "text/plain; charset=utf-8",
    })
}

/// All of a regular file; nothing of what is none, or is too large.
fn read(file: File) -> io::Result<Option<Vec<u8>>> {
    let it = file.metadata()?;
    if !it.is_file() || it.len() > LARGEST {
        return Ok(None);
    }
    let mut bytes = Vec::with_capacity(usize::try_from(it.len()).unwrap_or_default());
    // It may grow meanwhile.
    file.take(LARGEST + 1).read_to_end(&mut bytes)?;
    Ok((bytes.len() as u64 <= LARGEST).then_some(bytes))
}

/// Opens files without following links, and without waiting for what is no file.
#[cfg(unix)]
mod open {
    use std::ffi::OsStr;
    use std::fs::File;
    use std::io;
    use std::os::fd::{AsFd, OwnedFd};
    use std::path::Path;

    use rustix::fs::{CWD, Mode, OFlags, openat};

    const FOLDER: OFlags = OFlags::RDONLY.union(OFlags::DIRECTORY).union(OFlags::CLOEXEC);
    const READ: OFlags =
        OFlags::RDONLY.union(OFlags::NOFOLLOW).union(OFlags::NONBLOCK).union(OFlags::CLOEXEC);

    /// A file of a folder in `root`.
    pub(super) fn inside(root: &Path, folder: &OsStr, name: &str) -> io::Result<File> {
        let root = openat(CWD, root, FOLDER, Mode::empty())?;
        let folder = openat(root, folder, FOLDER.union(OFlags::NOFOLLOW), Mode::empty())?;
        in_folder(&folder, name)
    }

    /// A file of a folder.
    pub(super) fn of(folder: &Path, name: &str) -> io::Result<File> {
        in_folder(&openat(CWD, folder, FOLDER, Mode::empty())?, name)
    }

    fn in_folder(folder: &OwnedFd, name: &str) -> io::Result<File> {
        Ok(openat(folder.as_fd(), name, READ, Mode::empty())?.into())
    }
}

/// The same where links are rare.
#[cfg(not(unix))]
mod open {
    use std::ffi::OsStr;
    use std::fs::File;
    use std::io;
    use std::path::Path;

    pub(super) fn inside(root: &Path, folder: &OsStr, name: &str) -> io::Result<File> {
        let folder = root.join(folder);
        if !folder.symlink_metadata()?.is_dir() {
            return Err(io::ErrorKind::NotFound.into());
        }
        of(&folder, name)
    }

    pub(super) fn of(folder: &Path, name: &str) -> io::Result<File> {
        let path = folder.join(name);
        if !path.symlink_metadata()?.is_file() {
            return Err(io::ErrorKind::NotFound.into());
        }
        File::open(path)
    }
}

/// What viewers ask for, with the folders beside it.
pub(super) struct WithShelf {
    pub(super) asked: Arc<dyn Steering>,
    pub(super) shelf: Arc<Shelf>,
}

impl Steering for WithShelf {
    fn services(&self) -> Vec<Service> {
        let list = Service {
            name: LIST.to_owned(),
            kind: "view/srv/ListRuns".to_owned(),
            request: json!({}),
            response: json!({ "root": "", "left_out": 0, "runs": [] }),
            access: Access::ReadOnly,
            stops: false,
        };
        self.asked.services().into_iter().chain([list]).collect()
    }

    fn call(&self, service: &str, request: Value) -> Result<Value, String> {
        if service == LIST { Ok(self.shelf.list()) } else { self.asked.call(service, request) }
    }

    fn parameters(&self, names: &[String]) -> Result<Vec<Parameter>, String> {
        self.asked.parameters(names)
    }

    fn set_parameters(&self, parameters: Vec<Parameter>) -> Result<(), String> {
        self.asked.set_parameters(parameters)
    }

    fn publish(&self, topic: &str, message: Value) -> Result<(), String> {
        self.asked.publish(topic, message)
    }

    fn file(&self, folder: u32, name: &str) -> Option<Shown> {
        self.shelf.file(folder, name)
    }

    fn recording(&self) -> Option<(u64, u64)> {
        self.asked.recording()
    }

    fn play(&self, request: &PlaybackRequest) -> Option<Playback> {
        self.asked.play(request)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    /// A folder of runs with two of them, and one file beside them.
    fn runs() -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        let run = root.path().join("runs/all-1");
        fs::create_dir_all(run.join("bag")).unwrap();
        fs::write(run.join(REPORT), "<p>").unwrap();
        fs::write(run.join("parameters.yaml"), "a: 1").unwrap();
        fs::write(run.join("secret.txt"), "secret").unwrap();
        fs::create_dir(root.path().join("runs/empty")).unwrap();
        fs::write(root.path().join(REPORT), "outside").unwrap();
        root
    }

    fn listed(shelf: &Shelf) -> BTreeMap<String, u32> {
        let list = shelf.list();
        let runs = list["runs"].as_array().unwrap().iter();
        runs.map(|run| {
            let folder = run["folder"].as_u64().unwrap();
            (run["name"].as_str().unwrap().to_owned(), u32::try_from(folder).unwrap())
        })
        .collect()
    }

    #[test]
    fn runs_are_listed_and_the_files_that_commands_write_are_shown() {
        let root = runs();
        let shelf = Shelf::new(&root.path().join("runs"));
        assert!(shelf.file(0, REPORT).is_none(), "nothing was listed");
        let all = listed(&shelf);
        assert_eq!(all.keys().collect::<Vec<_>>(), ["all-1"]);
        let folder = all["all-1"];
        assert_eq!(shelf.file(folder, REPORT).unwrap().bytes, b"<p>");
        assert_eq!(shelf.file(folder, "parameters.yaml").unwrap().bytes, b"a: 1");
        for other in ["secret.txt", "bag", "", "..", "../../report.html", "bag/report.html"] {
            assert!(shelf.file(folder, other).is_none(), "{other}");
        }
        assert!(shelf.file(folder + 1, REPORT).is_none());
        // A number stays what it was.
        fs::create_dir(root.path().join("runs/a-0")).unwrap();
        fs::write(root.path().join("runs/a-0").join(REPORT), "new").unwrap();
        assert_eq!(listed(&shelf)["all-1"], folder);
        assert_eq!(listed(&shelf).len(), 2);
    }

    #[test]
    fn the_folder_of_the_work_at_hand_is_listed_wherever_it_is() {
        let root = runs();
        let shelf = Shelf::new(&root.path().join("nowhere"));
        shelf.add(&root.path().join("runs/all-1"));
        shelf.add(&root.path().join("runs/all-1"));
        let all = listed(&shelf);
        assert_eq!(all.len(), 1);
        assert!(shelf.file(all["all-1"], REPORT).is_some());
    }

    #[cfg(unix)]
    #[test]
    fn a_link_leads_nowhere_and_a_pipe_is_not_waited_for() {
        use std::os::unix::fs::symlink;
        let root = runs();
        let run = root.path().join("runs/all-1");
        symlink(root.path(), root.path().join("runs/link")).unwrap();
        symlink(root.path().join(REPORT), run.join("run.json")).unwrap();
        symlink("/etc/passwd", run.join("table.csv")).unwrap();
        let made = std::process::Command::new("mkfifo").arg(run.join("drive.yaml")).status();
        assert!(made.unwrap().success());
        let shelf = Shelf::new(&root.path().join("runs"));
        let all = listed(&shelf);
        assert_eq!(all.keys().collect::<Vec<_>>(), ["all-1"]);
        for name in ["run.json", "table.csv", "drive.yaml"] {
            assert!(shelf.file(all["all-1"], name).is_none(), "{name}");
        }
        // A folder that becomes a link after it was listed.
        fs::rename(&run, root.path().join("moved")).unwrap();
        symlink(root.path().join("moved"), &run).unwrap();
        assert!(shelf.file(all["all-1"], REPORT).is_none());
    }

    #[test]
    fn a_file_that_is_too_large_is_not_shown() {
        let root = runs();
        let report = root.path().join("runs/all-1").join(REPORT);
        File::options().write(true).open(report).unwrap().set_len(LARGEST + 1).unwrap();
        let shelf = Shelf::new(&root.path().join("runs"));
        assert!(shelf.file(listed(&shelf)["all-1"], REPORT).is_none());
    }
}
