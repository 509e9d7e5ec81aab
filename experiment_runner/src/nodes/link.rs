//! The experiment's place on the network: what it hears of the nodes and how it speaks to them.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, SyncSender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use controller::Reference;
use msgs::diagnostic_msgs::{DiagnosticArray, DiagnosticStatus};
use msgs::friction_msgs::{self, MotorVoltage};
use msgs::lifecycle_msgs::{State, TransitionEvent};
use msgs::std_msgs::Header;
use msgs::std_srvs::{Trigger, TriggerRequest, TriggerResponse};
use msgs::topics::{self, Qos};
use ros_node::RemoteParameters;
use ros_node::lifecycle::RemoteLifecycle;
use ros_node::parameters::Parameters;
use ros_node::{Participant, Publisher, RosNode, RosNodeError, ServiceClient};

use super::{Assembler, Heard, Source, Whole};

/// What waits for the one who drives: eight seconds at 1 kHz.
const WAITING: usize = 16_384;
/// How long it may take to find a node: on a busy machine the first answer to a new client can take
/// seven seconds.
pub(super) const FINDING: Duration = Duration::from_secs(25);
/// How long a node may take to answer.
pub(super) const PATIENCE: Duration = Duration::from_secs(8);
/// How long one may take that is asked to stop.
pub(super) const STOPPING: Duration = Duration::from_secs(2);

/// Something that was heard.
#[derive(Debug, Clone, Copy)]
pub enum Event {
    /// The rig has measured; now is the time to say what comes next.
    Measured {
        /// Time of the measurement [ns since the Unix epoch].
        stamp_ns: u64,
        /// Every channel.
        measurement: rig_driver::Measurement,
    },
    /// Everything was heard of a cycle.
    Whole(Whole),
}

/// A node that can be led and set.
pub(super) struct Led {
    pub(super) lifecycle: RemoteLifecycle,
    pub(super) parameters: RemoteParameters,
}

impl Led {
    fn new(node: &RosNode, name: &str) -> Result<Self, RosNodeError> {
        Ok(Self {
            lifecycle: RemoteLifecycle::new(node, name)?,
            parameters: RemoteParameters::new(node, name)?,
        })
    }
}

/// The experiment on the network. The fields are dropped in this order: what belongs to the node,
/// the node, the participant.
pub struct Link {
    events: Mutex<Receiver<Event>>,
    ear: Arc<Ear>,
    reference: Publisher<friction_msgs::Reference>,
    voltage: Publisher<MotorVoltage>,
    pub(super) rig: Led,
    pub(super) observer: Led,
    pub(super) controller: Led,
    reset: ServiceClient<TriggerRequest, TriggerResponse>,
    _node: RosNode,
    _participant: Participant,
}

impl std::fmt::Debug for Link {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Link").finish_non_exhaustive()
    }
}

/// What the callbacks of the subscriptions share.
struct Ear {
    events: SyncSender<Event>,
    assembler: Mutex<Assembler>,
    heard: Mutex<[Option<Instant>; 3]>,
    /// What the rig's driver said of a fault last.
    fault: Mutex<Option<String>>,
    /// Somebody took the rig's driver out of active.
    left: AtomicBool,
    overrun: AtomicU64,
}

impl Ear {
    fn hear(&self, header: &Header, heard: Heard) {
        locked(&self.heard)[heard.source() as usize] = Some(Instant::now());
        let stamp_ns = header.stamp.to_nanos();
        if let Heard::Measurement(measurement) = heard {
            self.tell(Event::Measured { stamp_ns, measurement });
        }
        if let Some(whole) = locked(&self.assembler).hear(stamp_ns, heard) {
            self.tell(Event::Whole(whole));
        }
    }

    fn tell(&self, event: Event) {
        if self.events.try_send(event).is_err() {
            self.overrun.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// `rig` is the name under which the rig's driver speaks of its loop.
    fn diagnosed(&self, rig: &str, message: &DiagnosticArray) {
        let of_rig = |status: &&DiagnosticStatus| {
            status.name == rig && status.level >= DiagnosticStatus::ERROR
        };
        if let Some(status) = message.status.iter().find(of_rig) {
            *locked(&self.fault) = Some(status.message.clone());
        }
    }
}

/// What a lock protects here is whole even if somebody panicked beside it.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Link {
    /// Joins the graph as the node `frictionlab_run` and listens.
    ///
    /// # Errors
    /// [`RosNodeError`] if the middleware refuses.
    pub fn new(participant: Participant) -> Result<Self, RosNodeError> {
        let node = participant.node("frictionlab_run")?;
        // The enclave of a runner may not answer under this name.
        if participant.enclave().is_none() {
            Parameters::usual(&node)?;
        }
        let (events, receiver) = mpsc::sync_channel(WAITING);
        let ear = Arc::new(Ear {
            events,
            assembler: Mutex::default(),
            heard: Mutex::default(),
            fault: Mutex::default(),
            left: AtomicBool::new(false),
            overrun: AtomicU64::new(0),
        });
        let of_rig = Arc::clone(&ear);
        node.subscribe(&topics::RIG_MEASUREMENT, move |message| {
            of_rig.hear(&message.header, Heard::from(&message));
        })?;
        let of_observer = Arc::clone(&ear);
        node.subscribe(&topics::FRICTION_ESTIMATE, move |message| {
            if let Some(heard) = Heard::estimate(&message) {
                of_observer.hear(&message.header, heard);
            }
        })?;
        let of_controller = Arc::clone(&ear);
        node.subscribe(&topics::CONTROLLER_STATE, move |message| {
            of_controller.hear(&message.header, Heard::from(&message));
        })?;
        let of_rig = Arc::clone(&ear);
        let event = "rig_driver/transition_event";
        node.subscribe_on(event, Qos::DEFAULT, move |event: TransitionEvent| {
            if event.goal_state.id != State::PRIMARY_STATE_ACTIVE {
                of_rig.left.store(true, Ordering::Relaxed);
            }
        })?;
        let of_all = Arc::clone(&ear);
        let namespace = node.identity().namespace.trim_matches('/');
        let rig =
            format!("{namespace}/rig_driver: control loop").trim_start_matches('/').to_owned();
        node.subscribe(&topics::DIAGNOSTICS, move |message| of_all.diagnosed(&rig, &message))?;
        Ok(Self {
            events: Mutex::new(receiver),
            ear,
            reference: node.publisher(&topics::REFERENCE)?,
            voltage: node.publisher(&topics::MOTOR_VOLTAGE)?,
            rig: Led::new(&node, "rig_driver")?,
            observer: Led::new(&node, "friction_observer")?,
            controller: Led::new(&node, "controller")?,
            reset: node.client::<Trigger>("friction_observer/reset")?,
            _node: node,
            _participant: participant,
        })
    }

    /// The next thing that is heard, within `patience`.
    pub(super) fn next(&self, patience: Duration) -> Option<Event> {
        locked(&self.events).recv_timeout(patience).ok()
    }

    /// Forgets what was heard and begins to put cycles together, `controlled` or not.
    pub(super) fn begin(&self, controlled: bool) {
        locked(&self.ear.assembler).begin(controlled);
        while self.next(Duration::ZERO).is_some() {}
        *locked(&self.ear.fault) = None;
        self.ear.left.store(false, Ordering::Relaxed);
    }

    /// Whether somebody took the rig's driver out of active since [`begin`](Self::begin).
    pub(super) fn was_deactivated(&self) -> bool {
        self.ear.left.load(Ordering::Relaxed)
    }

    /// Cycles of which something was not heard since [`begin`](Self::begin), or for which there was
    /// no time.
    pub(super) fn lost(&self) -> u64 {
        locked(&self.ear.assembler).lost() + self.ear.overrun.swap(0, Ordering::Relaxed)
    }

    /// Time since `source` was heard last; none if never.
    pub(super) fn silence(&self, source: Source) -> Option<Duration> {
        locked(&self.ear.heard)[source as usize].map(|heard| heard.elapsed())
    }

    /// What the rig's driver says of the fault it stopped the motor for, as long as it may take to
    /// be told.
    pub(super) fn fault(&self, patience: Duration) -> Option<String> {
        let until = Instant::now() + patience;
        loop {
            if let Some(said) = locked(&self.ear.fault).clone() {
                return Some(said);
            }
            if Instant::now() >= until {
                return None;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Says where the axis should be at `stamp_ns`.
    pub(super) fn refer(&self, stamp_ns: u64, reference: &Reference) -> Result<(), RosNodeError> {
        self.reference.publish(controller::messages::reference(stamp_ns, reference))
    }

    /// Says what the motor should get in answer to the measurement of `stamp_ns`.
    pub(super) fn drive(&self, stamp_ns: u64, voltage: f64) -> Result<(), RosNodeError> {
        self.voltage.publish(MotorVoltage { header: Header::at(stamp_ns), voltage })
    }

    /// Puts the observer at rest.
    pub(super) fn reset_observer(&self) -> Result<(), RosNodeError> {
        self.reset.call_until_answered(&TriggerRequest::default(), FINDING).map(drop)
    }
}
