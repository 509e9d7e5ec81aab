//! The nodes of a live run beside the loop: who is on the network, and the thread that publishes
//! the reference.

use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use controller::Reference;
use controller::node::ManagedController;
use friction_observer::node::FrictionObserver;
use msgs::diagnostic_msgs::DiagnosticArray;
use msgs::{friction_msgs, topics};
use rig_driver::node::RigDriver;
use ros_node::parameters::Parameters;
use ros_node::queue::{Receiver, Sender, Waker, queue};
use ros_node::{Participant, Publisher, RosNode, RosNodeError};

use super::{LiveError, diagnostics, recording::Recorded};
use experiment_runner::errand::Errands;
use experiment_runner::server::node::ManagedRunner;

/// References that wait for the publisher.
const WAITING: usize = 256;
/// Time between two diagnostics.
const DIAGNOSTICS: Duration = Duration::from_secs(1);
/// Time for the last samples to be acknowledged before the writers go.
const LINGER: Duration = Duration::from_millis(200);

/// The node `/experiment_runner`: it says the reference, if it is its own, how the loop goes, and
/// takes requests.
pub(super) struct RunnerSide {
    diagnostics: Publisher<DiagnosticArray>,
    next: Instant,
    reference: Option<JoinHandle<(u64, Option<String>)>>,
    _requests: Option<ManagedRunner>,
    _node: RosNode,
}

/// The way of a waveform's references to their publisher, each with its stamp
/// [ns since the Unix epoch].
pub(super) type OwnReferences = Sender<(u64, Reference)>;

impl RunnerSide {
    /// Joins the participant. The end of the queue is for the references of a `waveform`.
    pub(super) fn new(
        participant: &Participant,
        waveform: bool,
        serve: Option<Errands>,
    ) -> Result<(Self, Option<OwnReferences>), LiveError> {
        let node = participant.node("experiment_runner")?;
        let (mut reference, mut sender) = (None, None);
        if waveform {
            let waker = Waker::default();
            let (to_publisher, for_publisher) = queue(WAITING, &waker);
            let publisher = node.publisher(&topics::REFERENCE)?;
            let publish = move || {
                waker.is_this_thread();
                publish(&publisher, for_publisher)
            };
            let spawned = thread::Builder::new().name("publisher".into()).spawn(publish);
            reference = Some(spawned.map_err(|source| LiveError::Thread { source })?);
            sender = Some(to_publisher);
        }
        if serve.is_none() {
            Parameters::usual(&node)?;
        }
        let side = Self {
            diagnostics: node.publisher(&topics::DIAGNOSTICS)?,
            next: Instant::now() + DIAGNOSTICS,
            reference,
            _requests: serve
                .map(|offers| ManagedRunner::new(&node, (thesis::BESIDE, offers)))
                .transpose()?,
            _node: node,
        };
        Ok((side, sender))
    }

    /// Publishes diagnostics once a second.
    fn tend(&mut self, recorded: &Recorded, overruns: u64, not_recorded: u64, not_published: u64) {
        if Instant::now() < self.next {
            return;
        }
        self.next += DIAGNOSTICS;
        let timing = recorded.last_second(overruns);
        let stamp_ns = self._node.clock().now_ns();
        // The next one comes in a second.
        let _ = self.diagnostics.publish(diagnostics::message(
            stamp_ns,
            &timing,
            not_recorded,
            not_published,
        ));
    }
}

/// All nodes of the process.
pub(super) struct Nodes {
    pub(super) rig: RigDriver,
    pub(super) observer: FrictionObserver,
    pub(super) controller: ManagedController,
    pub(super) runner: RunnerSide,
}

/// What came of publishing.
#[derive(Debug, Default)]
pub(super) struct Published {
    /// Measurements that were published.
    pub(super) cycles: u64,
    /// Messages of all topics that were not.
    pub(super) lost: u64,
    /// The first refusal of a reference.
    pub(super) first_failure: Option<String>,
}

impl Nodes {
    /// Looks after faults and diagnostics; some fifty times a second.
    pub(super) fn tend(&mut self, recorded: &Recorded, not_recorded: u64) {
        self.rig.tend();
        self.observer.tend();
        self.controller.tend();
        let not_published = self.not_published();
        self.runner.tend(recorded, self.rig.overruns(), not_recorded, not_published);
    }

    fn not_published(&self) -> u64 {
        self.rig.published().1 + self.observer.not_published() + self.controller.not_published()
    }

    /// The motor is at zero volts already: lets the last messages out, then takes the nodes off the
    /// graph.
    pub(super) fn leave(self) -> Result<Published, LiveError> {
        thread::sleep(LINGER);
        let (cycles, lost) = (self.rig.published().0, self.not_published());
        let Self { rig, observer, controller, mut runner } = self;
        // With the rig go observer and controller, which the control thread had, and with them the
        // publishers' queues.
        drop(rig);
        observer.leave();
        controller.leave();
        let told = runner.reference.take().map(JoinHandle::join).transpose();
        let (refused, first_failure) =
            told.map_err(|_| LiveError::Panicked { thread: "publisher" })?.unwrap_or_default();
        Ok(Published { cycles, lost: lost + refused, first_failure })
    }
}

/// Publishes references until the queue's other end is gone. Returns how many were refused, and why
/// the first.
fn publish(
    publisher: &Publisher<friction_msgs::Reference>,
    mut queue: Receiver<(u64, Reference)>,
) -> (u64, Option<String>) {
    let (mut refused, mut first) = (0, None);
    loop {
        match queue.take() {
            Some((stamp_ns, reference)) => {
                let sent: Result<(), RosNodeError> =
                    publisher.publish(controller::messages::reference(stamp_ns, &reference));
                if let Err(error) = sent {
                    refused += 1;
                    first.get_or_insert_with(|| error.to_string());
                }
            }
            None if queue.is_over() => return (refused, first),
            None => Waker::sleep(Duration::from_millis(50)),
        }
    }
}
