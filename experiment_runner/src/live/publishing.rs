//! The thread that publishes.

use std::{
    path::Path,
    sync::atomic::Ordering,
    thread,
    time::{Duration, SystemTime},
};

use controller::node::ControllerNode;
use friction_observer::node::ObserverNode;
use msgs::{diagnostic_msgs::DiagnosticArray, topics};
use rig_driver::node::RigNode;
use ros_node::{Participant, Publisher, RosNode, RosNodeError, timing::Stopwatch};
use rtrb::Consumer;

use super::{Counters, LiveCycle, diagnostics, epoch_ns};
use crate::server::node::Runner;

/// Pause when there is nothing to publish: short against the period, long against the work.
const PAUSE: Duration = Duration::from_micros(500);
/// Time between two diagnostics.
const DIAGNOSTICS: Duration = Duration::from_secs(1);
/// Time for the last samples to be acknowledged before the writers go.
const LINGER: Duration = Duration::from_millis(200);

/// All nodes of the process. The fields are dropped in this order: publishers, then nodes, then the participant.
pub(super) struct Nodes {
    rig: RigNode,
    observer: ObserverNode,
    controller: ControllerNode,
    diagnostics: Publisher<DiagnosticArray>,
    _requests: Option<Runner>,
    _runner: RosNode,
    _participant: Participant,
}

impl Nodes {
    pub(super) fn new(participant: Participant, serve: Option<&Path>) -> Result<Self, RosNodeError> {
        let runner = participant.node("experiment_runner")?;
        Ok(Self {
            rig: RigNode::new(&participant)?,
            observer: ObserverNode::new(&participant)?,
            controller: ControllerNode::new(&participant)?,
            diagnostics: runner.publisher(&topics::DIAGNOSTICS)?,
            _requests: serve.map(|runs| Runner::new(&runner, runs.to_owned())).transpose()?,
            _runner: runner,
            _participant: participant,
        })
    }

    fn publish(&self, cycle: &LiveCycle) -> Result<(), RosNodeError> {
        let sample = &cycle.sample;
        self.rig.publish(sample.stamp_ns, &sample.measurement)?;
        self.observer.publish(sample.stamp_ns, &sample.estimate)?;
        self.controller.publish(sample.stamp_ns, &sample.reference, &sample.command)
    }
}

/// What the thread leaves behind.
#[derive(Debug, Default)]
pub(super) struct Published {
    /// Cycles of which every message was taken.
    pub(super) cycles: u64,
    /// Cycles of which a message was refused.
    pub(super) failed: u64,
    /// The first refusal.
    pub(super) first_failure: Option<String>,
}

impl Published {
    fn note(&mut self, result: Result<(), RosNodeError>) {
        match result {
            Ok(()) => self.cycles += 1,
            Err(error) => {
                self.failed += 1;
                self.first_failure.get_or_insert_with(|| error.to_string());
            }
        }
    }
}

/// Publishes cycles until the queue's other end is gone and it is empty.
pub(super) fn publish(nodes: Nodes, mut queue: Consumer<LiveCycle>, counters: &Counters) -> Published {
    let mut published = Published::default();
    let mut stopwatch = Stopwatch::new();
    let mut next = std::time::Instant::now() + DIAGNOSTICS;
    loop {
        match queue.pop() {
            Ok(cycle) => {
                stopwatch.note(cycle.period_ns, cycle.execution_ns);
                published.note(nodes.publish(&cycle));
            }
            // Looked at in this order, nothing can slip in between.
            Err(_) if queue.is_abandoned() && queue.is_empty() => break,
            Err(_) => thread::sleep(PAUSE),
        }
        if std::time::Instant::now() >= next {
            next += DIAGNOSTICS;
            let timing = stopwatch.timing(counters.overruns.load(Ordering::Relaxed));
            let message =
                diagnostics::message(epoch_ns(SystemTime::now()), &timing, counters, published.failed);
            if let Err(error) = nodes.diagnostics.publish(message) {
                published.first_failure.get_or_insert_with(|| error.to_string());
            }
            stopwatch.clear();
        }
    }
    thread::sleep(LINGER);
    published
}
