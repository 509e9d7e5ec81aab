//! The node with a back end that takes its time: stops and transitions in the middle of what it
//! does.

use std::{
    ops::ControlFlow,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering::SeqCst},
    },
    thread,
    time::{Duration, Instant},
};

use msgs::std_srvs::{Trigger, TriggerRequest, TriggerResponse};
use rig_driver::{
    Measurement, Rig, RigError,
    node::{BegunCycle, EndedCycle, InCycle, RigDriver},
    safety::{SafetyLimits, SensorChecks, State, Supervised},
};
use ros_node::{
    Discovery, Participant, RosNode, ServiceClient,
    lifecycle::{Phase, RemoteLifecycle},
};
use tests::network::{namespaced, run_ignored};

const PATIENCE: Duration = Duration::from_secs(60);

/// Runs a test of this file that is ignored elsewhere in a network namespace of its own. Where the
/// system grants none, it is left out.
fn alone(test: &str) {
    let command = namespaced();
    run_ignored(
        command,
        test,
        &[
            ("ROS_DOMAIN_ID", "41".as_ref()),
            ("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST".as_ref()),
        ],
    );
}

/// What a test knows of the rig, and does to it.
#[derive(Default)]
struct Bench {
    /// Measuring waits while this is set.
    stuck: AtomicBool,
    /// It waits now.
    waits: AtomicBool,
    cycles: AtomicU64,
    /// Cycles with a voltage.
    moved: AtomicU64,
    stops: AtomicU64,
}

/// A rig that waits when it is told to.
struct Slow(Arc<Bench>);

impl Rig for Slow {
    fn period(&self) -> f64 {
        1e-3
    }

    fn measure(&mut self) -> Measurement {
        while self.0.stuck.load(SeqCst) {
            self.0.waits.store(true, SeqCst);
            thread::sleep(Duration::from_millis(1));
        }
        self.0.waits.store(false, SeqCst);
        let cycle = self.0.cycles.fetch_add(1, SeqCst);
        Measurement { cycle, time: cycle as f64 * 1e-3, ..Measurement::default() }
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        if volts != 0.0 {
            self.0.moved.fetch_add(1, SeqCst);
        }
        Ok(())
    }

    fn emergency_stop(&mut self) -> Result<(), RigError> {
        self.0.stops.fetch_add(1, SeqCst);
        self.halt()
    }
}

/// A controller that always wants to move.
struct Wants;

impl InCycle for Wants {
    fn answer(&mut self, _: &BegunCycle) -> Option<f64> {
        Some(1.0)
    }

    fn end(&mut self, _: EndedCycle) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

struct Session {
    bench: Arc<Bench>,
    rig: RigDriver,
    lifecycle: RemoteLifecycle,
    stop: ServiceClient<TriggerRequest, TriggerResponse>,
    clear: ServiceClient<TriggerRequest, TriggerResponse>,
    _node: RosNode,
    _participant: Participant,
}

fn session() -> Session {
    let bench = Arc::new(Bench::default());
    let participant = Participant::join(&Discovery::from_environment().unwrap()).unwrap();
    let limits = SafetyLimits {
        // As in the attack: the supervisor does not mind that the rig was away.
        cycle_lost: f64::MAX,
        motor: None,
        sensors: SensorChecks { agreement: None, torque_range: None, frozen_cycles: None },
        ..SafetyLimits::default()
    };
    let back_end: Box<dyn Rig + Send> = Box::new(Slow(Arc::clone(&bench)));
    let opened = Supervised::new(back_end, limits).unwrap();
    let rig = RigDriver::new(&participant, Some(Box::new(Wants)), Some(opened)).unwrap();
    let node = participant.node("people").unwrap();
    let lifecycle = RemoteLifecycle::new(&node, "/rig_driver").unwrap();
    let stop = node.client::<Trigger>("/rig_driver/emergency_stop").unwrap();
    let clear = node.client::<Trigger>("/rig_driver/clear_fault").unwrap();
    assert_eq!(lifecycle.phase(PATIENCE).unwrap(), Phase::Unconfigured);
    Session { bench, rig, lifecycle, stop, clear, _node: node, _participant: participant }
}

fn trigger(client: &ServiceClient<TriggerRequest, TriggerResponse>) -> TriggerResponse {
    client.call(TriggerRequest::default(), PATIENCE).unwrap()
}

fn until(what: &str, mut done: impl FnMut() -> bool) {
    let began = Instant::now();
    while !done() {
        assert!(began.elapsed() < PATIENCE, "{what}");
        thread::sleep(Duration::from_millis(1));
    }
}

impl Bench {
    fn run(&self, cycles: u64) {
        let before = self.cycles.load(SeqCst);
        until("the rig runs", || self.cycles.load(SeqCst) >= before + cycles);
    }
}

#[tests::needs(namespace)]
#[test]
fn a_stop_while_the_node_configures_holds() {
    alone("stop_while_configuring");
}

#[test]
#[ignore = "run in a network namespace by the test above"]
fn stop_while_configuring() {
    let mut session = session();
    session.bench.stuck.store(true, SeqCst);
    thread::scope(|scope| {
        let (lifecycle, bench) = (&session.lifecycle, &session.bench);
        let configured = scope.spawn(|| lifecycle.lead_to(Phase::Active, PATIENCE));
        until("the rig is being configured", || bench.waits.load(SeqCst));
        // It hangs, and nobody says that it is at zero volts.
        let answer = trigger(&session.stop);
        assert!(!answer.success && answer.message.contains("power"), "{}", answer.message);
        let refused = trigger(&session.clear);
        assert!(!refused.success, "cleared before it was seen: {}", refused.message);
        bench.stuck.store(false, SeqCst);
        assert!(configured.join().unwrap().is_err(), "it became active");
    });
    session.rig.tend();
    assert_ne!(session.lifecycle.phase(PATIENCE).unwrap(), Phase::Active);
    assert!(
        session.lifecycle.lead_to(Phase::Active, PATIENCE).is_err(),
        "not before it is cleared"
    );
    assert_eq!(session.bench.moved.load(SeqCst), 0);
    // It was closed: nothing drives the motor, and the stop says so.
    let answer = trigger(&session.stop);
    assert!(answer.success, "{}", answer.message);
    assert!(trigger(&session.clear).success);
}

#[tests::needs(namespace)]
#[test]
fn a_stop_goes_to_the_back_end_and_holds_until_it_is_cleared() {
    alone("stop_while_active");
}

#[test]
#[ignore = "run in a network namespace by the test above"]
fn stop_while_active() {
    let mut session = session();
    session.lifecycle.lead_to(Phase::Active, PATIENCE).unwrap();
    until("it moves", || session.bench.moved.load(SeqCst) > 10);
    let answer = trigger(&session.stop);
    let moved = session.bench.moved.load(SeqCst);
    assert!(answer.success && answer.message.contains("zero volts"), "{}", answer.message);
    assert!(session.bench.stops.load(SeqCst) >= 1, "the back end was told");
    session.bench.run(100);
    assert_eq!(session.bench.moved.load(SeqCst), moved, "not a cycle moves after the answer");
    until("the node is inactive", || {
        session.rig.tend();
        session.lifecycle.phase(PATIENCE).unwrap() == Phase::Inactive
    });
    assert!(session.lifecycle.lead_to(Phase::Active, PATIENCE).is_err());
    assert_eq!(session.bench.moved.load(SeqCst), moved);
    assert!(trigger(&session.clear).success);
    assert_eq!(session.lifecycle.phase(PATIENCE).unwrap(), Phase::Unconfigured);
}

#[tests::needs(namespace)]
#[test]
fn an_activation_that_was_given_up_is_never_done() {
    alone("late_activation");
}

#[test]
#[ignore = "run in a network namespace by the test above"]
fn late_activation() {
    let session = session();
    session.lifecycle.lead_to(Phase::Inactive, PATIENCE).unwrap();
    session.bench.stuck.store(true, SeqCst);
    until("it is stuck", || session.bench.waits.load(SeqCst));
    assert!(session.lifecycle.lead_to(Phase::Active, PATIENCE).is_err());
    assert_eq!(session.lifecycle.phase(PATIENCE).unwrap(), Phase::Inactive);
    session.bench.stuck.store(false, SeqCst);
    session.bench.run(500);
    assert_eq!(session.bench.moved.load(SeqCst), 0, "the node is inactive");
    assert_eq!(session.rig.state(), State::Inactive);
    session.lifecycle.lead_to(Phase::Active, PATIENCE).unwrap();
    until("it moves when it is asked to", || session.bench.moved.load(SeqCst) > 0);
}
