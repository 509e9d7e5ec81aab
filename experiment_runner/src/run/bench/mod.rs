//! What all experiments of a run share: the rig they drive, simulated or real, and what ends them
//! early.

mod jobs;
mod loops;
mod opening;
#[cfg(test)]
pub(crate) mod stop_after;

use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

use friction_model::ModelName;

pub(super) use self::opening::open;
use super::journal::Journal;
use super::recorder::{Kept, Marks, Stream};
use super::results::Reconnection;
use super::{Pace, RunError, RunOptions};
use crate::compensation::Arm;
#[cfg(feature = "ros")]
use crate::nodes::{NodesBench, Wanted};
use rig_setup::BenchRig;
#[cfg(feature = "ros")]
use rig_setup::{RigChoice, RigSetupError};
use work::progress::Progress;

/// The axis that a run drives.
pub(crate) enum Axis {
    /// A simulated one, which every run has for itself.
    Simulated,
    /// A real one, whose loop is closed here.
    Real(Box<BenchRig>),
    /// Whatever the running nodes drive; they close the loop.
    #[cfg(feature = "ros")]
    Nodes(NodesBench),
}

/// What all experiments of a run share.
pub(crate) struct Bench<'a> {
    pub(crate) options: &'a RunOptions,
    axis: Axis,
    pub(crate) progress: &'a Progress,
    pub(crate) cancel: &'a Arc<AtomicBool>,
    /// Where cycles go at once.
    stream: Option<Stream>,
    /// Why the rig ended the run.
    ended: Mutex<Option<String>>,
    /// Marks of what was repeated.
    marks: Option<Marks>,
    /// What was repeated because the line to the rig failed.
    reconnections: Mutex<Vec<Reconnection>>,
    /// What was done, for a run that goes on after a stop.
    journal: Mutex<Option<Journal>>,
}

impl<'a> Bench<'a> {
    /// The bench of a run.
    pub fn new(
        options: &'a RunOptions,
        axis: Axis,
        progress: &'a Progress,
        cancel: &'a Arc<AtomicBool>,
    ) -> Self {
        Self {
            options,
            axis,
            progress,
            cancel,
            stream: None,
            ended: Mutex::default(),
            marks: None,
            reconnections: Mutex::default(),
            journal: Mutex::default(),
        }
    }

    /// Whether runs take as long as they say.
    pub fn is_real_time(&self) -> bool {
        !self.is_simulated() || self.options.pace == Pace::RealTime
    }

    /// Runs in real time are recorded there while they go on.
    pub fn record_to(&mut self, stream: Option<Stream>, marks: Marks) {
        (self.stream, self.marks) = (stream, Some(marks));
    }

    /// What jobs give is kept there, and what it holds of a run before is not measured again.
    pub fn keep_in(&mut self, journal: Journal) {
        self.reconnections = Mutex::new(journal.reconnections());
        self.journal = Mutex::new(Some(journal));
    }

    /// The journal; nothing is kept from then on.
    pub fn journal(&self) -> Option<Journal> {
        self.kept_journal().take()
    }

    fn kept_journal(&self) -> MutexGuard<'_, Option<Journal>> {
        self.journal.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What keeps one of `every` so many cycles of a run.
    pub fn kept(&self, every: Option<u64>) -> Kept {
        Kept::one_of(every, self.stream.clone())
    }

    /// Whether every run has a rig for itself, in a time of its own.
    fn is_simulated(&self) -> bool {
        matches!(self.axis, Axis::Simulated)
    }

    /// Puts every loop together once, so that a parameter out of range is told before anything is
    /// written.
    pub fn check(options: &RunOptions) -> Result<(), RunError> {
        options.experiment.parts().try_for_each(|part| part.check(options))?;
        let tasks = options.compensation.tasks.iter().map(|task| &task.protocol);
        for protocol in
            [&options.velocity_tracking, &options.position_tracking].into_iter().chain(tasks)
        {
            let bed = options.test_bed.with_inverse(protocol.inverse);
            for arm in Arm::all(&options.means, &options.models) {
                let model = options.compensators.get(arm.model().unwrap_or(ModelName::Proposed));
                bed.control_loop(protocol.mode, protocol.reference, &model, arm.means(), 0, 0)?;
                #[cfg(feature = "ros")]
                if matches!(options.rig, RigChoice::Nodes { .. }) {
                    let (controller, estimator) =
                        bed.settings(protocol.mode, arm.means(), bed.simulation.period);
                    NodesBench::parameters(Wanted {
                        controller: &controller,
                        estimator: &estimator,
                        model: &model,
                    })
                    .map_err(|error| RigSetupError::Nodes(error.to_string()))?;
                }
            }
            bed.control_loop(protocol.mode, protocol.reference, &bed.friction, None, 0, 0)?;
        }
        Ok(())
    }

    /// The time at which a run starts: now on a real rig, else `planned` [ns since the Unix epoch].
    pub fn now_or(&self, planned: u64) -> u64 {
        let now = || {
            SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos() as u64)
        };
        if self.is_simulated() { planned } else { now() }
    }

    /// What was repeated until now.
    pub fn reconnections(&self) -> Vec<Reconnection> {
        self.reconnections.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Lets the rig go, at zero volts, and says why it ended the run, if it did.
    pub fn end(self) -> Option<String> {
        #[cfg(feature = "ros")]
        if let Axis::Nodes(nodes) = &self.axis
            && nodes.lost() > 0
        {
            self.progress.line(&format!(
                "{} cycles are missing: not everything was heard of them in time",
                nodes.lost()
            ));
        }
        self.ended.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}
