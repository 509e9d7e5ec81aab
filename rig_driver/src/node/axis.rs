//! The axis behind the node: the rig's threads, what they said last, and what people ask of them.

use std::{
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::JoinHandle,
    time::{Duration, Instant},
};

use msgs::{
    diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue},
    std_msgs::Header,
};
use ros_node::{
    Logger, NodeClock, RosNode, RosNodeError,
    lifecycle::{Lifecycle, Phase, Requested},
    queue::{Receiver, Sender, Waker, queue},
    timing::Stopwatch,
};

use super::{
    RigNode,
    control::{self, Counters, Cycle, RunningRig, VoltageCommand, Work},
    in_cycle::InCycle,
    parameters::RigSettings,
    torque_source::TorqueEstimate,
    zero::Zero,
};
use crate::{
    Rig,
    safety::{FaultReport, Request, State, Supervised},
};

/// Cycles that wait for the publisher: half a second at 1 kHz.
const PUBLISHER_QUEUE: usize = 512;
/// Longest time for finding zeros.
const ZERO_TIME: Duration = Duration::from_secs(5);

/// A rig under its safety layer, unconfigured.
pub type UnconfiguredRig = Supervised<Box<dyn Rig + Send>>;

pub(super) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What the control thread said last, and what is added up from it.
struct Seen {
    state: State,
    fault: Option<FaultReport>,
    stopwatch: Stopwatch,
    ages: Stopwatch,
    zero: Zero,
}

/// The axis as the node sees it.
pub(super) struct Axis {
    /// Name of the node in `/diagnostics`, which all axes share.
    name: String,
    publishers: Arc<RigNode>,
    published: Arc<Published>,
    logger: Logger,
    clock: NodeClock,
    running: Mutex<Option<(RunningRig, JoinHandle<()>)>>,
    pub(super) commands: Arc<Mutex<Option<Sender<VoltageCommand>>>>,
    seen: Arc<Mutex<Seen>>,
    counters: Mutex<Arc<Counters>>,
    /// Somebody stopped the motor while there was no rig to tell.
    stopped: AtomicBool,
    /// The fault that was told last.
    told: Mutex<Option<FaultReport>>,
    /// A rig that is open already: the one of the first configuration.
    opened: Mutex<Option<UnconfiguredRig>>,
    /// What answers within the cycle, while no thread has it; and whether there is such a thing.
    in_cycle: Mutex<Option<Box<dyn InCycle>>>,
    answered_within: bool,
    /// What the system said about the control thread's priority.
    priority: Mutex<String>,
}

/// Cycles that were published, and that were not because the queue was full or the middleware refused.
#[derive(Debug, Default)]
struct Published {
    taken: AtomicU64,
    refused: AtomicU64,
    /// Those of rigs that are closed again.
    dropped: AtomicU64,
}

impl Axis {
    pub(super) fn new(
        node: &RosNode,
        in_cycle: Option<Box<dyn InCycle>>,
        opened: Option<UnconfiguredRig>,
    ) -> Result<Self, RosNodeError> {
        let seen = Seen {
            state: State::Unconfigured,
            fault: None,
            stopwatch: Stopwatch::new(),
            ages: Stopwatch::new(),
            zero: Zero::default(),
        };
        Ok(Self {
            name: node.identity().qualified().trim_start_matches('/').to_owned(),
            publishers: Arc::new(RigNode::on(node)?),
            published: Arc::default(),
            logger: node.logger().clone(),
            clock: node.clock().clone(),
            running: Mutex::default(),
            commands: Arc::default(),
            seen: Arc::new(Mutex::new(seen)),
            counters: Mutex::default(),
            stopped: AtomicBool::new(false),
            told: Mutex::default(),
            opened: Mutex::new(opened),
            answered_within: in_cycle.is_some(),
            in_cycle: Mutex::new(in_cycle),
            priority: Mutex::default(),
        })
    }

    /// Opens the rig and starts its threads.
    pub(super) fn open(&self, settings: &RigSettings) -> Result<(), String> {
        if self.stopped.load(Ordering::Relaxed) {
            return Err("the emergency stop is set; clear it first with ~/clear_fault".to_owned());
        }
        let in_cycle = locked(&self.in_cycle).take();
        if self.answered_within && in_cycle.is_none() {
            return Err(
                "observer and controller are lost with the thread that had them; start the program again"
                    .to_owned(),
            );
        }
        let started = self.start(settings, in_cycle).and_then(|()| self.ask(Request::Configure));
        if started.is_err() {
            self.close();
        }
        started.map(drop)
    }

    fn start(&self, settings: &RigSettings, in_cycle: Option<Box<dyn InCycle>>) -> Result<(), String> {
        let opened = match locked(&self.opened).take() {
            Some(rig) => Ok(rig),
            None => settings.open(),
        };
        let rig = match opened {
            Ok(rig) => rig,
            Err(error) => {
                *locked(&self.in_cycle) = in_cycle;
                return Err(error.to_string());
            }
        };
        let torque = TorqueEstimate::new(
            settings.torque_source,
            settings.drive(),
            rig.period(),
            settings.torque_filter,
        );
        let waker = Waker::default();
        let (to_publisher, for_publisher) = queue(PUBLISHER_QUEUE, &waker);
        let publisher = {
            let (publishers, seen) = (Arc::clone(&self.publishers), Arc::clone(&self.seen));
            let (published, logger) = (Arc::clone(&self.published), self.logger.clone());
            let publish = move || {
                waker.is_this_thread();
                publish(&publishers, for_publisher, &seen, &published, &logger);
            };
            std::thread::Builder::new().name("publisher".into()).spawn(publish).map_err(|e| e.to_string())?
        };
        let clock = self.clock.clone();
        let work = Work { rig, torque, in_cycle };
        let ends = control::start(work, to_publisher, move || clock.now_ns()).map_err(|e| e.to_string())?;
        self.logger.info(&ends.priority);
        *locked(&self.priority) = ends.priority;
        *locked(&self.counters) = Arc::clone(&ends.rig.counters);
        *locked(&self.commands) = Some(ends.commands);
        *locked(&self.running) = Some((ends.rig, publisher));
        Ok(())
    }

    /// Ends the threads and lets go of the rig.
    pub(super) fn close(&self) {
        locked(&self.commands).take();
        if let Some((rig, publisher)) = locked(&self.running).take() {
            let dropped = Arc::clone(&rig.not_published);
            if let Some(in_cycle) = rig.end() {
                *locked(&self.in_cycle) = Some(in_cycle);
            }
            // It ends with the queue.
            let _ = publisher.join();
            self.published.dropped.fetch_add(dropped.load(Ordering::Relaxed), Ordering::Relaxed);
        }
        let mut seen = locked(&self.seen);
        (seen.state, seen.fault) = (State::Unconfigured, None);
    }

    /// What the system said about the control thread's priority; empty before there was one.
    pub(super) fn priority(&self) -> String {
        locked(&self.priority).clone()
    }

    /// Cycles that were published, and that were not.
    pub(super) fn published(&self) -> (u64, u64) {
        let Published { taken, refused, dropped } = &*self.published;
        let running =
            locked(&self.running).as_ref().map_or(0, |(rig, _)| rig.not_published.load(Ordering::Relaxed));
        let lost = refused.load(Ordering::Relaxed) + dropped.load(Ordering::Relaxed) + running;
        (taken.load(Ordering::Relaxed), lost)
    }

    /// Cycles that started a whole period late or more.
    pub(super) fn overruns(&self) -> u64 {
        locked(&self.counters).overruns.load(Ordering::Relaxed)
    }

    /// What the control thread has counted.
    pub(super) fn counters(&self) -> Arc<Counters> {
        Arc::clone(&locked(&self.counters))
    }

    /// State of the safety layer, as it was published last.
    pub(super) fn state(&self) -> State {
        locked(&self.seen).state
    }

    pub(super) fn ask(&self, request: Request) -> Result<State, String> {
        match &*locked(&self.running) {
            Some((rig, _)) => rig.ask(request),
            None => Err("there is no rig; configure the node first".to_owned()),
        }
    }

    /// Puts the motor at zero volts for good.
    pub(super) fn halt(&self) {
        let _ = self.ask(Request::Deactivate);
        self.close();
    }

    pub(super) fn emergency_stop(&self) -> Result<String, String> {
        self.stopped.store(true, Ordering::Relaxed);
        if locked(&self.running).is_some() {
            self.ask(Request::EmergencyStop)?;
        }
        self.logger
            .error("emergency stop: the motor is at zero volts until ~/clear_fault, configure and activate");
        Ok("the motor is at zero volts; clear_fault, configure and activate to go on".to_owned())
    }

    pub(super) fn clear(&self, lifecycle: &Lifecycle) -> Result<String, String> {
        if self.stopped.swap(false, Ordering::Relaxed) {
            // Whoever stopped the machine may have changed it: it is configured anew.
            if lifecycle.phase() == Phase::Active {
                let _ = lifecycle.request(Requested::Deactivate);
            }
            if lifecycle.phase() == Phase::Inactive {
                lifecycle.request(Requested::CleanUp)?;
            }
            return Ok("the emergency stop is cleared; configure and activate to go on".to_owned());
        }
        let state = self.ask(Request::Clear)?;
        locked(&self.told).take();
        self.logger.info("the fault is cleared");
        Ok(format!("the driver is {state}; activate to go on"))
    }

    pub(super) fn zero(&self) -> Result<String, String> {
        match self.state() {
            State::Unconfigured | State::Finalized => {
                return Err("there is no rig; configure the node first".to_owned());
            }
            State::Active => return Err("the motor may move; deactivate the node first".to_owned()),
            _ => {}
        }
        let before = locked(&self.seen).zero.found;
        if let Some((rig, _)) = &*locked(&self.running) {
            rig.find_zero()?;
        }
        let asked = Instant::now();
        while asked.elapsed() < ZERO_TIME {
            std::thread::sleep(Duration::from_millis(5));
            let zero = locked(&self.seen).zero;
            if zero.found != before {
                return Ok(format!(
                    "position {:.4} rad, velocity {:.4} rad/s and torque {:.4} N m count as zero from now on",
                    zero.position, zero.velocity, zero.torque
                ));
            }
        }
        Err("the rig delivers no readings".to_owned())
    }

    /// Brings a fault, or a stop, to the log and to the node's state.
    pub(super) fn watch(&self, lifecycle: &Lifecycle) {
        let (state, fault) = {
            let seen = locked(&self.seen);
            (seen.state, seen.fault)
        };
        if let Some(report) = fault {
            let mut told = locked(&self.told);
            // By kind and time: what was seen may be no number, which equals nothing.
            if told.map(|told| (told.fault, told.time)) != Some((report.fault, report.time)) {
                *told = Some(report);
                self.logger.error(&format!("the motor is at zero volts: {report}"));
            }
        }
        if matches!(state, State::Faulted | State::EmergencyStopped) && lifecycle.phase() == Phase::Active {
            // Whoever asked for a change at the same time had it first.
            let _ = lifecycle.request(Requested::Deactivate);
        }
    }

    pub(super) fn diagnostics(&self, clock: &NodeClock, phase: Phase) -> DiagnosticArray {
        let counters = Arc::clone(&locked(&self.counters));
        let (_, not_published) = self.published();
        let overruns = counters.overruns.load(Ordering::Relaxed);
        let stale = counters.stale.load(Ordering::Relaxed);
        let (timing, ages, state, fault) = {
            let mut seen = locked(&self.seen);
            let told = (seen.stopwatch.timing(overruns), seen.ages.timing(0), seen.state, seen.fault);
            seen.stopwatch.clear();
            seen.ages.clear();
            told
        };
        let (level, message) = match (fault, not_published + overruns) {
            (Some(report), _) => (DiagnosticStatus::ERROR, report.to_string()),
            (None, 0) => (DiagnosticStatus::OK, format!("{state}, in time")),
            (None, _) => (
                DiagnosticStatus::WARN,
                format!("{state}; {overruns} cycles were late, {not_published} not published"),
            ),
        };
        let value = |key: &str, value: String| KeyValue { key: key.to_owned(), value };
        let microseconds = |key: &str, number: f64| value(key, format!("{number:.1}"));
        DiagnosticArray {
            header: Header::at(clock.now_ns()),
            status: vec![DiagnosticStatus {
                level,
                name: format!("{}: control loop", self.name),
                message,
                hardware_id: "rig".to_owned(),
                values: vec![
                    value("node", phase.label().to_owned()),
                    value("state", state.to_string()),
                    value("cycles", timing.cycles.to_string()),
                    microseconds("period p50 [us]", timing.period.p50),
                    microseconds("period p99 [us]", timing.period.p99),
                    microseconds("execution p99 [us]", timing.execution.p99),
                    microseconds("command age p50 [us]", ages.period.p50),
                    microseconds("command age p99 [us]", ages.period.p99),
                    value("overruns", overruns.to_string()),
                    value("stale commands", stale.to_string()),
                    value("not published", not_published.to_string()),
                ],
            }],
        }
    }
}

/// Publishes cycles until the queue's other end is gone.
fn publish(
    publishers: &RigNode,
    mut queue: Receiver<Cycle>,
    seen: &Mutex<Seen>,
    published: &Published,
    logger: &Logger,
) {
    loop {
        let Some(cycle) = queue.take() else {
            if queue.is_over() {
                return;
            }
            Waker::sleep(Duration::from_millis(50));
            continue;
        };
        {
            let mut seen = locked(seen);
            (seen.state, seen.fault, seen.zero) = (cycle.state, cycle.fault, cycle.zero);
            seen.stopwatch.note(cycle.period_ns, cycle.execution_ns);
            if cycle.age_ns > 0 {
                seen.ages.note(cycle.age_ns, 0);
            }
        }
        match publishers.publish_with_effort(cycle.stamp_ns, &cycle.measurement, cycle.effort) {
            Ok(()) => _ = published.taken.fetch_add(1, Ordering::Relaxed),
            Err(error) => {
                if published.refused.fetch_add(1, Ordering::Relaxed) == 0 {
                    logger.warn(&error.to_string());
                }
            }
        }
    }
}
