//! The executable: a managed node that hears joint states and says friction torques.

use std::{
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use msgs::{
    diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue},
    std_msgs::Header,
    std_srvs::{Trigger, TriggerResponse},
    topics,
};
use ros_node::{
    Participant, RosNode, RosNodeError, Stop,
    deadlines::request_realtime,
    lifecycle::{CallbackError, Lifecycle, Managed, Requested},
    parameters::Parameters,
    queue::{Receiver, Sender, Waker, queue},
};

use super::{
    ObserverNode, declarations,
    parameters::ObserverSettings,
    step::{self, Estimated, Inputs, Joint, Order},
};
use crate::FrictionEstimator;

/// Messages that wait for the thread, and estimates that wait for the publisher.
const WAITING: usize = 256;
/// Time between two diagnostics.
const DIAGNOSTICS: Duration = Duration::from_secs(1);
/// Name of the joint that is looked for.
const JOINT: &str = "load_shaft";

/// Runs the node until `stop`.
///
/// # Errors
/// [`RosNodeError`] if it cannot start; everything later is told in the log.
pub fn run(participant: &Participant, stop: &Stop) -> Result<(), RosNodeError> {
    let node = participant.node("friction_observer")?;
    let waker = Waker::default();
    let (orders, for_orders) = queue(WAITING, &waker);
    let orders = Arc::new(Mutex::new(orders));
    let first = Arc::new(Mutex::new(None));
    let (judged, to_thread) = (Arc::clone(&first), Arc::clone(&orders));
    let parameters = Parameters::declare(&node, declarations(&node.given_names()), move |values, _| {
        let settings = ObserverSettings::read(values)?;
        *locked(&judged) = Some(settings);
        locked(&to_thread).send(Order::Settings(settings));
        Ok(())
    })?;
    let Some(settings) = *locked(&first) else { return Ok(()) };
    let estimator =
        FrictionEstimator::new(&settings.model, settings.options, settings.dt).map_err(|error| {
            RosNodeError::Parameters { node: node.identity().qualified(), reason: error.to_string() }
        })?;
    let counts = Arc::new(Counts::default());
    let inputs = listen(&node, &waker, for_orders, &counts)?;
    let published = Waker::default();
    let (out, for_publisher) = queue(WAITING, &published);
    let lost = out.dropped();
    let publishers = ObserverNode::on(&node)?;
    let spawn = |error: std::io::Error| RosNodeError::Runtime(error);
    let logger = node.logger().clone();
    // The thread ends with the node's subscriptions, which hold the other ends of its queues.
    thread::Builder::new()
        .name("observer".into())
        .spawn(move || {
            waker.is_this_thread();
            logger.info(&request_realtime());
            step::estimate(settings, estimator, inputs, out);
        })
        .map_err(spawn)?;
    let counted = Arc::clone(&counts);
    let publisher = thread::Builder::new()
        .name("publisher".into())
        .spawn(move || {
            published.is_this_thread();
            publish(&publishers, for_publisher, &counted);
        })
        .map_err(spawn)?;

    let lifecycle = Lifecycle::start(&node, Box::new(Observing { orders: Arc::clone(&orders) }))?;
    let reset = Arc::clone(&orders);
    node.serve::<Trigger>("~/reset", move |_| {
        let success = locked(&reset).send(Order::Reset);
        TriggerResponse {
            success,
            message: if success {
                "the estimator is at rest"
            } else {
                "too many requests at once; try again"
            }
            .to_owned(),
        }
    })?;
    let diagnostics = node.publisher(&topics::DIAGNOSTICS)?;
    if lifecycle.starts_itself(parameters.values().boolean("autostart"))
        && lifecycle.request(Requested::Configure).is_ok()
    {
        // The log says why it is not active, if it is not.
        let _ = lifecycle.request(Requested::Activate);
    }
    let mut next = Instant::now() + DIAGNOSTICS;
    while !stop.wait(next.saturating_duration_since(Instant::now())) {
        next += DIAGNOSTICS;
        let values = [
            ("estimates", counts.published.swap(0, Ordering::Relaxed)),
            ("joint states without numbers", counts.unusable.load(Ordering::Relaxed)),
            ("not published", counts.refused.load(Ordering::Relaxed) + lost.load(Ordering::Relaxed)),
        ];
        let healthy = values[1].1 + values[2].1 == 0;
        // The next one comes in a second.
        let _ = diagnostics.publish(DiagnosticArray {
            header: Header::at(node.clock().now_ns()),
            status: vec![DiagnosticStatus {
                level: if healthy { DiagnosticStatus::OK } else { DiagnosticStatus::WARN },
                name: node.identity().qualified().trim_start_matches('/').to_owned(),
                message: lifecycle.phase().label().to_owned(),
                hardware_id: String::new(),
                values: std::iter::once(("node", lifecycle.phase().label().to_owned()))
                    .chain(values.map(|(key, value)| (key, value.to_string())))
                    .map(|(key, value)| KeyValue { key: key.to_owned(), value })
                    .collect(),
            }],
        });
    }
    node.logger().info("leaving");
    drop(node);
    // It ends with the estimates.
    let _ = publisher.join();
    Ok(())
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[derive(Debug, Default)]
struct Counts {
    published: AtomicU64,
    refused: AtomicU64,
    unusable: AtomicU64,
}

/// Subscribes to what the thread is told.
fn listen(
    node: &RosNode,
    waker: &Waker,
    orders: Receiver<Order>,
    counts: &Arc<Counts>,
) -> Result<Inputs, RosNodeError> {
    let (mut joints, for_joints) = queue(WAITING, waker);
    let (mut voltages, for_voltages) = queue(WAITING, &Waker::default());
    let (mut references, for_references) = queue(WAITING, &Waker::default());
    let counts = Arc::clone(counts);
    let logger = node.logger().clone();
    node.subscribe(&topics::JOINT_STATES, move |message| {
        // Without any names the first joint is meant.
        let index = message.name.iter().position(|name| name == JOINT).or(message.name.is_empty().then_some(0));
        let of_joint = |values: &[f64]| index.and_then(|index| values.get(index).copied());
        let (Some(position), Some(velocity)) = (of_joint(&message.position), of_joint(&message.velocity)) else {
            if counts.unusable.fetch_add(1, Ordering::Relaxed) == 0 {
                logger.warn(&format!("a joint state has no position or no velocity of {JOINT}; such are left out and counted in /diagnostics"));
            }
            return;
        };
        let effort = of_joint(&message.effort);
        joints.send(Joint { stamp_ns: message.header.stamp.to_nanos(), position, velocity, effort });
    })?;
    node.subscribe(&topics::MOTOR_VOLTAGE, move |message| {
        if message.voltage.is_finite() {
            voltages.send(message.voltage);
        }
    })?;
    node.subscribe(&topics::REFERENCE, move |message| {
        if message.position.is_finite() && message.velocity.is_finite() {
            references.send((message.position, message.velocity));
        }
    })?;
    Ok(Inputs { joints: for_joints, voltages: for_voltages, references: for_references, orders })
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
}

impl Observing {
    fn order(&self, runs: bool) -> Result<(), CallbackError> {
        if locked(&self.orders).send(Order::Run(runs)) {
            Ok(())
        } else {
            Err(CallbackError::Failure("too many requests at once; try again".to_owned()))
        }
    }
}

impl Managed for Observing {
    fn activate(&mut self) -> Result<(), CallbackError> {
        self.order(true)
    }

    fn deactivate(&mut self) -> Result<(), CallbackError> {
        self.order(false)
    }

    fn shut_down(&mut self) -> Result<(), CallbackError> {
        self.order(false)
    }
}
