//! The thread that records, and what it sees of the loop's timing.

use std::{
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use ros_node::timing::{Stopwatch, Timing};
use rtrb::Consumer;

use super::{answering::LiveCycle, period_errors::PeriodErrors};
use experiment_runner::messages::{CycleTopics, EncodedCycle};
use recording::bag::{BagError, BagSummary, BagWriter};

/// Pause when there is nothing to write.
const PAUSE: Duration = Duration::from_millis(2);
/// Time between two flushes: what a kill may cost.
const FLUSH: Duration = Duration::from_millis(500);

/// The timing of the cycles that came to the recorder.
#[derive(Debug)]
pub(super) struct Recorded {
    /// Since the start, and since it was last asked for.
    watches: Mutex<[Stopwatch; 2]>,
}

impl Recorded {
    pub(super) fn new() -> Self {
        Self { watches: Mutex::new([Stopwatch::new(), Stopwatch::new()]) }
    }

    fn note(&self, cycle: &LiveCycle) {
        let mut watches = self.watches.lock().unwrap_or_else(PoisonError::into_inner);
        watches.iter_mut().for_each(|watch| watch.note(cycle.period_ns, cycle.execution_ns));
    }

    /// Since the start.
    pub(super) fn timing(&self, overruns: u64) -> Timing {
        self.watches.lock().unwrap_or_else(PoisonError::into_inner)[0].timing(overruns)
    }

    /// Since the last call.
    pub(super) fn last_second(&self, overruns: u64) -> Timing {
        let mut watches = self.watches.lock().unwrap_or_else(PoisonError::into_inner);
        let timing = watches[1].timing(overruns);
        watches[1].clear();
        timing
    }
}

/// Writes cycles until the queue's other end is gone and it is empty, then closes the bag. If the
/// disk refuses, it stops the run.
pub(super) fn record(
    mut bag: BagWriter,
    topics: CycleTopics,
    mut queue: Consumer<LiveCycle>,
    (recorded, errors): (&Recorded, Option<PeriodErrors>),
    stop: &AtomicBool,
) -> Result<(BagSummary, Option<PeriodErrors>), BagError> {
    let mut errors = errors;
    let result = drain(&mut bag, topics, &mut queue, recorded, &mut errors);
    if result.is_err() {
        stop.store(true, Ordering::Relaxed);
    }
    result?;
    Ok((bag.finish()?, errors))
}

fn drain(
    bag: &mut BagWriter,
    topics: CycleTopics,
    queue: &mut Consumer<LiveCycle>,
    recorded: &Recorded,
    errors: &mut Option<PeriodErrors>,
) -> Result<(), BagError> {
    let mut encoded = EncodedCycle::default();
    let mut next = Instant::now() + FLUSH;
    loop {
        match queue.pop() {
            Ok(cycle) => {
                recorded.note(&cycle);
                if let Some(errors) = errors {
                    errors.note(cycle.period_ns);
                }
                encoded.encode_spoken(&cycle.sample, cycle.effort, cycle.spoken)?;
                topics.write(bag, &encoded)?;
            }
            // Looked at in this order, nothing can slip in between.
            Err(_) if queue.is_abandoned() && queue.is_empty() => return Ok(()),
            Err(_) => thread::sleep(PAUSE),
        }
        if Instant::now() >= next {
            next += FLUSH;
            bag.flush()?;
        }
    }
}
