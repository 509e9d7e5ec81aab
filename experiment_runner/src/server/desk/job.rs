//! The thread of an experiment.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use files::{OutputError, is_empty_or_missing};
use msgs::friction_msgs::{ExperimentStatus, RunExperimentFeedback};
use work::progress::Progress;

use super::{Inner, Watcher, bad_folder};
use crate::errand::Prepared;
use crate::run::{self, RunOptions};
use crate::server::Refusal;
use crate::server::ended::{Came, Ended, Started};
use crate::server::outcome;

/// Time between two reports of a running experiment.
const TICK: Duration = Duration::from_millis(250);

/// Time between two statuses of the same stage: whoever comes late is sent what the writer still
/// keeps.
const STATUS: Duration = Duration::from_secs(1);

/// What is to be done.
pub(super) enum Work {
    /// An experiment.
    Run(Box<RunOptions>),
    /// Work beside experiments.
    Errand(Box<dyn Prepared>),
}

impl Work {
    /// Time that it takes on a rig \[s\].
    pub(super) fn rig_seconds(&self) -> f64 {
        match self {
            Self::Run(options) => options.rig_seconds(),
            Self::Errand(prepared) => prepared.rig_seconds(),
        }
    }

    /// The folder in which it goes on; none for a new one.
    pub(super) fn resumes(&self) -> Option<PathBuf> {
        match self {
            Self::Run(_) => None,
            Self::Errand(prepared) => prepared.resumes(),
        }
    }

    /// Refuses options that cannot be, or a folder that is in use. Nothing is written by then.
    pub(super) fn check(&self, folder: Option<&Path>) -> Result<(), Refusal> {
        match (self, folder) {
            (Self::Run(options), Some(folder)) => run::check(options, folder).map_err(bad_folder),
            (Self::Run(options), None) => run::check_options(options).map_err(bad_folder),
            (Self::Errand(_), Some(folder)) => {
                let error = match is_empty_or_missing(folder) {
                    Ok(true) => return Ok(()),
                    Ok(false) => OutputError::NotEmpty(folder.to_owned()),
                    Err(source) => OutputError::Write { path: folder.to_owned(), source },
                };
                Err(bad_folder(error.into()))
            }
            (Self::Errand(_), None) => Ok(()),
        }
    }

    fn done(self, job: &Job) -> Came {
        let folder = &job.started.folder;
        match self {
            Self::Run(options) => {
                let done = run::execute(&options, folder, &job.progress, &job.cancel);
                Came::Run(Box::new(done.map(|outcome| outcome.results).map_err(Arc::new)))
            }
            Self::Errand(prepared) => {
                Came::Errand(prepared.carry_out(folder, &job.progress, &job.cancel))
            }
        }
    }
}

/// What the thread of an experiment has.
pub(super) struct Job {
    pub(super) inner: Arc<Inner>,
    pub(super) started: Started,
    pub(super) progress: Progress,
    pub(super) cancel: Arc<AtomicBool>,
}

impl Job {
    pub(super) fn run(self, work: Work, watcher: Box<dyn Watcher>) {
        let release = Release(Arc::clone(&self.inner));
        let begun = Instant::now();
        let (working, worked) = mpsc::channel::<()>();
        let came = thread::scope(|scope| {
            let (job, watcher) = (&self, &*watcher);
            scope.spawn(move || {
                let mut told = Told::default();
                loop {
                    job.tell(begun, watcher, &mut told);
                    if worked.recv_timeout(TICK) != Err(RecvTimeoutError::Timeout) {
                        break;
                    }
                }
            });
            // Dropped even by a panic, so that the one above ends.
            let _working = working;
            work.done(&self)
        });
        let ended = Ended { started: self.started.clone(), came };
        let complete = ended.is_done() && !self.cancel.load(Ordering::Relaxed);
        let _telling = Telling::new(&self.inner);
        // Free before anybody hears of the end, so that whoever does can ask for the next.
        drop(release);
        self.inner.announce(ExperimentStatus {
            stage: "idle".to_owned(),
            progress: if complete { 1.0 } else { self.progress.fraction() },
            remaining: 0.0,
            bag_path: self.bag(),
            message: outcome::message(&ended),
            ..Default::default()
        });
        watcher.ended(&ended);
    }

    fn bag(&self) -> String {
        self.started.folder.join("bag").display().to_string()
    }

    /// Tells how far it is: the watcher each time, everybody when the stage changes or a second has
    /// gone by.
    fn tell(&self, begun: Instant, watcher: &dyn Watcher, told: &mut Told) {
        let (stage, fraction) = (self.progress.message(), self.progress.fraction());
        let elapsed = begun.elapsed().as_secs_f64();
        // The first seconds tell little.
        let remaining =
            if fraction > 0.01 { elapsed * (1.0 - fraction) / fraction } else { f64::NAN };
        if told.stage != stage || told.at.is_none_or(|at| at.elapsed() >= STATUS) {
            self.inner.announce(ExperimentStatus {
                experiment: self.started.experiment.to_owned(),
                stage: stage.clone(),
                repetition: repetition(&stage),
                progress: fraction,
                remaining,
                bag_path: self.bag(),
                message: format!("{} runs", self.started.run_id),
                ..Default::default()
            });
            *told = Told { stage: stage.clone(), at: Some(Instant::now()) };
        }
        watcher.progress(RunExperimentFeedback {
            repetition: repetition(&stage),
            stage,
            progress: fraction,
            remaining,
            rig_seconds: self.progress.position(),
        });
    }
}

/// Makes the desk free again, however the experiment ended.
struct Release(Arc<Inner>);

impl Drop for Release {
    fn drop(&mut self) {
        self.0.state().running = None;
        self.0.idle.notify_all();
    }
}

/// Whoever closes the desk waits until the watcher was told.
struct Telling(Arc<Inner>);

impl Telling {
    fn new(inner: &Arc<Inner>) -> Self {
        inner.state().telling += 1;
        Self(Arc::clone(inner))
    }
}

impl Drop for Telling {
    fn drop(&mut self) {
        let mut state = self.0.state();
        state.telling = state.telling.saturating_sub(1);
        drop(state);
        self.0.idle.notify_all();
    }
}

/// What everybody was told last.
#[derive(Default)]
struct Told {
    stage: String,
    at: Option<Instant>,
}

/// The repetition in the words of a stage, as in `friction: set 1 of 2, repetition 3`; 0 where
/// there is none.
pub(super) fn repetition(stage: &str) -> u32 {
    let digits = stage.rsplit_once("repetition ").map(|(_, rest)| rest);
    digits.and_then(|rest| rest.split_whitespace().next()?.parse().ok()).unwrap_or(0)
}
