//! The bag of a run: cycles, the status of the experiment, and everything needed to repeat it.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender, SyncSender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use msgs::friction_msgs::ExperimentStatus;
use msgs::std_msgs::Header;
use msgs::topics;

use super::{RunError, RunOptions};
use crate::cycle::CycleSample;
use crate::messages::{CycleTopics, EncodedCycle};
use recording::bag::{BagError, BagOptions, BagSummary, BagWriter};
use rig_setup::RigChoice;

/// Pause between two runs on the bag's time axis \[ns\]. The shaft is at rest then.
const PAUSE_NS: u64 = 1_000_000_000;

/// Cycles that wait for the disk while a run goes on in real time: eight seconds at 1 kHz.
const WAITING: usize = 8192;
/// Time between two closings of a chunk then: as much as a kill can cost.
const FLUSH: Duration = Duration::from_millis(500);

/// Hands out the time at which each run starts: one after the other, as on a rig.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Timeline {
    next_ns: u64,
}

impl Timeline {
    /// Times from `epoch` on [ns since the Unix epoch].
    pub const fn from(epoch: u64) -> Self {
        Self { next_ns: epoch }
    }

    /// Start of a run of `seconds` [ns since the Unix epoch].
    pub fn start_of(&mut self, seconds: f64) -> u64 {
        let start = self.next_ns;
        self.next_ns += (seconds * 1e9).round() as u64 + PAUSE_NS;
        start
    }
}

/// Where the cycles of runs in real time go at once: whatever ends such a run, what it measured is
/// kept.
#[derive(Clone)]
pub(crate) struct Stream {
    cycles: SyncSender<Streamed>,
    lost: Arc<AtomicU64>,
}

/// What goes through a stream.
enum Streamed {
    Cycle(EncodedCycle),
    /// Asks to be told once everything before it is on the disk.
    Settle(Sender<()>),
}

/// Cycles of one run that go into the bag, encoded on the thread that ran it.
#[derive(Default)]
pub(crate) struct Kept {
    every: Option<u64>,
    cycles: Vec<EncodedCycle>,
    stream: Option<Stream>,
    error: Option<BagError>,
}

impl Kept {
    /// Keeps one of `every` so many cycles, or none; in a stream if there is one, else until the
    /// run is over.
    pub const fn one_of(every: Option<u64>, stream: Option<Stream>) -> Self {
        Self { every, cycles: Vec::new(), stream, error: None }
    }

    /// Takes a cycle in, if it is one to be kept.
    pub fn add(&mut self, sample: &CycleSample) {
        if self.every.is_some_and(|every| sample.measurement.cycle.is_multiple_of(every))
            && self.error.is_none()
        {
            let mut cycle = EncodedCycle::default();
            match cycle.encode(sample) {
                Ok(()) => match &self.stream {
                    None => self.cycles.push(cycle),
                    // A run in real time does not wait for the disk.
                    Some(stream) => {
                        if stream.cycles.try_send(Streamed::Cycle(cycle)).is_err() {
                            stream.lost.fetch_add(1, Ordering::Relaxed);
                        }
                    }
                },
                Err(error) => self.error = Some(error),
            }
        }
    }
}

/// The bag that is being written.
pub(crate) struct Recorder {
    writing: Arc<Mutex<Writing>>,
    bag_path: String,
    stream: Option<(Stream, JoinHandle<Result<(), BagError>>)>,
}

struct Writing {
    bag: BagWriter,
    topics: CycleTopics,
}

/// Marks in the bag what was repeated.
pub(crate) struct Marks {
    writing: Arc<Mutex<Writing>>,
    bag_path: String,
}

impl Marks {
    /// Says on `/experiment_status` that what was measured last is not used, because the line
    /// failed as `said`, and is measured once more.
    pub fn repeated(&self, stamp_ns: u64, experiment: &str, said: &str) -> Result<(), RunError> {
        let stage = format!("the run before this is not used and is repeated: {said}");
        write_status(&self.writing, &self.bag_path, stamp_ns, (experiment, &stage, 0.0))
    }

    /// Says there that a run that was stopped goes on.
    pub fn resumed(&self, stamp_ns: u64, experiment: &str) -> Result<(), RunError> {
        let stage = "resumed: the bag before this one has the runs before; the one that was under way when it ended is not used and is repeated";
        write_status(&self.writing, &self.bag_path, stamp_ns, (experiment, stage, 0.0))
    }

    /// Hands what was recorded to the system, and brings a stream's cycles to the disk: no job
    /// counts as done before what it recorded is safe.
    pub fn settle(&self, stream: Option<&Stream>) -> Result<(), RunError> {
        let Some(stream) = stream else { return Ok(locked(&self.writing).bag.flush()?) };
        let (settled, told) = mpsc::channel();
        // A recorder that failed says so when the run ends.
        if stream.cycles.send(Streamed::Settle(settled)).is_ok() {
            let _ = told.recv();
        }
        Ok(())
    }
}

fn write_status(
    writing: &Mutex<Writing>,
    bag_path: &str,
    stamp_ns: u64,
    (experiment, stage, progress): (&str, &str, f64),
) -> Result<(), RunError> {
    let status = ExperimentStatus {
        header: Header::at(stamp_ns),
        experiment: experiment.to_owned(),
        stage: stage.to_owned(),
        progress,
        bag_path: bag_path.to_owned(),
        ..Default::default()
    };
    Ok(locked(writing).bag.write(topics::EXPERIMENT_STATUS.name, stamp_ns, &status)?)
}

/// The bag; what a thread that panicked left of it is whole.
fn locked(writing: &Mutex<Writing>) -> MutexGuard<'_, Writing> {
    writing.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Writes cycles as they come, until nobody sends any more.
fn record(writing: &Mutex<Writing>, cycles: &Receiver<Streamed>) -> Result<(), BagError> {
    let mut next = Instant::now() + FLUSH;
    loop {
        match cycles.recv_timeout(FLUSH) {
            Ok(Streamed::Settle(settled)) => {
                let bag = &mut locked(writing).bag;
                bag.flush()?;
                bag.sync()?;
                // Nobody waits any more where the run ended.
                let _ = settled.send(());
            }
            Ok(Streamed::Cycle(cycle)) => {
                let Writing { bag, topics } = &mut *locked(writing);
                topics.write(bag, &cycle)?;
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        }
        if Instant::now() >= next {
            next += FLUSH;
            locked(writing).bag.flush()?;
        }
    }
}

impl Recorder {
    /// Starts the bag with the seed, the version and the options of the run. In `real_time` cycles
    /// are written while they come.
    pub fn create(dir: &Path, options: &RunOptions, real_time: bool) -> Result<Self, RunError> {
        let mut bag = BagWriter::create(dir, BagOptions::default())?;
        let topics = CycleTopics::open(&mut bag)?;
        let about = BTreeMap::from([
            ("program".to_owned(), format!("frictionlab {}", env!("CARGO_PKG_VERSION"))),
            ("experiment".to_owned(), options.experiment.as_str().to_owned()),
            ("seed".to_owned(), options.seed.to_string()),
            ("rig".to_owned(), options.rig.to_string()),
            (
                "epoch".to_owned(),
                match options.rig {
                    RigChoice::Simulated => {
                        "2017-11-01T00:00:00Z, fixed for offline runs".to_owned()
                    }
                    _ => "the clock of this machine".to_owned(),
                },
            ),
            ("recorded".to_owned(), options.record.describe().to_owned()),
        ]);
        bag.metadata("frictionlab", about)?;
        let text = serde_json::to_string_pretty(options)
            .map_err(|e| RunError::Describe { what: "JSON", detail: e.to_string() })?;
        bag.attach("options.json", "application/json", text.as_bytes())?;
        let writing = Arc::new(Mutex::new(Writing { bag, topics }));
        let stream = if real_time { Some(Self::streaming(&writing, dir)?) } else { None };
        Ok(Self { writing, bag_path: dir.display().to_string(), stream })
    }

    fn streaming(
        writing: &Arc<Mutex<Writing>>,
        dir: &Path,
    ) -> Result<(Stream, JoinHandle<Result<(), BagError>>), RunError> {
        let (cycles, receiver) = mpsc::sync_channel(WAITING);
        let writing = Arc::clone(writing);
        let thread = thread::Builder::new()
            .name("recorder".into())
            .spawn(move || record(&writing, &receiver))
            .map_err(|source| BagError::Write { path: dir.into(), source })?;
        Ok((Stream { cycles, lost: Arc::default() }, thread))
    }

    /// Where cycles of runs in real time go.
    pub fn stream(&self) -> Option<Stream> {
        self.stream.as_ref().map(|(stream, _)| stream.clone())
    }

    /// Writes the cycles that were kept.
    pub fn write(&mut self, kept: Kept) -> Result<(), RunError> {
        if let Some(error) = kept.error {
            return Err(error.into());
        }
        let Writing { bag, topics } = &mut *locked(&self.writing);
        for cycle in &kept.cycles {
            topics.write(bag, cycle)?;
        }
        Ok(())
    }

    /// Says on `/experiment_status` what begins.
    pub fn status(
        &mut self,
        stamp_ns: u64,
        experiment: &str,
        stage: &str,
        progress: f64,
    ) -> Result<(), RunError> {
        write_status(&self.writing, &self.bag_path, stamp_ns, (experiment, stage, progress))
    }

    /// What marks repetitions. It must be dropped before the bag is [finished](Self::finish).
    pub fn marks(&self) -> Marks {
        Marks { writing: Arc::clone(&self.writing), bag_path: self.bag_path.clone() }
    }

    /// Keeps a file with the bag.
    pub fn attach(&mut self, name: &str, media_type: &str, text: &str) -> Result<(), RunError> {
        Ok(locked(&self.writing).bag.attach(name, media_type, text.as_bytes())?)
    }

    /// Hands everything to the system.
    pub fn flush(&mut self) -> Result<(), RunError> {
        Ok(locked(&self.writing).bag.flush()?)
    }

    /// Waits until every cycle of a stream is in the bag; how many were left out because the disk
    /// did not keep up. Whoever holds the [`stream`](Self::stream) must have dropped it.
    pub fn drain(&mut self) -> Result<u64, RunError> {
        let Some((stream, thread)) = self.stream.take() else { return Ok(0) };
        let lost = stream.lost.load(Ordering::Relaxed);
        drop(stream);
        match thread.join() {
            Ok(written) => written?,
            // It panicked; what was written until then is there.
            Err(_) => return Ok(lost.max(1)),
        }
        Ok(lost)
    }

    /// Closes the bag.
    pub fn finish(mut self) -> Result<BagSummary, RunError> {
        self.drain()?;
        let Some(writing) = Arc::into_inner(self.writing) else {
            return Err(RunError::Describe {
                what: "a bag",
                detail: "somebody still writes it".to_owned(),
            });
        };
        Ok(writing.into_inner().unwrap_or_else(PoisonError::into_inner).bag.finish()?)
    }
}
