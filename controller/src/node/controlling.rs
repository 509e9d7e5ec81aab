//! The managed node that asks for voltages; as an executable it hears joint states and estimates.

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
    friction_msgs::{ControllerState, MotorVoltage},
    std_msgs::Header,
    std_srvs::{Trigger, TriggerResponse},
    topics,
};
use ros_node::{
    Gate, Logger, Participant, Passes, Publisher, RosNode, RosNodeError, SUBSCRIBERS_THAT_LAG,
    Stop,
    deadlines::{now_ns, request_realtime},
    lifecycle::{CallbackError, Lifecycle, Managed, Requested},
    parameters::{ParameterError, Parameters},
    queue::{Receiver, Sender, Waker, queue},
    stamps::{Follows, Forwards},
};

use super::{
    declarations,
    friction::Friction,
    parameters::ControlSettings,
    plausible,
    step::{self, Control, Decided, Inputs, Joint, Order},
};
use crate::{Controller, Reference, messages};

/// Messages that wait for the thread, and commands that wait for the publisher.
const WAITING: usize = 256;
/// Time between two diagnostics.
const DIAGNOSTICS: Duration = Duration::from_secs(1);
/// Said when orders come faster than cycles.
const BUSY: &str = "too many requests at once; try again";
/// Silence of the one that is listened to after which another may follow it: by then the loop
/// begins anew.
const SILENCE: Duration = Duration::from_millis(500);
/// Name of the joint that is looked for.
const JOINT: &str = "load_shaft";

/// Runs the node until `stop`.
///
/// # Errors
/// [`RosNodeError`] if it cannot start; everything later is told in the log.
pub fn run(participant: &Participant, stop: &Stop) -> Result<(), RosNodeError> {
    let (mut node, Inner { control, out, references }) = ManagedController::new(participant)?;
    node.follow(references)?;
    let waker = Waker::default();
    let inputs = listen(&node.node, &waker, &node.counts, &node.gates)?;
    let logger = node.node.logger().clone();
    // The thread ends with the node's subscriptions, which hold the other ends of its queues.
    thread::Builder::new()
        .name("controller".into())
        .spawn(move || {
            waker.is_this_thread();
            logger.info(&request_realtime());
            step::control(control, inputs, out);
        })
        .map_err(RosNodeError::Runtime)?;
    node.start();
    while !stop.wait(node.next.saturating_duration_since(Instant::now())) {
        node.tend();
    }
    node.node.logger().info("leaving");
    node.leave();
    Ok(())
}

/// What controls, apart from the node: it belongs to one thread, which calls it once a cycle and
/// sends on what it says.
pub struct Inner {
    /// The controller.
    pub control: Control,
    /// The way to the publisher. With its end the publisher ends.
    pub out: Sender<Decided>,
    /// The way of references to the controller: [`follow`](ManagedController::follow) takes it
    /// where they come over `/reference`.
    pub references: Sender<(Reference, Instant)>,
}

/// The managed node `/controller` with its parameters, services and publisher.
pub struct ManagedController {
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

impl ManagedController {
    /// Joins the participant, unconfigured and without any joint states: whoever holds the other
    /// part decides where they come from.
    ///
    /// # Errors
    /// [`RosNodeError`] if the middleware refuses, or a parameter that was given cannot be.
    pub fn new(participant: &Participant) -> Result<(Self, Inner), RosNodeError> {
        let node = participant.node("controller")?;
        let cannot_be =
            |reason: String| RosNodeError::Parameters { node: node.identity().qualified(), reason };
        let (orders, for_orders) = queue(WAITING, &Waker::default());
        let orders = Arc::new(Mutex::new(orders));
        let first = Arc::new(Mutex::new(None));
        let gates = Gates::new(&node)?;
        let references_gate = gates.references.clone();
        let (judged, to_thread) = (Arc::clone(&first), Arc::clone(&orders));
        let parameters =
            Parameters::declare(&node, declarations(&node.given_names()), move |values, _| {
                let settings = ControlSettings::read(values)?;
                *locked(&judged) = Some(settings);
                references_gate
                    .hand_over_after(Duration::from_secs_f64(settings.reference_timeout));
                if locked(&to_thread).send(Order::Settings(settings)) {
                    Ok(())
                } else {
                    Err(ParameterError::refused(BUSY))
                }
            })?;
        let settings = locked(&first).ok_or_else(|| cannot_be("they were not read".to_owned()))?;
        let controller =
            Controller::new(settings.options).map_err(|error| cannot_be(error.to_string()))?;
        let counts = Arc::new(Counts::default());
        let published = Waker::default();
        let (out, for_publisher) = queue(WAITING, &published);
        let (references, for_references) = queue(WAITING, &Waker::default());
        let lost = out.dropped();
        let publishers =
            (node.publisher(&topics::MOTOR_VOLTAGE)?, node.publisher(&topics::CONTROLLER_STATE)?);
        let (counted, logger) = (Arc::clone(&counts), node.logger().clone());
        let publisher = thread::Builder::new()
            .name("publisher".into())
            .spawn(move || {
                published.is_this_thread();
                publish(&publishers, for_publisher, &counted, &logger);
            })
            .map_err(RosNodeError::Runtime)?;
        let managed = Controlling { orders: Arc::clone(&orders), gates: gates.clone() };
        let lifecycle = Lifecycle::start(&node, Box::new(managed))?;
        node.serve::<Trigger>("~/reset", move |_| {
            let success = locked(&orders).send(Order::Reset);
            let message = if success { "the controller is at rest" } else { BUSY };
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
        let control = Control::new(settings, controller, for_orders, for_references);
        Ok((this, Inner { control, out, references }))
    }

    /// Takes references from `/reference`: of one writer, until it is silent for
    /// `reference_timeout` or has left.
    ///
    /// # Errors
    /// [`RosNodeError`] if the middleware refuses.
    pub fn follow(&self, mut references: Sender<(Reference, Instant)>) -> Result<(), RosNodeError> {
        let complain = self.counts.complainer(&self.node);
        let gate = self.counts.watched(&self.gates.references);
        gate.open_contested();
        self.node.subscribe_from(&topics::REFERENCE, move |message, sent| {
            let reference = Reference {
                position: message.position,
                velocity: message.velocity,
                acceleration: message.acceleration,
            };
            if !plausible::is_reference(&reference) {
                complain("a reference is no number, or beyond what a shaft does");
            } else if gate.hear(sent.writer) != Passes::No {
                references.send((reference, Instant::now()));
            }
        })
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
        let label = self.lifecycle.phase().label();
        let message = self.counts.message(&self.node, label, self.not_published());
        // The next one comes in a second.
        let _ = self.diagnostics.publish(message);
    }

    /// Commands that were not published: the queue was full, or the middleware refused.
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

#[derive(Default)]
struct Counts {
    published: AtomicU64,
    refused: AtomicU64,
    unusable: AtomicU64,
    /// Commands for which the estimate came too late.
    without_estimate: AtomicU64,
    /// Joint states with a stamp that cannot follow the one before.
    untimely: AtomicU64,
    /// Estimates that answer no joint state.
    strange: Arc<AtomicU64>,
    faulty: AtomicBool,
    stale: AtomicBool,
    /// Those that let messages in.
    gates: Mutex<Vec<Gate>>,
}

/// Who is listened to: one writer on each topic.
#[derive(Clone)]
struct Gates {
    joints: Gate,
    frictions: Gate,
    references: Gate,
}

impl Gates {
    fn new(node: &RosNode) -> Result<Self, RosNodeError> {
        let gate = |topic: &str| Gate::new(node, topic, Some(SILENCE));
        Ok(Self {
            joints: gate(topics::JOINT_STATES.name_in_namespace())?,
            frictions: gate(topics::FRICTION_ESTIMATE.name_in_namespace())?,
            references: gate(topics::REFERENCE.name_in_namespace())?,
        })
    }
}

impl Counts {
    /// Counts a message that cannot be used; the first one is told.
    fn complainer(self: &Arc<Self>, node: &RosNode) -> impl Fn(&str) + Send + 'static {
        let (counts, logger) = (Arc::clone(self), node.logger().clone());
        move |what| {
            if counts.unusable.fetch_add(1, Ordering::Relaxed) == 0 {
                logger.warn(&format!("{what}; such are left out and counted in /diagnostics"));
            }
        }
    }

    /// A gate of which `/diagnostics` tells from now on.
    fn watched(&self, gate: &Gate) -> Gate {
        locked(&self.gates).push(gate.clone());
        gate.clone()
    }

    fn message(&self, node: &RosNode, phase: &str, lost: u64) -> DiagnosticArray {
        let unusable = self.unusable.load(Ordering::Relaxed);
        let untimely = self.untimely.load(Ordering::Relaxed);
        let reports: Vec<_> = locked(&self.gates).iter().map(Gate::report).collect();
        let stranger =
            node.twin().or_else(|| reports.iter().find_map(|report| report.error.clone()));
        let (level, message) = if let Some(stranger) = stranger {
            (DiagnosticStatus::ERROR, stranger)
        } else if self.faulty.load(Ordering::Relaxed) {
            (
                DiagnosticStatus::ERROR,
                "zero volts: the joint states are no numbers; mend them, then call ~/reset"
                    .to_owned(),
            )
        } else if self.stale.load(Ordering::Relaxed) {
            (DiagnosticStatus::WARN, format!("{phase}; no reference comes"))
        } else if unusable + untimely + lost > 0 {
            (DiagnosticStatus::WARN, format!("{phase}; messages were left out"))
        } else {
            (DiagnosticStatus::OK, phase.to_owned())
        };
        let values = [
            ("commands", self.published.swap(0, Ordering::Relaxed)),
            ("commands with an older estimate", self.without_estimate.swap(0, Ordering::Relaxed)),
            ("messages without numbers", unusable),
            ("joint states with a stamp from the past or the future", untimely),
            ("estimates of no joint state", self.strange.load(Ordering::Relaxed)),
            ("not published", lost),
        ];
        DiagnosticArray {
            header: Header::at(node.clock().now_ns()),
            status: vec![DiagnosticStatus {
                level,
                name: node.identity().qualified().trim_start_matches('/').to_owned(),
                message,
                hardware_id: String::new(),
                values: std::iter::once(("node", phase.to_owned()))
                    .chain(values.map(|(key, value)| (key, value.to_string())))
                    .chain([(SUBSCRIBERS_THAT_LAG, node.lagging_readers().to_string())])
                    .map(|(key, value)| KeyValue { key: key.to_owned(), value })
                    .chain(reports.into_iter().flat_map(|report| report.values))
                    .collect(),
            }],
        }
    }
}

/// Subscribes to what the thread is told.
fn listen(
    node: &RosNode,
    waker: &Waker,
    counts: &Arc<Counts>,
    gates: &Gates,
) -> Result<Inputs, RosNodeError> {
    let (mut joints, for_joints) = queue(WAITING, waker);
    let (mut frictions, for_frictions) = queue(WAITING, waker);
    let unusable = counts.complainer(node);
    let gate = counts.watched(&gates.joints);
    let (mut forwards, counted, logger) =
        (Forwards::default(), Arc::clone(counts), node.logger().clone());
    node.subscribe_from(&topics::JOINT_STATES, move |message, sent| {
        let index = plausible::index_of(JOINT, &message.name);
        let of_joint = |values: &[f64]| index.and_then(|index| values.get(index).copied());
        let (Some(position), Some(velocity)) = (of_joint(&message.position), of_joint(&message.velocity))
        else {
            unusable(&format!("a joint state has no position or no velocity of {JOINT}"));
            return;
        };
        if plausible::is_beyond(position, velocity) {
            unusable("a joint state is beyond what a shaft does");
            return;
        }
        // Of another joint, or of no shaft: such a publisher is none of ours. Of the others one
        // counts.
        match gate.hear(sent.writer) {
            Passes::Yes { first: true } => forwards.reset(),
            Passes::Yes { first: false } => {}
            Passes::No => return,
        }
        let stamp_ns = message.header.stamp.to_nanos();
        if forwards.take(stamp_ns, now_ns()) != Follows::Fits {
            if counted.untimely.fetch_add(1, Ordering::Relaxed) == 0 {
                logger.warn("a joint state has a stamp from the past or the future; such are left out and counted in /diagnostics");
            }
            return;
        }
        // What is no number goes on: the controller counts it and stops after a few.
        joints.send(Joint { stamp_ns, position, velocity, cycle: None });
    })?;
    let unusable = counts.complainer(node);
    let gate = counts.watched(&gates.frictions);
    node.subscribe_from(&topics::FRICTION_ESTIMATE, move |message, sent| {
        if !message.torque.is_finite() {
            unusable("a friction estimate is no number");
        } else if gate.hear(sent.writer) != Passes::No {
            frictions.send(Friction {
                stamp_ns: message.header.stamp.to_nanos(),
                torque: message.torque,
            });
        }
    })?;
    Ok(Inputs {
        joints: for_joints,
        frictions: for_frictions,
        strange: Arc::clone(&counts.strange),
    })
}

/// Publishes commands until the queue's other end is gone.
fn publish(
    (voltages, states): &(Publisher<MotorVoltage>, Publisher<ControllerState>),
    mut queue: Receiver<Decided>,
    counts: &Counts,
    logger: &Logger,
) {
    loop {
        let Some(decided) = queue.take() else {
            if queue.is_over() {
                return;
            }
            Waker::sleep(Duration::from_millis(50));
            continue;
        };
        let Decided { stamp_ns, command, fault, stale_reference, fresh_estimate } = decided;
        let sent = voltages
            .publish(messages::motor_voltage(stamp_ns, &command))
            .and_then(|()| states.publish(messages::controller_state(stamp_ns, &command)));
        let count = if sent.is_ok() { &counts.published } else { &counts.refused };
        count.fetch_add(1, Ordering::Relaxed);
        if !fresh_estimate {
            counts.without_estimate.fetch_add(1, Ordering::Relaxed);
        }
        if counts.stale.swap(stale_reference, Ordering::Relaxed) != stale_reference {
            logger.info(if stale_reference {
                "no reference comes: zero velocity"
            } else {
                "a reference comes"
            });
        }
        if let Some(fault) = fault
            && !counts.faulty.swap(true, Ordering::Relaxed)
        {
            logger.error(&format!(
                "zero volts from now on: {fault}; mend the joint states, then call ~/reset"
            ));
        } else if fault.is_none() {
            counts.faulty.store(false, Ordering::Relaxed);
        }
    }
}

/// What the managed node does on its way: commands come in active only.
struct Controlling {
    orders: Arc<Mutex<Sender<Order>>>,
    gates: Gates,
}

impl Controlling {
    fn order(&self, runs: bool) -> Result<(), CallbackError> {
        if locked(&self.orders).send(Order::Run(runs)) {
            Ok(())
        } else {
            Err(CallbackError::Failure(BUSY.to_owned()))
        }
    }
}

impl Managed for Controlling {
    fn activate(&mut self) -> Result<(), CallbackError> {
        self.order(true)?;
        self.gates.joints.open_contested();
        self.gates.frictions.open_contested();
        Ok(())
    }

    fn deactivate(&mut self) -> Result<(), CallbackError> {
        self.gates.joints.close();
        self.gates.frictions.close();
        self.order(false)
    }

    fn shut_down(&mut self) -> Result<(), CallbackError> {
        self.deactivate()
    }
}
