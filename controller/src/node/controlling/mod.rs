//! The managed node that asks for voltages; as an executable it hears joint states and estimates.

mod counts;
mod listen;
mod publish;

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use msgs::diagnostic_msgs::DiagnosticArray;
use msgs::std_srvs::{Trigger, TriggerResponse};
use msgs::topics;
use ros_node::deadlines::request_realtime;
use ros_node::lifecycle::{CallbackError, Lifecycle, Managed, Requested};
use ros_node::parameters::{ParameterError, Parameters};
use ros_node::queue::{Sender, Waker, queue};
use ros_node::{Participant, Passes, Publisher, RosNode, RosNodeError, Stop};

use self::counts::{Counts, Gates};
use self::listen::listen;
use self::publish::publish;
use super::parameters::ControlSettings;
use super::step::{self, Control, Decided, Order};
use super::{declarations, plausible};
use crate::{Controller, Reference};

/// Messages that wait for the thread, and commands that wait for the publisher.
const WAITING: usize = 256;
/// Time between two diagnostics.
const DIAGNOSTICS: Duration = Duration::from_secs(1);
/// Said when orders come faster than cycles.
const BUSY: &str = "too many requests at once; try again";

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
