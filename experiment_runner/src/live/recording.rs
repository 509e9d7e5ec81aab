//! The thread that records.

use std::{
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::{Duration, Instant},
};

use rtrb::Consumer;

use super::LiveCycle;
use crate::{
    bag::{BagError, BagSummary, BagWriter},
    messages::{CycleTopics, EncodedCycle},
};

/// Pause when there is nothing to write.
const PAUSE: Duration = Duration::from_millis(2);
/// Time between two flushes: what a kill may cost.
const FLUSH: Duration = Duration::from_millis(500);

/// Writes cycles until the queue's other end is gone and it is empty, then closes the bag. If the disk refuses, it stops
/// the run.
pub(super) fn record(
    mut bag: BagWriter,
    topics: CycleTopics,
    mut queue: Consumer<LiveCycle>,
    stop: &AtomicBool,
) -> Result<BagSummary, BagError> {
    let result = drain(&mut bag, topics, &mut queue);
    if result.is_err() {
        stop.store(true, Ordering::Relaxed);
    }
    result?;
    bag.finish()
}

fn drain(bag: &mut BagWriter, topics: CycleTopics, queue: &mut Consumer<LiveCycle>) -> Result<(), BagError> {
    let mut encoded = EncodedCycle::default();
    let mut next = Instant::now() + FLUSH;
    loop {
        match queue.pop() {
            Ok(cycle) => {
                encoded.encode(&cycle.sample)?;
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
