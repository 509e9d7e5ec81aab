//! Runs one experiment at a time, for whoever asks.

mod job;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use msgs::friction_msgs::{ExperimentStatus, RunExperimentFeedback};
use msgs::std_msgs::Header;

use self::job::{Job, Work};
use super::Refusal;
use super::ended::{Ended, Started};
use super::permissions::Permissions;
use super::request::ExperimentRequest;
use crate::run::RunError;
use files::{Folder, OutputError};
use rig_setup::RigChoice;
use work::progress::Progress;

/// How long a preempted experiment may take to end.
const PREEMPTION: Duration = Duration::from_secs(30);

/// Somebody who follows one experiment.
pub trait Watcher: Send + Sync + 'static {
    /// How far it is; a few times a second.
    fn progress(&self, feedback: RunExperimentFeedback);

    /// How it ended. The last call.
    fn ended(self: Box<Self>, ended: &Ended);
}

/// Nobody in particular.
impl Watcher for () {
    fn progress(&self, _feedback: RunExperimentFeedback) {}
    fn ended(self: Box<Self>, _ended: &Ended) {}
}

/// Hears of every change: a status for whoever is interested.
pub type Announce = dyn FnMut(ExperimentStatus) + Send;

/// The rig of requests that name none. Clones are one.
#[derive(Debug, Clone, Default)]
pub struct UsualRig(Arc<Mutex<RigChoice>>);

impl UsualRig {
    /// This rig from now on.
    pub fn set(&self, rig: RigChoice) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = rig;
    }

    fn get(&self) -> RigChoice {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// The place where experiments are asked for. Clones are the same desk.
#[derive(Clone)]
pub struct Desk {
    inner: Arc<Inner>,
}

struct Inner {
    permissions: Permissions,
    usual: UsualRig,
    announce: Mutex<Box<Announce>>,
    state: Mutex<State>,
    idle: Condvar,
}

#[derive(Default)]
struct State {
    running: Option<Running>,
    /// Ended experiments whose watcher is being told.
    telling: u32,
    /// Why nothing is started.
    closed: Option<Refusal>,
}

struct Running {
    started: Started,
    progress: Progress,
    cancel: Arc<AtomicBool>,
}

impl Desk {
    /// A desk whose requests have these permissions, and that tells everything to `announce`.
    #[must_use]
    pub fn new(permissions: Permissions, usual: UsualRig, announce: Box<Announce>) -> Self {
        let state = Mutex::default();
        let desk = Self {
            inner: Arc::new(Inner {
                permissions,
                usual,
                announce: Mutex::new(announce),
                state,
                idle: Condvar::new(),
            }),
        };
        let message = "ready: list_experiments tells what there is".to_owned();
        desk.inner.announce(ExperimentStatus {
            stage: "idle".to_owned(),
            remaining: f64::NAN,
            message,
            ..Default::default()
        });
        desk
    }

    /// Starts an experiment on a thread of its own, unless one runs. Once `cancel` is set it ends.
    ///
    /// With `preempt`, waits for the running one to end, which it is told to.
    ///
    /// # Errors
    /// [`Refusal`]; nothing was done then, and nothing is left behind.
    pub fn start(
        &self,
        request: &ExperimentRequest,
        cancel: Arc<AtomicBool>,
        watcher: impl Watcher,
    ) -> Result<Started, Refusal> {
        let permissions = &self.inner.permissions;
        let usual = self.inner.usual.get();
        let asked = request.folder.as_ref().map(|name| permissions.output(name)).transpose()?;
        let (name, work) = match request.errand(&usual, permissions)? {
            Some(errand) => (errand.name, Work::Errand(errand.prepared)),
            None => {
                let options = request.options(&usual, permissions)?;
                (options.experiment.as_str(), Work::Run(Box::new(options)))
            }
        };
        work.check(asked.as_deref())?;
        let mut state = self.inner.free(request.preempt)?;
        work.check(asked.as_deref())?;
        let folder = match (work.resumes(), asked) {
            (Some(begun), None) => begun,
            (Some(_), Some(_)) => {
                return Err(Refusal::BadRequest(
                    "what goes on has its folder already: leave output_folder out".to_owned(),
                ));
            }
            (None, Some(folder)) => make(&folder, permissions)?,
            (None, None) => {
                let reserved = Folder::reserve(None, permissions.runs(), name, false);
                make(&reserved.map_err(|error| bad_folder(error.into()))?.into_path(), permissions)?
            }
        };
        let run_id =
            folder.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let started = Started { run_id, experiment: name, folder };
        let progress = Progress::new(work.rig_seconds(), true);
        let running = Running {
            started: started.clone(),
            progress: progress.clone(),
            cancel: Arc::clone(&cancel),
        };
        let job =
            Job { inner: Arc::clone(&self.inner), started: started.clone(), progress, cancel };
        thread::Builder::new()
            .name("experiment".into())
            .spawn(move || job.run(work, Box::new(watcher)))
            .map_err(|error| Refusal::BadRequest(format!("no thread can be started: {error}")))?;
        state.running = Some(running);
        Ok(started)
    }

    /// Tells the running experiment to end; its name, if there is one.
    pub fn abort(&self) -> Option<String> {
        let state = self.inner.state();
        let running = state.running.as_ref()?;
        running.cancel.store(true, Ordering::Relaxed);
        Some(running.started.run_id.clone())
    }

    /// Takes requests again.
    pub fn open(&self) {
        self.inner.state().closed = None;
    }

    /// Ends the running experiment, if there is one, and refuses what is asked for from now on.
    /// Whether it ended within `patience`.
    pub fn close(&self, refusal: Refusal, patience: Duration) -> bool {
        let mut state = self.inner.state();
        state.closed = Some(refusal);
        if let Some(running) = &state.running {
            running.cancel.store(true, Ordering::Relaxed);
        }
        let (state, _) = self
            .inner
            .idle
            .wait_timeout_while(state, patience, |state| {
                state.running.is_some() || state.telling > 0
            })
            .unwrap_or_else(PoisonError::into_inner);
        state.running.is_none()
    }
}

impl Inner {
    fn state(&self) -> MutexGuard<'_, State> {
        // Every change of the state is one step: what a panicked thread left is whole.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The state once nothing runs.
    fn free(&self, preempt: bool) -> Result<MutexGuard<'_, State>, Refusal> {
        let mut state = self.state();
        let until = Instant::now() + PREEMPTION;
        loop {
            if let Some(refusal) = &state.closed {
                return Err(refusal.clone());
            }
            let Some(running) = &state.running else { return Ok(state) };
            let left = until.saturating_duration_since(Instant::now());
            if !preempt || left.is_zero() {
                let percent = (100.0 * running.progress.fraction()).clamp(0.0, 100.0) as u8;
                return Err(Refusal::Busy { run_id: running.started.run_id.clone(), percent });
            }
            running.cancel.store(true, Ordering::Relaxed);
            state = self.idle.wait_timeout(state, left).unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    fn announce(&self, status: ExperimentStatus) {
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        let header = Header::at(since.map_or(0, |since| since.as_nanos() as u64));
        // What hears is whole even if it panicked once.
        let mut announce = self.announce.lock().unwrap_or_else(PoisonError::into_inner);
        announce(ExperimentStatus { header, ..status });
    }
}

/// The folder, made, with its absolute path without links, which lies in the folder of runs.
fn make(folder: &Path, permissions: &Permissions) -> Result<PathBuf, Refusal> {
    let say = |error: std::io::Error| {
        Refusal::BadRequest(format!(
            "the results cannot be written to {}: {error}; name another output_folder",
            folder.display()
        ))
    };
    fs::create_dir_all(folder).map_err(say)?;
    let folder = &fs::canonicalize(folder).map_err(say)?;
    if !permissions.is_in_runs(folder) {
        return Err(say(std::io::Error::other("a link leads outside the folder of runs")));
    }
    // A folder can be there and still take no file.
    let probe = folder.join(".frictionlab-probe");
    fs::write(&probe, "").and_then(|()| fs::remove_file(&probe)).map_err(say)?;
    Ok(folder.clone())
}

pub(super) fn bad_folder(error: RunError) -> Refusal {
    Refusal::BadRequest(match error {
        RunError::Output(OutputError::NotEmpty(folder)) => format!(
            "the output_folder {} is not empty: name a new one, or leave it out and one is made",
            folder.display()
        ),
        RunError::Output(OutputError::Write { path, source }) => {
            format!(
                "the results cannot be written to {}: {source}; name another output_folder",
                path.display()
            )
        }
        other => other.to_string(),
    })
}
#[cfg(test)]
mod tests;
