//! The axis behind the node: the rig's threads, what they said last, and what people ask of them.

mod diagnostics;
mod hands;
mod stopping;

use std::{
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::JoinHandle,
    time::{Duration, Instant},
};

use ros_node::{
    Logger, NodeClock, RosNode, RosNodeError,
    lifecycle::{Lifecycle, Phase, Requested},
    queue::{Receiver, Sender, Waker, queue},
    timing::Stopwatch,
};

use hands::AxisHands;

use super::{
    RigNode,
    control::{self, Asked, Counters, Cycle, RunningRig, VoltageCommand, Work},
    in_cycle::InCycle,
    locked::locked,
    memory,
    parameters::RigSettings,
    torque_estimate::TorqueEstimate,
    warmth::{Record, Warmth},
    zero::Zero,
};
use crate::{
    Rig,
    safety::{FaultReport, SafetyLimits, State, StopLatch, Supervised},
    station::{Kind, Presence, Progress, Station, Walk},
};

/// Cycles that wait for the publisher: half a second at 1 kHz.
const PUBLISHER_QUEUE: usize = 512;
/// Longest time for finding zeros.
const ZERO_TIME: Duration = Duration::from_secs(5);
/// Longest time in which the control thread answers a request; then it is given up, and not done
/// any more.
const ANSWER: Duration = Duration::from_millis(1000);
/// Time between two looks at what is awaited.
const LOOK: Duration = Duration::from_micros(200);

/// A rig under its safety layer, unconfigured.
pub type UnconfiguredRig = Supervised<Box<dyn Rig + Send>>;

/// What the control thread said last, and what is added up from it.
struct Seen {
    state: State,
    fault: Option<FaultReport>,
    /// The winding above ambient \[K\].
    rise: Option<f64>,
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
    /// The emergency stop, and what people and control thread share.
    station: Arc<Station>,
    /// Who has it asks the control thread: one request at a time. The emergency stop never takes
    /// it.
    asking: Mutex<()>,
    /// A stop was cleared; what it latched in the back end is cleared with the next configuration.
    clears_back_end: AtomicBool,
    /// The press of the emergency stop that was told last.
    told_press: AtomicU64,
    /// The fault that was told last.
    told: Mutex<Option<FaultReport>>,
    /// A rig that is open already: the one of the first configuration.
    opened: Mutex<Option<UnconfiguredRig>>,
    /// Settings and limits of the rig that is open, or was last.
    in_force: Mutex<Option<(RigSettings, SafetyLimits)>>,
    /// How warm the motors are.
    warmth: Arc<Warmth>,
    /// The rig's file with the temperature, if it has one; none after it could not be written.
    record: Mutex<Option<Record>>,
    /// What answers within the cycle, while no thread has it; and whether there is such a thing.
    in_cycle: Mutex<Option<Box<dyn InCycle>>>,
    answered_within: bool,
    /// What the system said about the control thread's priority.
    priority: Mutex<String>,
}

/// Cycles that were published, and that were not because the queue was full or the middleware
/// refused.
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
        (stop, warmth): (StopLatch, Arc<Warmth>),
    ) -> Result<Self, RosNodeError> {
        let seen = Seen {
            state: State::Unconfigured,
            fault: None,
            rise: None,
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
            station: Arc::new(Station::under(stop)),
            asking: Mutex::default(),
            clears_back_end: AtomicBool::new(false),
            told_press: AtomicU64::new(0),
            told: Mutex::default(),
            opened: Mutex::new(opened),
            in_force: Mutex::default(),
            warmth,
            record: Mutex::default(),
            answered_within: in_cycle.is_some(),
            in_cycle: Mutex::new(in_cycle),
            priority: Mutex::default(),
        })
    }

    /// Carries a transition out, whatever holds it up; `settings` are those of the rig that is to
    /// be opened.
    pub(super) fn carry_out(
        &self,
        kind: Kind,
        settings: Option<&RigSettings>,
    ) -> Result<(), String> {
        let _asking = locked(&self.asking);
        let mut hands = AxisHands { axis: self, settings, opened: None };
        let mut walk = Walk::new(kind);
        let mut waits: Option<Instant> = None;
        loop {
            match walk.step(&self.station, &mut hands) {
                Progress::Goes => {}
                Progress::Waits if waits.get_or_insert_with(Instant::now).elapsed() > ANSWER => {
                    walk.give_up()
                }
                Progress::Waits => std::thread::sleep(LOOK),
                Progress::Done(outcome) => return outcome.map_err(|why| why.to_string()),
            }
        }
    }

    /// Starts the threads of an opened rig.
    fn start(&self, settings: &RigSettings, mut rig: UnconfiguredRig) -> Result<(), String> {
        let limits = *rig.supervisor().limits();
        let simulated = settings.is_simulated();
        let record =
            if simulated { None } else { Record::of(&settings.name, &settings.state_folder) };
        let (rise, assumed) = self.warmth.rise(&settings.name, &limits, record.as_ref(), simulated);
        if let Some(assumed) = assumed {
            self.logger.info(&assumed);
        }
        rig.warm(rise);
        locked(&self.seen).rise = limits.motor.map(|_| rise);
        *locked(&self.in_force) = Some((settings.clone(), limits));
        *locked(&self.record) = record;
        let in_cycle = locked(&self.in_cycle).take();
        let torque = TorqueEstimate::new(
            settings.torque_source,
            settings.motor(),
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
            std::thread::Builder::new()
                .name("publisher".into())
                .spawn(publish)
                .map_err(|e| e.to_string())?
        };
        let clock = self.clock.clone();
        let work = Work { rig, torque, in_cycle, station: Arc::clone(&self.station) };
        let ends = control::start(work, to_publisher, move || clock.now_ns())
            .map_err(|e| e.to_string())?;
        let priority = format!("{}; {}", ends.priority, memory::lock());
        self.logger.info(&priority);
        *locked(&self.priority) = priority;
        *locked(&self.counters) = Arc::clone(&ends.rig.counters);
        *locked(&self.commands) = Some(ends.commands);
        *locked(&self.running) = Some((ends.rig, publisher));
        Ok(())
    }

    /// Ends the threads and lets go of the rig.
    fn close(&self) {
        locked(&self.commands).take();
        // Nobody waits for this lock while the threads end.
        let running = locked(&self.running).take();
        if let Some((rig, publisher)) = running {
            let dropped = Arc::clone(&rig.not_published);
            if let Some(in_cycle) = rig.end() {
                *locked(&self.in_cycle) = Some(in_cycle);
            }
            // It ends with the queue.
            let _ = publisher.join();
            self.published.dropped.fetch_add(dropped.load(Ordering::Relaxed), Ordering::Relaxed);
            self.keep_temperature(true);
        }
        let mut seen = locked(&self.seen);
        (seen.state, seen.fault) = (State::Unconfigured, None);
    }

    /// Notes how warm the motor is, for the next configuration and for the next start. Never on the
    /// control thread: it writes a file.
    pub(super) fn keep_temperature(&self, at_rest: bool) {
        if !at_rest && self.station.presence() != Presence::Running {
            return;
        }
        let name = locked(&self.in_force).as_ref().map(|(settings, _)| settings.name.clone());
        let (Some(name), Some(rise)) = (name, locked(&self.seen).rise) else { return };
        self.warmth.note(&name, rise);
        let mut record = locked(&self.record);
        if let Some(Err(error)) = record.as_ref().map(|record| record.write(rise, at_rest)) {
            let path =
                record.take().map(|record| record.path().display().to_string()).unwrap_or_default();
            self.logger.warn(&format!(
                "the motor's temperature cannot be kept in {path}: {error}; after a restart it counts as warm"
            ));
        }
    }

    /// What the system said about the control thread's priority; empty before there was one.
    pub(super) fn priority(&self) -> String {
        locked(&self.priority).clone()
    }

    /// Cycles that were published, and that were not.
    pub(super) fn published(&self) -> (u64, u64) {
        let Published { taken, refused, dropped } = &*self.published;
        let running = locked(&self.running)
            .as_ref()
            .map_or(0, |(rig, _)| rig.not_published.load(Ordering::Relaxed));
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

    /// Asks the control thread, outside of a transition. A request that is not answered in time is
    /// withdrawn.
    fn ask(&self, asked: Asked) -> Result<State, String> {
        let none = || "there is no rig; configure the node first".to_owned();
        let _asking = locked(&self.asking);
        let number = self.station.desk.number();
        locked(&self.running).as_ref().ok_or_else(none)?.0.send(number, asked);
        let begun = Instant::now();
        while begun.elapsed() < ANSWER {
            if let Some(answer) = locked(&self.running).as_ref().ok_or_else(none)?.0.answer(number)
            {
                return answer;
            }
            std::thread::sleep(LOOK);
        }
        self.station.desk.give_up(number);
        Err("the control thread does not answer: the rig hangs; take its power away if it moves"
            .to_owned())
    }

    /// Whether the node lets the motor move.
    pub(super) fn may_move(&self) -> bool {
        self.station.permission.is_given()
    }

    /// Puts the motor at zero volts for good: whatever is under way does not lead to motion any
    /// more.
    pub(super) fn halt(&self) {
        self.station.permission.leave();
        if self.station.presence() == Presence::Running {
            let _ = self.carry_out(Kind::Deactivate, None);
        }
        self.close();
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
        self.ask(Asked::Zero)?;
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
        let press = self.station.latch.newest();
        if self.told_press.swap(press, Ordering::Relaxed) < press {
            self.logger.error(
                "emergency stop: the motor is at zero volts until ~/clear_fault, configure and activate",
            );
        }
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
        if matches!(state, State::Faulted | State::EmergencyStopped)
            && lifecycle.phase() == Phase::Active
        {
            // Whoever asked for a change at the same time had it first.
            let _ = lifecycle.request(Requested::Deactivate);
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
            (seen.state, seen.fault, seen.zero, seen.rise) =
                (cycle.state, cycle.fault, cycle.zero, cycle.rise);
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
