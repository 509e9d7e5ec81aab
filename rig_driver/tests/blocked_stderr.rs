//! A standard error that nobody reads keeps neither the stop nor the end of the program.

use std::{
    fs::File,
    io::Write,
    os::fd::OwnedFd,
    process::{Command, Stdio},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use msgs::{
    RosMessage, RosService,
    friction_msgs::MotorVoltage,
    lifecycle_msgs::{ChangeState, ChangeStateResponse, GetState, GetStateRequest},
    message::Definition,
    std_srvs::{Trigger, TriggerRequest},
    topics,
};
use ros_node::{Discovery, Participant};
use rustix::{
    fs::{OFlags, fcntl_getfl, fcntl_setfl},
    process::{Pid, Signal, kill_process},
};
use tests::network::{namespaced, run_ignored};

const DOMAIN: u16 = 77;
const PATIENCE: Duration = Duration::from_secs(60);
const ACTIVE: u8 = 3;

/// One byte where a whole message is expected.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
struct Cut(u8);

impl RosMessage for Cut {
    const DEFINITION: Definition = MotorVoltage::DEFINITION;
    const DEPENDENCIES: &'static [Definition] = &[];
    const TYPE_HASH: &'static str = "";
}

impl ros2_client::Message for Cut {}

/// A request to change the state that ends after a byte.
struct CutRequest;

impl RosService for CutRequest {
    const PACKAGE: &'static str = ChangeState::PACKAGE;
    const NAME: &'static str = ChangeState::NAME;
    type Request = Cut;
    type Response = ChangeStateResponse;
}

#[tests::needs(namespace)]
#[test]
fn with_a_full_pipe_at_standard_error_the_driver_stops_and_ends() {
    let command = namespaced();
    let told = run_ignored(command, "attack", &[]);
    for line in told.lines().filter(|line| line.starts_with("blocked:")) {
        eprintln!("{line}");
    }
}

fn until(what: &str, mut done: impl FnMut() -> bool) {
    let began = Instant::now();
    while !done() {
        assert!(began.elapsed() < PATIENCE, "{what}");
        thread::sleep(Duration::from_millis(10));
    }
}

#[test]
#[ignore = "speaks DDS: run in a network namespace by the test above"]
fn attack() {
    let (_unread, pipe) = std::io::pipe().unwrap();
    let mut filling = File::from(OwnedFd::from(pipe.try_clone().unwrap()));
    let mut driver = Command::new(env!("CARGO_BIN_EXE_rig_driver"))
        .env("ROS_DOMAIN_ID", DOMAIN.to_string())
        .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        .stdin(Stdio::null())
        .stderr(pipe)
        .spawn()
        .unwrap();
    let participant =
        Participant::join(&Discovery { domain: DOMAIN, ..Discovery::default() }).unwrap();
    let node = participant.node("attacker").unwrap();
    let states = node.client::<GetState>("/rig_driver/get_state").unwrap();
    let stop = node.client::<Trigger>("/rig_driver/emergency_stop").unwrap();
    let faulted = Arc::new(AtomicBool::new(false));
    let seen = Arc::clone(&faulted);
    node.subscribe(&topics::RIG_MEASUREMENT, move |measured| {
        seen.store(measured.fault && measured.voltage_applied == 0.0, Ordering::Relaxed);
    })
    .unwrap();
    until("the driver is not active", || {
        states.call_until_answered(&GetStateRequest::default(), PATIENCE).unwrap().current_state.id
            == ACTIVE
    });
    assert!(!faulted.load(Ordering::Relaxed));

    // The pipe is full, and both threads have something to say.
    let flags = fcntl_getfl(&filling).unwrap();
    fcntl_setfl(&filling, flags | OFlags::NONBLOCK).unwrap();
    while filling.write(&[b'\n'; 4096]).is_ok() || filling.write(b"\n").is_ok() {}
    fcntl_setfl(&filling, flags).unwrap();
    let volts = node
        .publisher_on::<Cut>(topics::MOTOR_VOLTAGE.name_in_namespace(), topics::MOTOR_VOLTAGE.qos)
        .unwrap();
    let requests = node.client::<CutRequest>("/rig_driver/change_state").unwrap();
    for _ in 0..20 {
        for _ in 0..20 {
            let _ = volts.publish(Cut(1));
        }
        // Nobody answers it.
        let _ = requests.call(Cut(1), Duration::from_millis(100));
    }
    let began = Instant::now();
    let answer = stop
        .call_until_answered(&TriggerRequest::default(), PATIENCE)
        .expect("the stop is answered");
    assert!(answer.success, "{}", answer.message);
    eprintln!("blocked: the stop was answered after {:?}", began.elapsed());
    until("the stop is not executed", || faulted.load(Ordering::Relaxed));

    let began = Instant::now();
    kill_process(Pid::from_child(&driver), Signal::INT).unwrap();
    until("the driver does not end", || driver.try_wait().unwrap().is_some());
    let (status, took) = (driver.wait().unwrap(), began.elapsed());
    eprintln!("blocked: ended after {took:?}, {status}");
    assert!(
        status.success() || status.code() == Some(i32::from(ros_node::FORCED)),
        "in order or by force, but by itself: {status}"
    );
    // What forced exits need, and a busy machine.
    assert!(took < ros_node::ENDS_WITHIN + Duration::from_secs(10), "{took:?}");
}
