//! The loop in real time, on ROS 2: rig, observer and controller in one process, recorded and published.
//!
//! Three threads share the work. The control thread ([`control`]) runs the loop at absolute deadlines and does nothing
//! else: no lock, no allocation, no message. Its cycles leave through two bounded queues, one to the thread that publishes
//! ([`publishing`]) and one to the thread that records ([`recording`]). A full queue costs a cycle, which is counted and
//! told, never a wait.

mod control;
mod diagnostics;
mod error;
mod publishing;
mod recording;
mod report;

use std::{
    collections::BTreeMap,
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64},
    },
    thread,
    time::{Duration, SystemTime, UNIX_EPOCH},
};

use controller::ControlMode;
use friction_model::AnyModel;
use rig_driver::{
    Calibration,
    safety::{SafetyLimits, Supervised},
};
use ros_node::{Discovery, Participant, deadlines};
use serde::Serialize;

pub use error::LiveError;
pub use report::LiveReport;
pub use ros_node::timing::{Percentiles, Timing};

use crate::compensation::Means;
use crate::{
    bag::{BagOptions, BagWriter},
    cycle::CycleSample,
    messages::CycleTopics,
    rig::{Opened, RigChoice},
    test_bed::TestBed,
    waveform::Waveform,
};

/// Cycles that wait for the publisher: half a second at 1 kHz.
const PUBLISHER_QUEUE: usize = 512;
/// Cycles that wait for the recorder: eight seconds at 1 kHz, since a disk can be busy for that long.
const RECORDER_QUEUE: usize = 8192;
/// Time to start the threads before the first cycle.
const HEAD_START: Duration = Duration::from_millis(50);

/// What a live run does.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LiveOptions {
    /// Folder for the results; the bag goes to `bag` in it.
    pub out: PathBuf,
    /// Which rig.
    pub rig: RigChoice,
    /// What corrects a real rig's readings.
    pub calibration: Option<Calibration>,
    /// The bench: the simulated rig and its friction, and what estimator and controller are made of.
    pub test_bed: TestBed,
    /// What the controller regulates.
    pub mode: ControlMode,
    /// Where the axis should be.
    pub reference: Waveform,
    /// Model of the observer.
    pub observer: AnyModel,
    /// By what means the estimate enters the command; none for not at all.
    pub means: Option<Means>,
    /// The bench's period was asked for by name: a device with another one is refused.
    pub rate_given: bool,
    /// Seed of the sensors' noise.
    pub seed: u64,
    /// Length of the run [s]; `None` until it is stopped.
    pub duration: Option<f64>,
    /// Folder for the experiments that others ask for meanwhile; none for taking no requests.
    pub serve: Option<PathBuf>,
}

/// One cycle on its way to publisher and recorder.
#[derive(Debug, Clone, Copy)]
struct LiveCycle {
    sample: CycleSample,
    /// Time since the start of the cycle before [ns]; zero for the first.
    period_ns: u64,
    /// Time the step took [ns].
    execution_ns: u64,
}

/// What the control thread counts for others to see. Written by it alone.
#[derive(Debug, Default)]
struct Counters {
    overruns: AtomicU64,
    not_published: AtomicU64,
    not_recorded: AtomicU64,
}

/// Runs the loop in real time until the duration is over or `stop` is set.
///
/// `started` is called once everything runs, with a line about the control thread's priority.
///
/// # Errors
/// [`LiveError`] names the environment variable, folder or option at fault. What was recorded before a failure stays
/// readable.
pub fn run(
    options: &LiveOptions,
    stop: &Arc<AtomicBool>,
    started: impl FnOnce(&str),
) -> Result<LiveReport, LiveError> {
    let discovery = Discovery::from_environment()?;
    // Put together once for nothing, so that a wrong option leaves neither a folder nor a node behind.
    options.control_loop(0, None)?;
    let real = options.open_rig()?;
    let period = real.as_ref().map_or(options.test_bed.simulation.period, |opened| opened.rig.period());
    let about_line = real.as_ref().and_then(|opened| opened.about.clone());

    let participant = Participant::join(&discovery)?;
    let nodes = publishing::Nodes::new(participant, options.serve.as_deref())?;
    let mut bag = BagWriter::create(&options.out.join("bag"), BagOptions::default())?;
    bag.metadata("frictionlab", options.metadata())?;
    let topics = CycleTopics::open(&mut bag)?;

    // Joining takes a while; only now can the stamp of the first cycle be told, and its deadline be the same instant.
    let first_deadline = deadlines::now_ns() + HEAD_START.as_nanos() as u64;
    let control_loop = options.control_loop(epoch_ns(SystemTime::now() + HEAD_START), real)?;

    let counters = Arc::new(Counters::default());
    let (to_publisher, for_publisher) = rtrb::RingBuffer::new(PUBLISHER_QUEUE);
    let (to_recorder, for_recorder) = rtrb::RingBuffer::new(RECORDER_QUEUE);
    let spawn_error = |source| LiveError::Thread { source };

    let recorder = {
        let stop = Arc::clone(stop);
        let record = move || recording::record(bag, topics, for_recorder, &stop);
        thread::Builder::new().name("recorder".into()).spawn(record).map_err(spawn_error)?
    };
    let publisher = {
        let counters = Arc::clone(&counters);
        let publish = move || publishing::publish(nodes, for_publisher, &counters);
        thread::Builder::new().name("publisher".into()).spawn(publish).map_err(spawn_error)?
    };
    let (priority, told_priority) = std::sync::mpsc::channel();
    let control = {
        let task = control::Task {
            control_loop,
            cycles: options.duration.map(|duration| (duration / period).round() as u64),
            first_deadline,
            to_publisher,
            to_recorder,
            counters: Arc::clone(&counters),
            stop: Arc::clone(stop),
        };
        let run = move || task.run(|line| _ = priority.send(line));
        thread::Builder::new().name("control".into()).spawn(run).map_err(spawn_error)?
    };
    if let Ok(line) = told_priority.recv() {
        started(&about_line.map_or_else(|| line.clone(), |about| format!("{about}\n{line}")));
    }

    // The control thread drops its ends of the queues when it is done, which ends the other two.
    let control = control.join().map_err(|_| LiveError::Panicked { thread: "control" });
    let published = publisher.join().map_err(|_| LiveError::Panicked { thread: "publisher" });
    let recorded = recorder.join().map_err(|_| LiveError::Panicked { thread: "recorder" });
    let (control, published, bag) = (control?, published?, recorded??);
    if let Some(error) = control.rig_error {
        return Err(LiveError::Rig(error));
    }
    Ok(LiveReport::new(options, control, published, bag, &counters))
}

impl LiveOptions {
    /// The loop around `real`, or around the simulated rig.
    fn control_loop(
        &self,
        start_ns: u64,
        real: Option<Opened>,
    ) -> Result<crate::control_loop::ControlLoop, LiveError> {
        if let Some(duration) = self.duration.filter(|duration| !(*duration > 0.0 && *duration <= 1e7)) {
            return Err(LiveError::Duration(duration));
        }
        let Self { test_bed, mode, reference, observer, means, seed, .. } = self;
        Ok(match real {
            Some(Opened { rig, limits, .. }) => {
                let rig = Supervised::activated(rig, limits).map_err(LiveError::Rig)?;
                test_bed.loop_around(Box::new(rig), *mode, *reference, observer, *means, start_ns)?
            }
            None => {
                let mut test_bed = *test_bed;
                // A simulated shaft stands still while its loop waits: a late cycle never asks for a new activation.
                let limits = SafetyLimits::for_simulation(&test_bed.simulation);
                let limits = SafetyLimits { cycle_lost: f64::MAX, ..limits };
                test_bed.simulation.safety.get_or_insert(limits);
                test_bed.control_loop(*mode, *reference, observer, *means, *seed, start_ns)?
            }
        })
    }

    /// The real rig, if one was chosen, its motor at zero volts.
    fn open_rig(&self) -> Result<Option<Opened>, LiveError> {
        if self.rig == RigChoice::Simulated {
            return Ok(None);
        }
        let opened = self.rig.open(self.test_bed.friction, self.seed, None, self.calibration)?;
        let (period, asked) = (opened.rig.period(), 1.0 / self.test_bed.simulation.period);
        if self.rate_given && (period * asked - 1.0).abs() > 1e-6 {
            return Err(LiveError::Rate { period, asked });
        }
        Ok(Some(opened))
    }

    /// What the bag says about the run.
    fn metadata(&self) -> BTreeMap<String, String> {
        let options = serde_json::to_string(self).unwrap_or_else(|error| error.to_string());
        BTreeMap::from([
            ("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
            ("command".to_owned(), "live".to_owned()),
            ("seed".to_owned(), self.seed.to_string()),
            ("options".to_owned(), options),
        ])
    }
}

/// Nanoseconds since the Unix epoch; zero before it.
fn epoch_ns(time: SystemTime) -> u64 {
    time.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos() as u64)
}
