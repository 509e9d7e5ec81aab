//! The managed node that says friction torques; as an executable it hears joint states.

use std::{
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use msgs::{
    diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue},
    std_msgs::Header,
    std_srvs::{Trigger, TriggerResponse},
    topics,
};
use ros_node::{
    Gate, Participant, Passes, Publisher, RosNode, RosNodeError, SUBSCRIBERS_THAT_LAG, Stop,
    deadlines::{now_ns, request_realtime},
    lifecycle::{CallbackError, Lifecycle, Managed, Requested},
    parameters::{ParameterError, Parameters},
    queue::{Receiver, Sender, Waker, queue},
    stamps::{Follows, Forwards},
};

use super::{
    ObserverNode,
    step::{self, Estimated, Estimation, Inputs, Joint, Order},
};
use crate::{
    FrictionEstimator,
    parameters::{ObserverSettings, declarations},
};

/// Messages that wait for the thread, and estimates that wait for the publisher.
const WAITING: usize = 256;
/// Time between two diagnostics.
const DIAGNOSTICS: Duration = Duration::from_secs(1);
/// Said when orders come faster than cycles.
const BUSY: &str = "too many requests at once; try again";
/// Silence of the one that is listened to after which another may follow it.
const SILENCE: Duration = Duration::from_millis(500);
/// Name of the joint that is looked for.
const JOINT: &str = "load_shaft";

/// Runs the node until `stop`.
///
/// # Errors
/// [`RosNodeError`] if it cannot start; everything later is told in the log.
pub fn run(participant: &Participant, stop: &Stop) -> Result<(), RosNodeError> {
    let (mut observer, Inner { estimation, out }) = FrictionObserver::new(participant)?;
    let waker = Waker::default();
    let inputs = listen(&observer.node, &waker, &observer.counts, &observer.gates)?;
    let logger = observer.node.logger().clone();
    // The thread ends with the node's subscriptions, which hold the other ends of its queues.
    thread::Builder::new()
        .name("observer".into())
        .spawn(move || {
            waker.is_this_thread();
            logger.info(&request_realtime());
            step::estimate(estimation, inputs, out);
        })
        .map_err(RosNodeError::Runtime)?;
    observer.start();
    while !stop.wait(observer.next.saturating_duration_since(Instant::now())) {
        observer.tend();
    }
    observer.node.logger().info("leaving");
    observer.leave();
    Ok(())
}

/// What estimates, apart from the node: it belongs to one thread, which calls it once a cycle and
/// sends on what it says.
pub struct Inner {
    /// The estimator.
    pub estimation: Estimation,
    /// The way to the publisher. With its end the publisher ends.
    pub out: Sender<Estimated>,
}

/// The managed node `/friction_observer` with its parameters, services and publisher.
pub struct FrictionObserver {
    node: RosNode,
    lifecycle: Lifecycle,
    autostart: bool,
    gates: Gates,
    counts: Arc<Counts>,
    lost: Arc<AtomicU64>,
    publisher: JoinHandle<()>,
    diagnostics: Publisher<DiagnosticArray>,
    next: Instant,
}

impl FrictionObserver {
    /// Joins the participant, unconfigured and without any joint states: whoever holds the other
    /// part decides where they come from.
    ///
    /// # Errors
    /// [`RosNodeError`] if the middleware refuses, or a parameter that was given cannot be.
    pub fn new(participant: &Participant) -> Result<(Self, Inner), RosNodeError> {
        let node = participant.node("friction_observer")?;
        let cannot_be =
            |reason: String| RosNodeError::Parameters { node: node.identity().qualified(), reason };
        let (orders, for_orders) = queue(WAITING, &Waker::default());
        let orders = Arc::new(Mutex::new(orders));
        let first = Arc::new(Mutex::new(None));
        let (judged, to_thread) = (Arc::clone(&first), Arc::clone(&orders));
        let parameters =
            Parameters::declare(&node, declarations(&node.given_names()), move |values, _| {
                let settings = ObserverSettings::read(values)?;
                *locked(&judged) = Some(settings);
                if locked(&to_thread).send(Order::Settings(settings)) {
                    Ok(())
                } else {
                    Err(ParameterError::refused(BUSY))
                }
            })?;
        let settings = locked(&first).ok_or_else(|| cannot_be("they were not read".to_owned()))?;
        let estimator = FrictionEstimator::new(&settings.model, settings.options, settings.dt)
            .map_err(|error| cannot_be(error.to_string()))?;
        let counts = Arc::new(Counts::default());
        let published = Waker::default();
        let (out, for_publisher) = queue(WAITING, &published);
        let lost = out.dropped();
        let publishers = ObserverNode::on(&node)?;
        let counted = Arc::clone(&counts);
        let publisher = thread::Builder::new()
            .name("publisher".into())
            .spawn(move || {
                published.is_this_thread();
                publish(&publishers, for_publisher, &counted);
            })
            .map_err(RosNodeError::Runtime)?;
        let gates = Gates::new(&node)?;
        let managed = Observing { orders: Arc::clone(&orders), gates: gates.clone() };
        let lifecycle = Lifecycle::start(&node, Box::new(managed))?;
        node.serve::<Trigger>("~/reset", move |_| {
            let success = locked(&orders).send(Order::Reset);
            let message = if success { "the estimator is at rest" } else { BUSY };
            TriggerResponse { success, message: message.to_owned() }
        })?;
        let this = Self {
            autostart: lifecycle.starts_itself(parameters.values().boolean("autostart")),
            lifecycle,
            gates,
            counts,
            lost,
            publisher,
            diagnostics: node.publisher(&topics::DIAGNOSTICS)?,
            next: Instant::now() + DIAGNOSTICS,
            node,
        };
        Ok((this, Inner { estimation: Estimation::new(settings, estimator, for_orders), out }))
    }

    /// Configures and activates the node, if its parameter `autostart` says so. The log says why it
    /// is not active, if it is not.
    pub fn start(&self) {
        if self.autostart && self.lifecycle.request(Requested::Configure).is_ok() {
            let _ = self.lifecycle.request(Requested::Activate);
        }
    }

    /// Publishes diagnostics once a second.
    pub fn tend(&mut self) {
        if Instant::now() < self.next {
            return;
        }
        self.next += DIAGNOSTICS;
        let counts = &self.counts;
        let values = [
            ("estimates", counts.published.swap(0, Ordering::Relaxed)),
            ("joint states without numbers", counts.unusable.load(Ordering::Relaxed)),
            ("not published", self.not_published()),
            (
                "joint states with a stamp from the past or the future",
                counts.untimely.load(Ordering::Relaxed),
            ),
        ];
        let healthy = values[1..].iter().all(|(_, count)| *count == 0);
        let label = self.lifecycle.phase().label();
        let listening = counts.listening.load(Ordering::Relaxed);
        let reports: Vec<_> =
            self.gates.all().into_iter().filter(|_| listening).map(Gate::report).collect();
        let stranger =
            self.node.twin().or_else(|| reports.iter().find_map(|report| report.error.clone()));
        let (level, message) = match stranger {
            Some(stranger) => (DiagnosticStatus::ERROR, stranger),
            None if healthy => (DiagnosticStatus::OK, label.to_owned()),
            None => (DiagnosticStatus::WARN, label.to_owned()),
        };
        // The next one comes in a second.
        let _ = self.diagnostics.publish(DiagnosticArray {
            header: Header::at(self.node.clock().now_ns()),
            status: vec![DiagnosticStatus {
                level,
                name: self.node.identity().qualified().trim_start_matches('/').to_owned(),
                message,
                hardware_id: String::new(),
                values: std::iter::once(("node", label.to_owned()))
                    .chain(values.map(|(key, value)| (key, value.to_string())))
                    .chain([(SUBSCRIBERS_THAT_LAG, self.node.lagging_readers().to_string())])
                    .map(|(key, value)| KeyValue { key: key.to_owned(), value })
                    .chain(reports.into_iter().flat_map(|report| report.values))
                    .collect(),
            }],
        });
    }

    /// Estimates that were not published: the queue was full, or the middleware refused.
    #[must_use]
    pub fn not_published(&self) -> u64 {
        self.counts.refused.load(Ordering::Relaxed) + self.lost.load(Ordering::Relaxed)
    }

    /// Takes the node off the graph, and waits for the publisher, which ends with the other part.
    pub fn leave(self) {
        let Self { node, publisher, diagnostics, lifecycle, .. } = self;
        drop((diagnostics, lifecycle, node));
        let _ = publisher.join();
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[derive(Debug, Default)]
struct Counts {
    published: AtomicU64,
    refused: AtomicU64,
    unusable: AtomicU64,
    /// Joint states with a stamp that cannot follow the one before.
    untimely: AtomicU64,
    /// Messages come over the network.
    listening: AtomicBool,
}

/// Who is listened to: one writer on each topic.
#[derive(Clone)]
struct Gates {
    joints: Gate,
    voltages: Gate,
    references: Gate,
}

impl Gates {
    fn new(node: &RosNode) -> Result<Self, RosNodeError> {
        let gate = |topic: &str| Gate::new(node, topic, Some(SILENCE));
        Ok(Self {
            joints: gate(topics::JOINT_STATES.name_in_namespace())?,
            voltages: gate(topics::MOTOR_VOLTAGE.name_in_namespace())?,
            references: gate(topics::REFERENCE.name_in_namespace())?,
        })
    }

    const fn all(&self) -> [&Gate; 3] {
        [&self.joints, &self.voltages, &self.references]
    }
}

/// Subscribes to what the thread is told.
fn listen(
    node: &RosNode,
    waker: &Waker,
    counts: &Arc<Counts>,
    gates: &Gates,
) -> Result<Inputs, RosNodeError> {
    counts.listening.store(true, Ordering::Relaxed);
    let (mut joints, for_joints) = queue(WAITING, waker);
    let (mut voltages, for_voltages) = queue(WAITING, &Waker::default());
    let (mut references, for_references) = queue(WAITING, &Waker::default());
    let counts = Arc::clone(counts);
    let logger = node.logger().clone();
    let (gate, mut forwards) = (gates.joints.clone(), Forwards::default());
    node.subscribe_from(&topics::JOINT_STATES, move |message, sent| {
        // Without any names the first joint is meant.
        let index = message.name.iter().position(|name| name == JOINT).or(message.name.is_empty().then_some(0));
        let of_joint = |values: &[f64]| index.and_then(|index| values.get(index).copied());
        let (Some(position), Some(velocity)) = (of_joint(&message.position), of_joint(&message.velocity)) else {
            if counts.unusable.fetch_add(1, Ordering::Relaxed) == 0 {
                logger.warn(&format!("a joint state has no position or no velocity of {JOINT}; such are left out and counted in /diagnostics"));
            }
            return;
        };
        match gate.hear(sent.writer) {
            Passes::Yes { first: true } => forwards.reset(),
            Passes::Yes { first: false } => {}
            Passes::No => return,
        }
        let stamp_ns = message.header.stamp.to_nanos();
        if forwards.take(stamp_ns, now_ns()) != Follows::Fits {
            if counts.untimely.fetch_add(1, Ordering::Relaxed) == 0 {
                logger.warn("a joint state has a stamp from the past or the future; such are left out and counted in /diagnostics");
            }
            return;
        }
        let effort = of_joint(&message.effort);
        joints.send(Joint { stamp_ns, position, velocity, effort });
    })?;
    let gate = gates.voltages.clone();
    node.subscribe_from(&topics::MOTOR_VOLTAGE, move |message, sent| {
        if message.voltage.is_finite() && gate.hear(sent.writer) != Passes::No {
            voltages.send(message.voltage);
        }
    })?;
    let gate = gates.references.clone();
    node.subscribe_from(&topics::REFERENCE, move |message, sent| {
        let is_finite = message.position.is_finite() && message.velocity.is_finite();
        if is_finite && gate.hear(sent.writer) != Passes::No {
            references.send((message.position, message.velocity));
        }
    })?;
    Ok(Inputs { joints: for_joints, voltages: for_voltages, references: for_references })
}

/// Publishes estimates until the queue's other end is gone.
fn publish(publishers: &ObserverNode, mut queue: Receiver<Estimated>, counts: &Counts) {
    loop {
        match queue.take() {
            Some(Estimated { stamp_ns, estimate }) => {
                let count = match publishers.publish(stamp_ns, &estimate) {
                    Ok(()) => &counts.published,
                    Err(_) => &counts.refused,
                };
                count.fetch_add(1, Ordering::Relaxed);
            }
            None if queue.is_over() => return,
            None => Waker::sleep(Duration::from_millis(50)),
        }
    }
}

/// What the managed node does on its way: estimates come in active only.
struct Observing {
    orders: Arc<Mutex<Sender<Order>>>,
    gates: Gates,
}

impl Observing {
    fn order(&self, runs: bool) -> Result<(), CallbackError> {
        if locked(&self.orders).send(Order::Run(runs)) {
            Ok(())
        } else {
            Err(CallbackError::Failure(BUSY.to_owned()))
        }
    }
}

impl Managed for Observing {
    fn activate(&mut self) -> Result<(), CallbackError> {
        self.order(true)?;
        self.gates.all().into_iter().for_each(Gate::open_contested);
        Ok(())
    }

    fn deactivate(&mut self) -> Result<(), CallbackError> {
        self.gates.all().into_iter().for_each(Gate::close);
        self.order(false)
    }

    fn shut_down(&mut self) -> Result<(), CallbackError> {
        self.deactivate()
    }
}
