//! The journal of a run: what was measured, job by job, so that a run that was stopped can go on.
//!
//! `journal.jsonl` lies in the run's folder until the run is complete. A line is written once its
//! job is delivered; a line that a kill cut off counts as not written. While a run goes on it holds
//! the file's lock.

mod jobs;
mod line;

use std::collections::VecDeque;
use std::fs::{self, File, TryLockError};
use std::io::{self, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use serde::Serialize;
use serde::de::IgnoredAny;
use serde_json::Value;

use self::line::{Begun, Header, Line, Lines, Place, read, text_of};
use super::differences::differences;
use super::results::{Reconnection, Session};
use super::{RunError, RunOptions};
use files::OutputError;

/// Name in the run's folder.
const NAME: &str = "journal.jsonl";
/// Version of the form.
const FORMAT: u32 = 1;
/// Differences of options that are named.
const NAMED: usize = 5;

/// The journal of a run, locked.
#[derive(Debug)]
pub struct Journal {
    folder: PathBuf,
    path: PathBuf,
    file: File,
    header: Header,
    sessions: Vec<(Begun, u64, u64, Option<u64>)>,
    reconnections: Vec<Reconnection>,
    /// Jobs that a run before this one did, and that are not delivered yet.
    waiting: VecDeque<Place>,
    /// Number of the job that is delivered next.
    next: u64,
    /// Start of the run that was delivered last.
    last_start_ns: u64,
    /// Whether every line is brought to the disk.
    durable: bool,
}

fn now_ns() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos() as u64)
}

/// Options as they are compared: as JSON has them.
fn described(options: &RunOptions) -> Result<Value, RunError> {
    let text = serde_json::to_string(options);
    text.and_then(|text| serde_json::from_str(&text))
        .map_err(|e| RunError::Describe { what: "JSON", detail: e.to_string() })
}

impl Journal {
    /// Whether a run in this folder can go on.
    #[must_use]
    pub fn is_in(folder: &Path) -> bool {
        folder.join(NAME).is_file()
    }

    /// The journal of the run that was stopped in this folder.
    ///
    /// # Errors
    /// [`RunError::Resume`] if there is none, if that run is complete or still going on, or if its
    /// journal cannot be read.
    pub fn open(folder: &Path) -> Result<Self, RunError> {
        let refuse = |why: String| RunError::Resume { folder: folder.to_owned(), why };
        let path = folder.join(NAME);
        // Whoever opens a pipe waits for what comes out of it.
        if fs::metadata(&path).is_ok_and(|there| !there.is_file()) {
            return Err(refuse(format!("{} is no regular file", path.display())));
        }
        let file = match File::options().read(true).write(true).open(&path) {
            Ok(file) => file,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return Err(refuse(no_journal(folder)));
            }
            Err(error) => {
                return Err(refuse(format!("{} cannot be opened: {error}", path.display())));
            }
        };
        lock(&file).map_err(refuse)?;
        let unread =
            |error: io::Error| refuse(format!("{} cannot be read: {error}", path.display()));
        let mut lines = Lines { reader: BufReader::new(&file), offset: 0 };
        let first = lines.next_line().map_err(unread)?;
        let Some(Line::Header(header)) = first.and_then(|(_, line)| read::<IgnoredAny>(&line))
        else {
            return Err(refuse(format!(
                "{} has no whole first line, so nothing was measured yet: begin the run anew",
                path.display()
            )));
        };
        let program = env!("CARGO_PKG_VERSION");
        if header.format != FORMAT || header.program != program {
            return Err(refuse(format!(
                "it was begun by version {} of frictionlab, and this is version {program}: go on with that one, or begin anew",
                header.program
            )));
        }
        let mut journal = Self {
            folder: folder.to_owned(),
            path: path.clone(),
            file: file.try_clone().map_err(unread)?,
            header,
            sessions: Vec::new(),
            reconnections: Vec::new(),
            waiting: VecDeque::new(),
            next: 0,
            last_start_ns: 0,
            durable: true,
        };
        let mut whole = lines.offset;
        while let Some((offset, line)) = lines.next_line().map_err(unread)? {
            match read::<IgnoredAny>(&line) {
                Some(Line::Session(begun)) => journal.begun(begun),
                Some(Line::Reconnection(reconnection)) => journal.reconnections.push(reconnection),
                Some(Line::Done(done)) if done.job == journal.waiting.len() as u64 => {
                    journal.note(done.finished_ns);
                    journal.waiting.push_back(Place { offset, length: line.len() });
                }
                // What follows a line that is not whole cannot be relied upon.
                _ => break,
            }
            whole = lines.offset;
        }
        file.set_len(whole).map_err(unread)?;
        Ok(journal)
    }

    /// Begins the journal of a run that begins; `durable` brings every line to the disk.
    pub(super) fn begin(
        folder: &Path,
        words: Vec<String>,
        (asked, opened): (&RunOptions, &RunOptions),
        durable: bool,
    ) -> Result<Self, RunError> {
        let path = folder.join(NAME);
        let fail = |source| RunError::from(OutputError::Write { path: path.clone(), source });
        let open = File::options().read(true).write(true).create(true).truncate(false).open(&path);
        let file = open.map_err(fail)?;
        lock(&file).map_err(|why| RunError::Resume { folder: folder.to_owned(), why })?;
        file.set_len(0).map_err(fail)?;
        let header = Header {
            format: FORMAT,
            program: env!("CARGO_PKG_VERSION").to_owned(),
            directory: std::env::current_dir().map_err(fail)?,
            words,
            asked: described(asked)?,
            opened: described(opened)?,
        };
        let mut journal = Self {
            folder: folder.to_owned(),
            path: path.clone(),
            file,
            header: header.clone(),
            sessions: Vec::new(),
            reconnections: Vec::new(),
            waiting: VecDeque::new(),
            next: 0,
            last_start_ns: 0,
            durable,
        };
        journal.append(&Line::<()>::Header(header))?;
        journal.session(None)?;
        Ok(journal)
    }

    /// Removes what a run before left in the folder.
    pub(super) fn remove(folder: &Path) -> Result<(), RunError> {
        let path = folder.join(NAME);
        match fs::remove_file(&path) {
            Err(source) if source.kind() != io::ErrorKind::NotFound => {
                Err(OutputError::Write { path, source }.into())
            }
            _ => Ok(()),
        }
    }

    /// What stood behind `run` when it was begun.
    #[must_use]
    pub fn words(&self) -> &[String] {
        &self.header.words
    }

    /// Where the run was begun: its words name files from there.
    #[must_use]
    pub fn directory(&self) -> &Path {
        &self.header.directory
    }

    /// Refuses options that are not those of the run.
    ///
    /// # Errors
    /// [`RunError::Resume`] names what differs.
    pub fn require_asked(&self, options: &RunOptions) -> Result<(), RunError> {
        self.require(&self.header.asked, options)
    }

    /// The same once the rig is open.
    pub(super) fn require_opened(&self, options: &RunOptions) -> Result<(), RunError> {
        self.require(&self.header.opened, options)
    }

    fn require(&self, then: &Value, options: &RunOptions) -> Result<(), RunError> {
        let mut found = differences(then, &described(options)?);
        if found.is_empty() {
            return Ok(());
        }
        let more = match found.len().saturating_sub(NAMED) {
            0 => String::new(),
            more => format!("; and {more} more"),
        };
        found.truncate(NAMED);
        Err(RunError::Resume {
            folder: self.folder.clone(),
            why: format!(
                "it would not be the same run: {}{more}. Put back what was changed, or begin a run anew",
                found.join("; ")
            ),
        })
    }

    /// Goes on with the run in a sitting of its own.
    pub(super) fn go_on(&mut self, durable: bool, moved: Option<String>) -> Result<(), RunError> {
        self.durable = durable;
        self.file.seek(SeekFrom::End(0)).map_err(|source| self.unwritten(source))?;
        self.session(moved)
    }

    fn session(&mut self, moved: Option<String>) -> Result<(), RunError> {
        let begun = Begun { began_ns: now_ns(), moved };
        self.append(&Line::<()>::Session(begun.clone()))?;
        self.begun(begun);
        Ok(())
    }

    fn begun(&mut self, begun: Begun) {
        let first = self.sessions.last().map_or(0, |(_, first, jobs, _)| first + jobs);
        self.sessions.push((begun, first, 0, None));
    }

    /// Notes that a job of the present sitting is done.
    fn note(&mut self, finished_ns: u64) {
        if let Some((_, _, jobs, ended)) = self.sessions.last_mut() {
            *jobs += 1;
            *ended = Some(finished_ns);
        }
    }

    /// The sittings of the run, the last one until now. The bag of each is where the next one put
    /// it.
    pub(super) fn sessions(&self, bag: &str) -> Vec<Session> {
        let now = now_ns();
        let moved = self.sessions.iter().skip(1).map(|(begun, ..)| begun.moved.clone());
        let bags = moved.chain([Some(bag.to_owned())]);
        let last = self.sessions.len().saturating_sub(1);
        let each = self.sessions.iter().zip(bags).enumerate();
        each.map(|(i, ((begun, first_job, jobs, ended), bag))| {
            let ended = if i == last { now } else { ended.unwrap_or(begun.began_ns) };
            let seconds = |ns: u64| ns as f64 * 1e-9;
            let (began, ended) = (seconds(begun.began_ns), seconds(ended));
            Session { began, ended, first_job: *first_job, jobs: *jobs, bag }
        })
        .collect()
    }

    /// Removes the journal: the run is complete.
    pub(super) fn complete(self) -> Result<(), RunError> {
        let Self { folder, file, .. } = self;
        Self::remove(&folder)?;
        drop(file);
        Ok(())
    }

    fn append<R: Serialize>(&mut self, line: &Line<R>) -> Result<(), RunError> {
        let text = text_of(line)?;
        self.write(&text)
    }

    fn write(&mut self, line: &str) -> Result<(), RunError> {
        let written = self.file.write_all(line.as_bytes());
        let written =
            written.and_then(|()| if self.durable { self.file.sync_data() } else { Ok(()) });
        written.map_err(|source| self.unwritten(source))
    }

    fn unwritten(&self, source: io::Error) -> RunError {
        OutputError::Write { path: self.path.clone(), source }.into()
    }
}

fn lock(file: &File) -> Result<(), String> {
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => {
            Err("that run is still going on in another program".to_owned())
        }
        // A file system without locks.
        Err(TryLockError::Error(_)) | Ok(()) => Ok(()),
    }
}

/// Why there is nothing to go on with.
fn no_journal(folder: &Path) -> String {
    let text = fs::read_to_string(folder.join("run.json")).unwrap_or_default();
    let results: Value = serde_json::from_str(&text).unwrap_or_default();
    match results["status"].as_str() {
        Some("complete") => "this run is complete".to_owned(),
        Some(_) => "this run ended early, but has no journal.jsonl to go on with".to_owned(),
        None => "it holds no journal.jsonl, which a run that was stopped leaves in its folder"
            .to_owned(),
    }
}
