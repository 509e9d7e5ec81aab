//! The executable: a managed node around the rig. Its states are those of the safety layer, and the motor moves in `active` only.

use std::{
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread::JoinHandle,
    time::{Duration, Instant},
};

use msgs::{
    builtin_interfaces::Time,
    diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue},
    std_msgs::Header,
    std_srvs::{Trigger, TriggerResponse},
    topics,
};
use ros_node::{
    Logger, NodeClock, ParameterValue, Participant, RosNode, RosNodeError, Stop,
    lifecycle::{CallbackError, Lifecycle, Managed, Phase, Requested},
    parameters::Parameters,
    queue::{Receiver, Sender, Waker, queue},
    timing::Stopwatch,
};

use super::{
    RigNode,
    control::{self, Counters, Cycle, RunningRig, VoltageCommand},
    declarations,
    parameters::RigSettings,
    torque_source::TorqueEstimate,
};
use crate::{
    Measurement,
    safety::{FaultReport, Request, State},
};

/// Cycles that wait for the publisher: half a second at 1 kHz.
const PUBLISHER_QUEUE: usize = 512;
/// Age from which a command without a stamp no longer counts as made when it comes.
const WAITED: Duration = Duration::from_millis(100);
/// How often faults are looked for.
const WATCH: Duration = Duration::from_millis(20);
/// Time between two diagnostics.
const DIAGNOSTICS: Duration = Duration::from_secs(1);
/// Cycles over which zeros are averaged.
const ZERO_CYCLES: u32 = 200;
/// Longest time that takes.
const ZERO_TIME: Duration = Duration::from_secs(5);

/// Runs the node until `stop`.
///
/// # Errors
/// [`RosNodeError`] if it cannot start; everything later is told in the log.
pub fn run(participant: &Participant, stop: &Stop) -> Result<(), RosNodeError> {
    let node = participant.node("rig_driver")?;
    let rig = match node.given("rig") {
        Some(ParameterValue::String(rig)) => rig,
        _ => "simulated".to_owned(),
    };
    let axis = Arc::new(Axis::new(&node)?);
    let settings = Arc::new(Mutex::new(None));
    let judged = Arc::clone(&settings);
    let parameters = Parameters::declare(&node, declarations(&rig), move |values, _| {
        *locked(&judged) = Some(RigSettings::read(values)?);
        Ok(())
    })?;
    let commands = Arc::clone(&axis.commands);
    node.subscribe_with_age(&topics::MOTOR_VOLTAGE, move |message, age| {
        let unstamped = message.header.stamp == Time::default();
        // It waited somewhere: the one who sent it did not mean now.
        if unstamped && age > WAITED {
            return;
        }
        if let Some(queue) = &mut *locked(&commands) {
            let stamp = message.header.stamp;
            // Before 1970 is long ago; zero says that there is no stamp.
            let stamp_ns = if stamp.sec < 0 { 1 } else { stamp.to_nanos() };
            queue.send(VoltageCommand { stamp_ns, volts: message.voltage });
        }
    })?;
    let managed = Driver { axis: Arc::clone(&axis), settings };
    let lifecycle = Lifecycle::start(&node, Box::new(managed))?;
    serve(&node, &axis, &lifecycle)?;
    let diagnostics = node.publisher(&topics::DIAGNOSTICS)?;
    if lifecycle.starts_itself(parameters.values().boolean("autostart"))
        && lifecycle.request(Requested::Configure).is_ok()
    {
        // The log says why it is not active, if it is not.
        let _ = lifecycle.request(Requested::Activate);
    }
    let mut next = Instant::now() + DIAGNOSTICS;
    while !stop.wait(WATCH) {
        axis.watch(&lifecycle);
        if Instant::now() >= next {
            next += DIAGNOSTICS;
            let message = axis.diagnostics(node.clock(), lifecycle.phase());
            // The next one comes in a second.
            let _ = diagnostics.publish(message);
        }
    }
    node.logger().info("leaving");
    // The motor is at zero volts before the node goes.
    axis.halt();
    Ok(())
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Offers what people stop and mend the rig with.
fn serve(node: &RosNode, axis: &Arc<Axis>, lifecycle: &Lifecycle) -> Result<(), RosNodeError> {
    let answer = |result: Result<String, String>| match result {
        Ok(message) => TriggerResponse { success: true, message },
        Err(message) => TriggerResponse { success: false, message },
    };
    let this = Arc::clone(axis);
    node.serve::<Trigger>("~/emergency_stop", move |_| answer(this.emergency_stop()))?;
    let (this, states) = (Arc::clone(axis), lifecycle.clone());
    node.serve::<Trigger>("~/clear_fault", move |_| answer(this.clear(&states)))?;
    let this = Arc::clone(axis);
    node.serve::<Trigger>("~/zero_sensors", move |_| answer(this.zero()))
}

/// What the control thread said last, and what is added up from it.
struct Seen {
    state: State,
    fault: Option<FaultReport>,
    stopwatch: Stopwatch,
    ages: Stopwatch,
    zero: Zero,
}

/// Zeros found by `~/zero_sensors`, taken off what is published.
#[derive(Debug, Clone, Copy, Default)]
struct Zero {
    position: f64,
    counts: i64,
    velocity: f64,
    torque: f64,
    /// Cycles still to be averaged, with the sums so far.
    left: u32,
    sums: [f64; 2],
}

impl Zero {
    fn apply(&mut self, raw: &Measurement) -> Measurement {
        if self.left > 0 {
            self.left -= 1;
            self.sums[0] += raw.tachometer_velocity;
            self.sums[1] += raw.torque;
            if self.left == 0 {
                self.velocity = self.sums[0] / f64::from(ZERO_CYCLES);
                self.torque = self.sums[1] / f64::from(ZERO_CYCLES);
                (self.position, self.counts) = (raw.encoder_position, raw.encoder_counts);
            }
        }
        Measurement {
            encoder_position: raw.encoder_position - self.position,
            encoder_counts: raw.encoder_counts - self.counts,
            tachometer_velocity: raw.tachometer_velocity - self.velocity,
            torque: raw.torque - self.torque,
            ..*raw
        }
    }
}

/// The axis as the node sees it.
struct Axis {
    /// Name of the node in `/diagnostics`, which all axes share.
    name: String,
    publishers: Arc<RigNode>,
    logger: Logger,
    clock: NodeClock,
    running: Mutex<Option<(RunningRig, JoinHandle<()>)>>,
    commands: Arc<Mutex<Option<Sender<VoltageCommand>>>>,
    seen: Arc<Mutex<Seen>>,
    counters: Mutex<Arc<Counters>>,
    /// Somebody stopped the motor while there was no rig to tell.
    stopped: AtomicBool,
    /// The fault that was told last.
    told: Mutex<Option<FaultReport>>,
}

impl Axis {
    fn new(node: &RosNode) -> Result<Self, RosNodeError> {
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
            logger: node.logger().clone(),
            clock: node.clock().clone(),
            running: Mutex::default(),
            commands: Arc::default(),
            seen: Arc::new(Mutex::new(seen)),
            counters: Mutex::default(),
            stopped: AtomicBool::new(false),
            told: Mutex::default(),
        })
    }

    /// Opens the rig and starts its threads.
    fn open(&self, settings: &RigSettings) -> Result<(), String> {
        if self.stopped.load(Ordering::Relaxed) {
            return Err("the emergency stop is set; clear it first with ~/clear_fault".to_owned());
        }
        let rig = settings.open().map_err(|error| error.to_string())?;
        let torque = TorqueEstimate::new(
            settings.torque_source,
            settings.drive(),
            crate::Rig::period(&rig),
            settings.torque_filter,
        );
        let waker = Waker::default();
        let (to_publisher, for_publisher) = queue(PUBLISHER_QUEUE, &waker);
        let publisher = {
            let (publishers, seen, logger) =
                (Arc::clone(&self.publishers), Arc::clone(&self.seen), self.logger.clone());
            let publish = move || {
                waker.is_this_thread();
                publish(&publishers, for_publisher, &seen, torque, &logger);
            };
            std::thread::Builder::new().name("publisher".into()).spawn(publish).map_err(|e| e.to_string())?
        };
        let ends = control::start(rig, to_publisher, self.clock.now_ns()).map_err(|e| e.to_string())?;
        self.logger.info(&ends.priority);
        *locked(&self.counters) = Arc::clone(&ends.rig.counters);
        *locked(&self.commands) = Some(ends.commands);
        *locked(&self.running) = Some((ends.rig, publisher));
        let asked = self.ask(Request::Configure);
        if asked.is_err() {
            self.close();
        }
        asked.map(|_| ())
    }

    /// Ends the threads and lets go of the rig.
    fn close(&self) {
        locked(&self.commands).take();
        if let Some((rig, publisher)) = locked(&self.running).take() {
            drop(rig);
            // It ends with the queue.
            let _ = publisher.join();
        }
        let mut seen = locked(&self.seen);
        (seen.state, seen.fault) = (State::Unconfigured, None);
    }

    fn ask(&self, request: Request) -> Result<State, String> {
        match &*locked(&self.running) {
            Some((rig, _)) => rig.ask(request),
            None => Err("there is no rig; configure the node first".to_owned()),
        }
    }

    /// Puts the motor at zero volts for good.
    fn halt(&self) {
        let _ = self.ask(Request::Deactivate);
        self.close();
    }

    fn emergency_stop(&self) -> Result<String, String> {
        self.stopped.store(true, Ordering::Relaxed);
        if locked(&self.running).is_some() {
            self.ask(Request::EmergencyStop)?;
        }
        self.logger
            .error("emergency stop: the motor is at zero volts until ~/clear_fault, configure and activate");
        Ok("the motor is at zero volts; clear_fault, configure and activate to go on".to_owned())
    }

    fn clear(&self, lifecycle: &Lifecycle) -> Result<String, String> {
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

    fn zero(&self) -> Result<String, String> {
        {
            let mut seen = locked(&self.seen);
            match seen.state {
                State::Unconfigured | State::Finalized => {
                    return Err("there is no rig; configure the node first".to_owned());
                }
                State::Active => return Err("the motor may move; deactivate the node first".to_owned()),
                _ => seen.zero = Zero { left: ZERO_CYCLES, ..Zero::default() },
            }
        }
        let asked = Instant::now();
        while asked.elapsed() < ZERO_TIME {
            std::thread::sleep(Duration::from_millis(5));
            let zero = locked(&self.seen).zero;
            if zero.left == 0 {
                return Ok(format!(
                    "position {:.4} rad, velocity {:.4} rad/s and torque {:.4} N m count as zero from now on",
                    zero.position, zero.velocity, zero.torque
                ));
            }
        }
        Err("the rig delivers no readings".to_owned())
    }

    /// Brings a fault, or a stop, to the log and to the node's state.
    fn watch(&self, lifecycle: &Lifecycle) {
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

    fn diagnostics(&self, clock: &NodeClock, phase: Phase) -> DiagnosticArray {
        let counters = Arc::clone(&locked(&self.counters));
        let not_published =
            locked(&self.running).as_ref().map_or(0, |(rig, _)| rig.not_published.load(Ordering::Relaxed));
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
    mut torque: TorqueEstimate,
    logger: &Logger,
) {
    let mut refused = 0u64;
    loop {
        let Some(cycle) = queue.take() else {
            if queue.is_over() {
                return;
            }
            Waker::sleep(Duration::from_millis(50));
            continue;
        };
        let measurement = {
            let mut seen = locked(seen);
            (seen.state, seen.fault) = (cycle.state, cycle.fault);
            seen.stopwatch.note(cycle.period_ns, cycle.execution_ns);
            if cycle.age_ns > 0 {
                seen.ages.note(cycle.age_ns, 0);
            }
            seen.zero.apply(&cycle.measurement)
        };
        let effort = torque.torque(&measurement);
        if let Err(error) = publishers.publish_with_effort(cycle.stamp_ns, &measurement, effort) {
            refused += 1;
            if refused == 1 {
                logger.warn(&error.to_string());
            }
        }
    }
}

/// What the managed node does on its way.
struct Driver {
    axis: Arc<Axis>,
    settings: Arc<Mutex<Option<RigSettings>>>,
}

impl Managed for Driver {
    fn configure(&mut self) -> Result<(), CallbackError> {
        let settings = locked(&self.settings).clone();
        let settings = settings.ok_or_else(|| "the parameters were not read".to_owned())?;
        Ok(self.axis.open(&settings)?)
    }

    fn activate(&mut self) -> Result<(), CallbackError> {
        self.axis.ask(Request::Activate)?;
        Ok(())
    }

    fn deactivate(&mut self) -> Result<(), CallbackError> {
        // A fault has deactivated the safety layer already; then there is nothing to do but to say so.
        match self.axis.ask(Request::Deactivate) {
            Ok(_) => Ok(()),
            Err(_) if locked(&self.axis.seen).state != State::Active => Ok(()),
            Err(reason) => Err(CallbackError::Error(reason)),
        }
    }

    fn clean_up(&mut self) -> Result<(), CallbackError> {
        self.axis.close();
        Ok(())
    }

    fn shut_down(&mut self) -> Result<(), CallbackError> {
        self.axis.halt();
        Ok(())
    }
}
