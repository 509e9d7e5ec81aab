//! What all experiments of a run share: the rig they drive, simulated or real, and what ends them
//! early.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

use controller::ControlMode;
use friction_ident::TorqueSource;
use friction_model::{AnyModel, ModelName};
use rig_driver::RigError;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::experiment::Experiment;
use super::journal::Journal;
use super::recorder::{Kept, Marks, Stream};
use super::results::Reconnection;
use super::{Pace, RunError, RunOptions};
use crate::compensation::{Arm, Means};
use crate::control_loop::{ControlLoop, EPOCH_NS, RunningLoop};
#[cfg(feature = "ros")]
use crate::nodes::{NodesBench, Task, Wanted};
use crate::paced::Paced;
use crate::profile::Excitation;
use crate::test_bed::TestBed;
use crate::waveform::Waveform;
use rig_setup::{
    BenchRig, Opened, PATIENCE, Reopen, RigChoice, RigSetup, RigSetupError, SensorsPresent,
    require_device,
};
use work::progress::Progress;
use work::sequencer::{Completion, run_in_order};

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

/// What became of a job.
pub(crate) struct Made<R> {
    /// Start of its run [ns since the Unix epoch].
    pub start_ns: u64,
    /// What goes into the bag.
    pub kept: Kept,
    /// What it gave.
    pub result: R,
    /// Whether it was done before the run was stopped: the bag of that time has its cycles.
    pub replayed: bool,
}

/// Runs of one job after which a line that fails again ends the experiment.
const REPEATS: u32 = 20;

/// Opens the real rig, or finds the nodes, if that was chosen. The options that come back have its
/// period and voltage limit.
///
/// # Errors
/// [`RunError::Setup`] if it does not open; [`RunError::NoSensor`] if it lacks what the experiments
/// read.
pub(super) fn open(
    options: &RunOptions,
    progress: &Progress,
    cancel: &Arc<AtomicBool>,
) -> Result<(Axis, RunOptions), RunError> {
    let mut options = options.clone();
    if options.rig == RigChoice::Simulated {
        return Ok((Axis::Simulated, options));
    }
    if let RigChoice::Nodes { namespace } = options.rig.clone() {
        return open_nodes(options, namespace, progress, cancel);
    }
    let opened = opened(&options)?;
    require_sensors(&options, opened.sensors)?;
    let again = options.clone();
    opened.about.iter().for_each(|about| progress.line(about));
    let rig = if again.rig.comes_back() {
        let reopen: Reopen = Box::new(move || self::opened(&again));
        BenchRig::reopening(opened, Arc::clone(cancel), reopen)?
    } else {
        // A card whose watchdog expired is not driven again by itself.
        BenchRig::new(opened, Arc::clone(cancel))?
    };
    let simulation = &mut options.test_bed.simulation;
    simulation.period = rig.period();
    simulation.voltage_range = rig.voltage_range();
    simulation.voltage_limit = simulation.voltage_limit.min(rig.voltage_limit());
    Ok((Axis::Real(Box::new(rig)), options))
}

/// The real rig, open and the one that its profile is of.
fn opened(options: &RunOptions) -> Result<Opened, RigSetupError> {
    let setup = RigSetup {
        calibration: options.calibration,
        limits: options.limits,
        friction: options.test_bed.friction,
        ..RigSetup::default()
    };
    let opened = options.rig.open(&setup)?;
    let profile = options.rig_profile.as_ref().and_then(|profile| profile.description.as_ref());
    if let Some(expected) = profile {
        require_device(expected, &options.rig, opened.description.as_ref())?;
    }
    Ok(opened)
}

#[cfg(feature = "ros")]
fn open_nodes(
    mut options: RunOptions,
    namespace: Option<String>,
    progress: &Progress,
    cancel: &Arc<AtomicBool>,
) -> Result<(Axis, RunOptions), RunError> {
    progress.stage("looking for the nodes");
    let nodes = NodesBench::open(namespace, Arc::clone(cancel))?;
    require_sensors(&options, SensorsPresent { torque: nodes.torque_sensor(), current: false })?;
    progress.line(&format!(
        "the nodes are there: a cycle every {:.3} ms, at most {:.2} V",
        nodes.period() * 1e3,
        nodes.voltage_limit()
    ));
    let simulation = &mut options.test_bed.simulation;
    simulation.period = nodes.period();
    simulation.voltage_limit = simulation.voltage_limit.min(nodes.voltage_limit());
    Ok((Axis::Nodes(nodes), options))
}

#[cfg(not(feature = "ros"))]
fn open_nodes(
    _options: RunOptions,
    _namespace: Option<String>,
    _progress: &Progress,
    _cancel: &Arc<AtomicBool>,
) -> Result<(Axis, RunOptions), RunError> {
    Err(RigSetupError::Nodes(
        "this program was built without ROS 2: build it with the feature `ros`".to_owned(),
    )
    .into())
}

fn require_sensors(options: &RunOptions, sensors: SensorsPresent) -> Result<(), RunError> {
    if !options.experiment.parts().any(Experiment::reads_torque) {
        return Ok(());
    }
    match options.torque.source {
        TorqueSource::Sensor if !sensors.torque => Err(RunError::NoSensor {
            sensor: "torque sensor",
            instead: if sensors.current { "current (or voltage)" } else { "voltage" },
        }),
        TorqueSource::Current if !sensors.current => Err(RunError::NoSensor {
            sensor: "measurement of the motor current",
            instead: "voltage",
        }),
        _ => Ok(()),
    }
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

    /// A loop around the rig that is at rest, following `task`. `planned` is seed and start of a
    /// simulated one.
    ///
    /// # Errors
    /// [`RunError`] names the parameter that is out of range, or says why the real rig may not
    /// move.
    pub fn control_loop(
        &self,
        bed: &TestBed,
        (mode, reference): (ControlMode, Waveform),
        observer: &AnyModel,
        means: Option<Means>,
        (seed, start_ns): (u64, u64),
    ) -> Result<Box<dyn RunningLoop>, RunError> {
        #[cfg(feature = "ros")]
        if let Axis::Nodes(nodes) = &self.axis {
            return lend(nodes, bed, (mode, means), observer, Task::Follow(reference));
        }
        Ok(Box::new(self.loop_here(bed, (mode, reference), observer, means, (seed, start_ns))?))
    }

    /// A loop that is closed here.
    fn loop_here(
        &self,
        bed: &TestBed,
        (mode, reference): (ControlMode, Waveform),
        observer: &AnyModel,
        means: Option<Means>,
        (seed, start_ns): (u64, u64),
    ) -> Result<ControlLoop, RunError> {
        Ok(match &self.axis {
            Axis::Real(rig) => {
                let rig = rig.lend()?;
                bed.loop_around(rig, mode, reference, observer, means, self.now_or(start_ns))?
            }
            _ => self.paced(bed.control_loop(mode, reference, observer, means, seed, start_ns)?),
        })
    }

    /// A simulated loop at the pace that was asked for.
    fn paced(&self, control: ControlLoop) -> ControlLoop {
        match self.options.pace {
            Pace::Offline => control,
            Pace::RealTime => {
                control.through(|rig| Box::new(Paced::new(rig, Arc::clone(self.cancel))))
            }
        }
    }

    /// The same, driven by `excitation`; nothing compensates. With `feed_forward` the reference
    /// also goes through the inverse of the drive.
    ///
    /// # Errors
    /// As for [`control_loop`](Self::control_loop).
    pub fn excited_loop(
        &self,
        excitation: Excitation,
        feed_forward: bool,
        planned: (u64, u64),
    ) -> Result<Box<dyn RunningLoop>, RunError> {
        // Nothing compensates here: the observer only keeps the recorder's topics alike.
        let observer = self.options.compensators.get(ModelName::Proposed);
        let bed = self.options.test_bed.fed_forward(feed_forward);
        #[cfg(feature = "ros")]
        if let Axis::Nodes(nodes) = &self.axis {
            return lend(
                nodes,
                &bed,
                (excitation.mode(), None),
                &observer,
                Task::Excite(excitation),
            );
        }
        let unused = Waveform::ConstantVelocity { velocity: 0.0 };
        let control =
            self.loop_here(&bed, (excitation.mode(), unused), &observer, None, planned)?;
        Ok(Box::new(control.excited(excitation)))
    }

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

/// The nodes for one run.
#[cfg(feature = "ros")]
fn lend(
    nodes: &NodesBench,
    bed: &TestBed,
    (mode, means): (ControlMode, Option<Means>),
    model: &AnyModel,
    task: Task,
) -> Result<Box<dyn RunningLoop>, RunError> {
    let (controller, estimator) = bed.settings(mode, means, nodes.period());
    let wanted = Wanted { controller: &controller, estimator: &estimator, model };
    Ok(Box::new(nodes.lend(wanted, task)?))
}

/// A stop in the middle of a run, for tests: after so many jobs of whatever experiment.
#[cfg(test)]
pub(crate) mod stop_after {
    use std::cell::Cell;
    use std::sync::atomic::{AtomicBool, Ordering};

    thread_local!(static LEFT: Cell<Option<usize>> = const { Cell::new(None) });

    /// Stops the next run of this thread once `jobs` are delivered, or not at all.
    pub fn set(jobs: Option<usize>) {
        LEFT.set(jobs);
    }

    /// Jobs that are left until the stop.
    pub fn left() -> Option<usize> {
        LEFT.get()
    }

    pub(super) fn count(cancel: &AtomicBool) {
        if let Some(left) = LEFT.get() {
            LEFT.set(Some(left.saturating_sub(1)));
            if left <= 1 {
                cancel.store(true, Ordering::Relaxed);
            }
        }
    }
}
