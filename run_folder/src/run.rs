//! One folder.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use chrono::{DateTime, SecondsFormat, Utc};
use serde::Serialize;
use serde_json::Value;
use strum::VariantArray;

use crate::kind::Kind;
use crate::measure;

/// Name of a report in its folder.
pub(crate) const REPORT: &str = "report.html";
/// Name of a bag in its folder.
const BAG: &str = "bag";

/// A folder of results.
#[derive(Debug, Clone, Serialize)]
pub struct Run {
    /// Where it is.
    pub folder: PathBuf,
    /// What was done.
    pub kind: Kind,
    /// What exactly, where the kind does not say it: an experiment, a model that was chosen.
    pub what: Option<String>,
    /// When its document was written, in UTC: `2026-05-01T12:00:00Z`.
    pub made: Option<String>,
    /// How it ended.
    pub state: State,
    /// The same in words.
    pub said: String,
    /// Its report, if there is one.
    pub report: Option<PathBuf>,
    /// Its recording, if there is one.
    pub bag: Option<PathBuf>,
    /// All files beneath \[bytes\].
    pub bytes: u64,
    /// Which version of the program made it.
    pub program_version: Option<String>,
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// Everything was done.
    Complete,
    /// It was stopped, or ended early; what is there is whole.
    Interrupted,
    /// It has begun and is not done: it goes on now, or was killed.
    Unfinished,
    /// Nothing was to come of it but the recording.
    Recorded,
}

/// Why a folder is none of a run.
#[derive(Debug, thiserror::Error)]
pub enum NoRun {
    /// There is nothing.
    #[error("{} is not there", .0.display())]
    Missing(PathBuf),
    /// It is a file.
    #[error("{} is a file; name the folder of a run, as runs/all-1", .0.display())]
    File(PathBuf),
    /// Nothing in it is of this program.
    #[error(
        "{} is no folder of a run: it has neither run.json nor another document of a command",
        .0.display()
    )]
    Foreign(PathBuf),
    /// Its document cannot be read.
    #[error("{} is damaged: {why}", .file.display())]
    Damaged {
        /// The document.
        file: PathBuf,
        /// What is wrong with it.
        why: String,
    },
    /// The system refuses.
    #[error("{} cannot be read: {source}", .path.display())]
    Unreadable {
        /// What was to be read.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

impl Run {
    /// What `folder` holds.
    ///
    /// # Errors
    /// [`NoRun`] says why it is none of a run.
    pub fn open(folder: &Path) -> Result<Self, NoRun> {
        Self::open_with(folder).map(|(run, _)| run)
    }

    /// The same, with the document; `null` where there is none yet.
    pub(crate) fn open_with(folder: &Path) -> Result<(Self, Value), NoRun> {
        let about = fs::metadata(folder).map_err(|source| match source.kind() {
            ErrorKind::NotFound => NoRun::Missing(folder.to_owned()),
            _ => NoRun::Unreadable { path: folder.to_owned(), source },
        })?;
        if !about.is_dir() {
            return Err(NoRun::File(folder.to_owned()));
        }
        fs::read_dir(folder)
            .map_err(|source| NoRun::Unreadable { path: folder.to_owned(), source })?;
        for &kind in Kind::VARIANTS {
            let file = folder.join(kind.document());
            if file.is_file() {
                let document = read(kind, &file)?;
                return Ok((Self::of(folder, kind, &file, &document), document));
            }
            if let Some(file) = kind.begun().map(|name| folder.join(name))
                && file.is_file()
            {
                return Ok((Self::of(folder, kind, &file, &Value::Null), Value::Null));
            }
        }
        Err(NoRun::Foreign(folder.to_owned()))
    }

    fn of(folder: &Path, kind: Kind, file: &Path, document: &Value) -> Self {
        let (state, said) = ending(kind, folder, document);
        let beside =
            |name: &str, is: fn(&Path) -> bool| Some(folder.join(name)).filter(|it| is(it));
        Self {
            what: what(kind, document),
            made: fs::metadata(file).and_then(|about| about.modified()).ok().and_then(told),
            state,
            said,
            // A pipe of that name would be waited for.
            report: beside(REPORT, Path::is_file),
            bag: beside(BAG, Path::is_dir),
            bytes: measure::bytes(folder),
            program_version: document["program_version"].as_str().map(str::to_owned),
            folder: folder.to_owned(),
            kind,
        }
    }

    /// The kind with what exactly was done: `run tracking`.
    #[must_use]
    pub fn title(&self) -> String {
        match &self.what {
            Some(what) => format!("{} {what}", self.kind),
            None => self.kind.to_string(),
        }
    }
}

fn read(kind: Kind, file: &Path) -> Result<Value, NoRun> {
    if kind == Kind::Recording {
        return Ok(Value::Null);
    }
    let damaged = |why: String| NoRun::Damaged { file: file.to_owned(), why };
    let bytes = files::input::table(file)
        .map_err(|source| NoRun::Unreadable { path: file.to_owned(), source })?;
    let document: Value = serde_json::from_slice(&bytes)
        .map_err(|error| damaged(format!("it is no whole JSON: {error}")))?;
    let ours = document["format"].as_str().is_none_or(|name| name.starts_with("frictionlab-"));
    if !ours || kind.names().iter().all(|name| document.get(name).is_none()) {
        return Err(damaged(format!("it is no document of `frictionlab {kind}`")));
    }
    Ok(document)
}

/// An experiment, or the model that was chosen.
fn what(kind: Kind, document: &Value) -> Option<String> {
    let place = match kind {
        Kind::Run => "/options/experiment",
        Kind::Identify => "/ranking/chosen",
        Kind::Design => "/law",
        Kind::Commission => "/found/rig",
        _ => return None,
    };
    let said = document.pointer(place)?;
    said.as_str().map(str::to_owned).or_else(|| {
        // A law is an object with one name.
        said.as_object().and_then(|law| law.keys().next()).cloned()
    })
}

fn ending(kind: Kind, folder: &Path, document: &Value) -> (State, String) {
    if kind == Kind::Recording {
        return (State::Recorded, "a recording".to_owned());
    }
    if document.is_null() {
        let how = kind.resumed_by().unwrap_or_default();
        return (
            State::Unfinished,
            format!("not done; `{how} {}` goes on, unless it still runs", folder.display()),
        );
    }
    let stopped = document["status"] == "interrupted"
        || ["interrupted", "stopped"].iter().any(|name| document[name] == true);
    let why = ["ended", "failure"].iter().find_map(|name| document[name].as_str());
    match (stopped, why) {
        (_, Some(why)) => (State::Interrupted, format!("ended early: {why}")),
        (true, None) => (State::Interrupted, "stopped before its end".to_owned()),
        (false, None) => (State::Complete, "complete".to_owned()),
    }
}

fn told(at: SystemTime) -> Option<String> {
    let since = at.duration_since(SystemTime::UNIX_EPOCH).ok()?;
    let seconds = i64::try_from(since.as_secs()).ok()?;
    DateTime::<Utc>::from_timestamp(seconds, 0)
        .map(|at| at.to_rfc3339_opts(SecondsFormat::Secs, true))
}
