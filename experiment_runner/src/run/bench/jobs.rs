//! Jobs done in order, kept in the journal, and repeated where the line failed.

use std::sync::PoisonError;
use std::sync::atomic::{AtomicBool, Ordering};

use rig_driver::RigError;
use serde::Serialize;
use serde::de::DeserializeOwned;

#[cfg(test)]
use super::stop_after;
use super::{Axis, Bench};
use crate::control_loop::EPOCH_NS;
use crate::run::RunError;
use crate::run::journal::Journal;
use crate::run::made::Made;
use crate::run::recorder::Kept;
use crate::run::results::Reconnection;
use rig_setup::PATIENCE;
use work::sequencer::{Completion, run_in_order};

/// Runs of one job after which a line that fails again ends the experiment.
const REPEATS: u32 = 20;

impl Bench<'_> {
    /// Does the jobs, on all cores where the rig is simulated and one after the other on a real
    /// one, and delivers what comes of them in order. A real rig that fails or is stopped cancels
    /// the rest; [`end`](Self::end) says why. What a run before did of them is not done again.
    ///
    /// # Errors
    /// The first error in the order of the jobs.
    pub fn in_order<J: Sync, R: Send + Serialize + DeserializeOwned>(
        &self,
        jobs: &[J],
        work: impl Fn(&J) -> Result<Made<R>, RunError> + Sync,
        mut deliver: impl FnMut(&J, Made<R>) -> Result<(), RunError>,
    ) -> Result<Completion, RunError> {
        let replayed = self.replay(jobs, &mut deliver)?;
        let jobs = &jobs[replayed..];
        if !jobs.is_empty() {
            self.mark_resumed()?;
        }
        match self.measure(jobs, work, deliver)? {
            Completion::All => Ok(Completion::All),
            Completion::Cancelled { delivered } => {
                Ok(Completion::Cancelled { delivered: replayed + delivered })
            }
        }
    }

    /// Delivers what a run before did of the jobs; how many of them.
    fn replay<J, R: DeserializeOwned>(
        &self,
        jobs: &[J],
        deliver: &mut impl FnMut(&J, Made<R>) -> Result<(), RunError>,
    ) -> Result<usize, RunError> {
        for (replayed, job) in jobs.iter().enumerate() {
            let done = self.kept_journal().as_mut().map_or(Ok(None), Journal::replay)?;
            let Some(done) = done else { return Ok(replayed) };
            let (start_ns, result) = (done.start_ns, done.result);
            deliver(job, Made { start_ns, kept: Kept::default(), result, replayed: true })?;
        }
        Ok(jobs.len())
    }

    /// Says in the bag that a run goes on, before the first run that it measures.
    fn mark_resumed(&self) -> Result<(), RunError> {
        let after = self.kept_journal().as_ref().and_then(Journal::resumed_after);
        match (after, &self.marks) {
            (Some(after), Some(marks)) => {
                marks.resumed(self.now_or(after.max(EPOCH_NS)), self.options.experiment.as_str())
            }
            _ => Ok(()),
        }
    }

    /// Does the jobs and delivers what comes of them in order; each is in the journal then.
    fn measure<J: Sync, R: Send + Serialize>(
        &self,
        jobs: &[J],
        work: impl Fn(&J) -> Result<Made<R>, RunError> + Sync,
        mut deliver: impl FnMut(&J, Made<R>) -> Result<(), RunError>,
    ) -> Result<Completion, RunError> {
        let workers = if self.is_simulated() { self.options.workers } else { 1 };
        let mut delivered = 0;
        // What ended one run on the one axis there is ends them all: the next must not begin while
        // the first error is on its way.
        let failed = AtomicBool::new(false);
        let work = |job: &J| {
            if !self.is_simulated() && failed.load(Ordering::Relaxed) {
                return Err(RigError::Stopped.into());
            }
            self.repeated(|| work(job)).inspect_err(|_| failed.store(true, Ordering::Relaxed))
        };
        let completion = run_in_order(jobs, workers, self.cancel, work, |job, made| {
            delivered += 1;
            #[cfg(test)]
            stop_after::count(self.cancel);
            let line = match &*self.kept_journal() {
                Some(journal) => Some(journal.line(made.start_ns, &made.result)?),
                None => None,
            };
            deliver(job, made)?;
            let Some(line) = line else { return Ok(()) };
            if let Some(marks) = &self.marks {
                marks.settle(self.stream.as_ref())?;
            }
            self.kept_journal().as_mut().map_or(Ok(()), |journal| journal.add(line))
        });
        let Err(error) = completion else { return completion };
        let lost = matches!(error, RunError::NotBack { .. });
        let said = error.of_rig().filter(|_| !self.is_simulated());
        if said.is_none() && !lost {
            return Err(error);
        }
        if said != Some(&RigError::Stopped) {
            let mut ended = self.ended.lock().unwrap_or_else(PoisonError::into_inner);
            ended.get_or_insert_with(|| error.to_string());
        }
        Ok(Completion::Cancelled { delivered })
    }

    /// Does `work`, and once more after the rig was opened anew where its line failed: the run at
    /// hand is repeated from rest. The motor has zero volts from the failure on, and what is about
    /// the motor is never repeated.
    fn repeated<R>(&self, work: impl Fn() -> Result<R, RunError>) -> Result<R, RunError> {
        let mut repeats = 0;
        loop {
            let error = match work() {
                Err(error) => error,
                done => return done,
            };
            let Axis::Real(rig) = &self.axis else { return Err(error) };
            let of_the_line = rig.reopens() && error.of_rig().is_some_and(RigError::is_of_the_line);
            if !of_the_line || repeats == REPEATS || self.cancel.load(Ordering::Relaxed) {
                return Err(error);
            }
            repeats += 1;
            let said = error.to_string();
            self.progress.line(&format!("{said}: zero volts. It goes on by itself if the line is back within {PATIENCE} s; ctrl-C before you touch the rig"));
            let seconds = match rig.reconnect() {
                Ok(seconds) => seconds,
                Err(_) if self.cancel.load(Ordering::Relaxed) => {
                    return Err(RigError::Stopped.into());
                }
                Err(why) => return Err(RunError::NotBack { said, why: why.to_string() }),
            };
            self.progress.line(&format!(
                "the line is back after {seconds:.1} s; the run at hand is repeated"
            ));
            let at = self.now_or(0);
            if let Some(marks) = &self.marks {
                marks.repeated(at, self.options.experiment.as_str(), &said)?;
            }
            let at_seconds = at as f64 * 1e-9;
            let mut reconnections =
                self.reconnections.lock().unwrap_or_else(PoisonError::into_inner);
            let reconnection = Reconnection { at: at_seconds, seconds, said };
            if let Some(journal) = self.kept_journal().as_mut() {
                journal.reconnected(&reconnection)?;
            }
            reconnections.push(reconnection);
        }
    }
}
