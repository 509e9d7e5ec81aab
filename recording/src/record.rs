//! Records what the running nodes publish into a bag, for those who have no `ros2 bag record`.
//!
//! Subscriptions are best effort, as everywhere in the laboratory: what the network loses is not in
//! the bag.

use std::{
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
        mpsc::{self, RecvTimeoutError, SyncSender, TrySendError},
    },
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

use msgs::{Payload, topics, topics::Topic};
use ros_node::parameters::Parameters;
use ros_node::{Arguments, Discovery, Named, Participant, RosNode, RosNodeError, Stop};

use crate::bag::{BagError, BagOptions, BagSummary, BagWriter};

/// Messages that wait for the disk: eight seconds of six signals at 1 kHz.
const WAITING: usize = 50_000;
/// Time between two flushes: what a kill may cost.
const FLUSH: Duration = Duration::from_millis(500);
/// How often the wish to end is looked for.
const WATCH: Duration = Duration::from_millis(50);

/// What is recorded, and where.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordOptions {
    /// Folder of the bag, new or empty.
    pub dir: PathBuf,
    /// Namespace of the axis, with its slash; none for the root.
    pub namespace: Option<String>,
    /// Length \[s\]; none until it is stopped.
    pub duration: Option<f64>,
}

/// A recording that did not come about.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The network.
    #[error(transparent)]
    Ros(#[from] RosNodeError),
    /// The bag.
    #[error(transparent)]
    Bag(#[from] BagError),
}

impl RecordError {
    /// Whether whoever asked for it can mend it: another folder, another setting of ROS.
    #[must_use]
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Ros(error) => error.is_bad_input(),
            Self::Bag(error) => error.is_bad_input(),
        }
    }
}

/// What was recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct Recorded {
    /// The bag.
    pub bag: BagSummary,
    /// Messages that were heard and not written, because the disk was too slow.
    pub dropped: u64,
}

/// A message that waits: writes itself.
type Waiting = Box<dyn FnOnce(&mut BagWriter) -> Result<(), BagError> + Send>;

/// Records until `stop`, or until the length is over. `ready` is called once it listens.
///
/// # Errors
/// [`RecordError`]; what was written before stays readable.
pub fn record(
    options: &RecordOptions,
    stop: &Stop,
    ready: impl FnOnce(),
) -> Result<Recorded, RecordError> {
    let discovery = Discovery::from_environment()?;
    let arguments = Arguments { namespace: options.namespace.clone(), ..Arguments::default() }
        .or_enclave("/viewer");
    let participant = Participant::join_with(&discovery, arguments)?;
    let node = participant.node("recorder")?;
    // An enclave of viewers may not answer under this name.
    if participant.enclave().is_none() {
        Parameters::usual(&node)?;
    }
    let mut bag = BagWriter::create(&options.dir, BagOptions::default())?;
    let (to_disk, waiting) = mpsc::sync_channel(WAITING);
    let ear = Ear { node: &node, to_disk, dropped: Arc::default() };
    ear.listen(&mut bag, &topics::JOINT_STATES, |m| m.header.stamp.to_nanos())?;
    ear.listen(&mut bag, &topics::RIG_MEASUREMENT, |m| m.header.stamp.to_nanos())?;
    ear.listen(&mut bag, &topics::REFERENCE, |m| m.header.stamp.to_nanos())?;
    ear.listen(&mut bag, &topics::MOTOR_VOLTAGE, |m| m.header.stamp.to_nanos())?;
    ear.listen(&mut bag, &topics::FRICTION_ESTIMATE, |m| m.header.stamp.to_nanos())?;
    ear.listen(&mut bag, &topics::CONTROLLER_STATE, |m| m.header.stamp.to_nanos())?;
    // It says when it came; what it tells of began earlier.
    ear.listen(&mut bag, &topics::EXPERIMENT_STATUS, |_| 0)?;
    ear.listen(&mut bag, &topics::DIAGNOSTICS, |m| m.header.stamp.to_nanos())?;
    ready();
    let began = Instant::now();
    let over = || {
        stop.is_set()
            || options.duration.is_some_and(|length| began.elapsed().as_secs_f64() >= length)
    };
    let mut next = Instant::now() + FLUSH;
    while !over() {
        if Instant::now() >= next {
            next += FLUSH;
            bag.flush()?;
        }
        match waiting.recv_timeout(WATCH) {
            Ok(write) => write(&mut bag)?,
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    // The node leaves, nothing comes any more, and what waits is written.
    let dropped = Arc::clone(&ear.dropped);
    drop(ear);
    drop(node);
    for write in waiting.try_iter() {
        write(&mut bag)?;
    }
    Ok(Recorded { bag: bag.finish()?, dropped: dropped.load(Ordering::Relaxed) })
}

/// Hears topics and hands on what they say.
struct Ear<'a> {
    node: &'a RosNode,
    to_disk: SyncSender<Waiting>,
    dropped: Arc<AtomicU64>,
}

impl Ear<'_> {
    /// Listens to one topic. `stamp` gives a message's own time \[ns\]; zero means that it counts
    /// as made when it comes.
    fn listen<M>(
        &self,
        bag: &mut BagWriter,
        topic: &Topic<M>,
        stamp: impl Fn(&M) -> u64 + Send + 'static,
    ) -> Result<(), RecordError>
    where
        M: Payload,
    {
        let name = self.node.resolve(Named::Topic, topic.name_in_namespace())?;
        // In the bag even if nobody says anything on it.
        bag.topic::<M>(&name)?;
        let (to_disk, dropped) = (self.to_disk.clone(), Arc::clone(&self.dropped));
        self.node.subscribe(topic, move |message: M| {
            let stamp_ns = match stamp(&message) {
                0 => now_ns(),
                own => own,
            };
            let name = name.clone();
            let write: Waiting = Box::new(move |bag| bag.write(&name, stamp_ns, &message));
            if let Err(TrySendError::Full(_)) = to_disk.try_send(write) {
                dropped.fetch_add(1, Ordering::Relaxed);
            }
        })?;
        Ok(())
    }
}

/// Time since the Unix epoch \[ns\].
fn now_ns() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos() as u64)
}
