//! The thread of an experiment.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use msgs::friction_msgs::{ExperimentStatus, RunExperimentFeedback};
use work::progress::Progress;

use super::{Inner, Watcher};
use crate::run::{self, RunOptions};
use crate::server::ended::{Ended, Started};
use crate::server::outcome;

/// Time between two reports of a running experiment.
const TICK: Duration = Duration::from_millis(250);

/// Time between two statuses of the same stage: whoever comes late is sent what the writer still
/// keeps.
const STATUS: Duration = Duration::from_secs(1);

/// What the thread of an experiment has.
pub(super) struct Job {
    pub(super) inner: Arc<Inner>,
    pub(super) options: RunOptions,
    pub(super) started: Started,
    pub(super) progress: Progress,
    pub(super) cancel: Arc<AtomicBool>,
}

impl Job {
    pub(super) fn run(self, watcher: Box<dyn Watcher>) {
        let release = Release(Arc::clone(&self.inner));
        let begun = Instant::now();
        let (working, worked) = mpsc::channel::<()>();
        let results = thread::scope(|scope| {
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
            run::execute(&self.options, &self.started.folder, &self.progress, &self.cancel)
        });
        let results = results.map(|outcome| outcome.results).map_err(Arc::new);
        let ended = Ended { started: self.started.clone(), results };
        let complete = ended.results.is_ok() && !self.cancel.load(Ordering::Relaxed);
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
