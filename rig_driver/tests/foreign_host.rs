//! Another machine on the network, with everything that it needs to know: it neither commands nor
//! hears who keeps to this machine.

use std::net::UdpSocket;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use msgs::friction_msgs::MotorVoltage;
use msgs::lifecycle_msgs::{
    ChangeState, ChangeStateRequest, GetState, GetStateRequest, Transition,
};
use msgs::std_msgs::Header;
use msgs::topics;
use ros_node::{Discovery, Participant, Range};
use rustix::process::{Pid, Signal, kill_process};
use tests::network::{ORDINARY_MTU, run_ignored, two_machines};
use tests::wire::{Catch, Packet, keep, kept};

const DOMAIN: u16 = 76;
const PATIENCE: Duration = Duration::from_secs(60);
const UNCONFIGURED: u8 = 1;
const ACTIVE: u8 = 3;
/// Variable of the environment with the file of packets.
const CAUGHT: &str = "CAUGHT";

/// What a participant is called in its packets.
type Prefix = [u8; 12];

/// A rig driver that waits for `configure` and `activate`; killed when it is dropped.
struct Driver {
    child: Child,
    prefix: Prefix,
}

impl Driver {
    /// To be called when nobody else speaks.
    fn start(range: &str) -> Self {
        let catch = Catch::start();
        let child = Command::new(env!("CARGO_BIN_EXE_rig_driver"))
            .args(["--ros-args", "-p", "autostart:=false"])
            .env("ROS_DOMAIN_ID", DOMAIN.to_string())
            .env("ROS_AUTOMATIC_DISCOVERY_RANGE", range)
            .stdin(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the driver starts");
        let prefix = prefix(&catch.first());
        drop(catch.end());
        Self { child, prefix }
    }

    fn end(mut self) {
        let _ = kill_process(Pid::from_child(&self.child), Signal::INT);
        let began = Instant::now();
        while self.child.try_wait().expect("it is ours").is_none() {
            assert!(began.elapsed() < PATIENCE, "the driver does not end");
            thread::sleep(Duration::from_millis(10));
        }
    }
}

impl Drop for Driver {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn prefix(packet: &Packet) -> Prefix {
    packet.bytes[8..20].try_into().expect("twelve bytes")
}

/// State of the driver, asked for from this machine.
fn state(range: Range) -> u8 {
    let participant =
        Participant::join(&Discovery { domain: DOMAIN, range }).expect("a participant");
    let node = participant.node("asking").expect("a node");
    let client = node.client::<GetState>("/rig_driver/get_state").expect("a client");
    client
        .call_until_answered(&GetStateRequest::default(), PATIENCE)
        .expect("an answer")
        .current_state
        .id
}

/// Configures, activates and drives the driver.
fn drive(range: Range) {
    let participant =
        Participant::join(&Discovery { domain: DOMAIN, range }).expect("a participant");
    let node = participant.node("driving").expect("a node");
    let client = node.client::<ChangeState>("/rig_driver/change_state").expect("a client");
    let states = node.client::<GetState>("/rig_driver/get_state").expect("a client");
    let volts = node.publisher(&topics::MOTOR_VOLTAGE).expect("a publisher");
    let state = || {
        states
            .call_until_answered(&GetStateRequest::default(), PATIENCE)
            .expect("an answer")
            .current_state
            .id
    };
    assert_eq!(state(), UNCONFIGURED);
    for id in [Transition::TRANSITION_CONFIGURE, Transition::TRANSITION_ACTIVATE] {
        let request = ChangeStateRequest { transition: Transition { id, ..Transition::default() } };
        assert!(client.call(request, PATIENCE).expect("an answer").success);
    }
    assert_eq!(state(), ACTIVE);
    for _ in 0..100 {
        volts.publish(MotorVoltage { header: Header::default(), voltage: 1.0 }).expect("a command");
        thread::sleep(Duration::from_millis(5));
    }
}

/// Sends what was caught from the other machine, as if it were said to `to` instead of `said_to`,
/// and waits until all is sent.
fn replay_from_there(packets: &[Packet], said_to: Prefix, to: Prefix) {
    let mut packets = packets.to_vec();
    for packet in &mut packets {
        for at in 0..packet.bytes.len().saturating_sub(11) {
            if packet.bytes[at..at + 12] == said_to {
                packet.bytes[at..at + 12].copy_from_slice(&to);
            }
        }
    }
    keep(&packets, Path::new(&std::env::var_os(CAUGHT).expect("a file")));
    let other = std::env::var("OTHER_MACHINE").expect("another machine");
    let mut command = Command::new("nsenter");
    command.args(["-t", &other, "-n"]);
    run_ignored(command, "replay", &[]);
}

#[tests::needs(machines)]
#[test]
fn packets_recorded_here_and_sent_from_another_machine_are_obeyed_by_nobody_who_keeps_to_this_machine()
 {
    let command = two_machines(ORDINARY_MTU);
    let folder = tempfile::tempdir().unwrap();
    let told =
        run_ignored(command, "attack", &[(CAUGHT, folder.path().join("caught").as_os_str())]);
    for line in told.lines().filter(|line| line.starts_with("foreign host:")) {
        eprintln!("{line}");
    }
}

#[test]
#[ignore = "needs two machines: run by the test above"]
fn attack() {
    // What a client on this machine says: it configures, activates and drives.
    let driver = Driver::start("LOCALHOST");
    let catch = Catch::start();
    drive(Range::Localhost);
    let said_to = driver.prefix;
    driver.end();
    let packets = catch.end();
    eprintln!("foreign host: {} packets caught", packets.len());
    assert!(packets.len() > 100, "{}", packets.len());
    let strangers: Vec<_> = packets.iter().filter(|packet| packet.from[0] != 127).collect();
    assert!(
        strangers.is_empty(),
        "a program that keeps to this machine sends to the network: {strangers:?}"
    );
    // The driver's own words are left out.
    let spoken: Vec<_> = packets.into_iter().filter(|packet| prefix(packet) != said_to).collect();

    // The same words from the other machine.
    let driver = Driver::start("LOCALHOST");
    assert_eq!(state(Range::Localhost), UNCONFIGURED);
    let catch = Catch::start();
    replay_from_there(&spoken, said_to, driver.prefix);
    assert_eq!(state(Range::Localhost), UNCONFIGURED, "another machine has commanded the driver");
    let packets = catch.end();
    let came = packets.iter().filter(|packet| packet.from == [192, 0, 2, 2]).count();
    let answered = packets.iter().filter(|packet| packet.to == [192, 0, 2, 2]).count();
    eprintln!("foreign host: {came} packets came from the other machine, {answered} answered");
    assert!(came > 100 && answered == 0, "{came} {answered}");
    driver.end();

    // And they would have been obeyed.
    let driver = Driver::start("SUBNET");
    assert_eq!(state(Range::Subnet), UNCONFIGURED);
    replay_from_there(&spoken, said_to, driver.prefix);
    let began = Instant::now();
    while state(Range::Subnet) == UNCONFIGURED {
        assert!(
            began.elapsed() < PATIENCE,
            "the recording commands nobody: this test shows nothing"
        );
        replay_from_there(&spoken, said_to, driver.prefix);
    }
    driver.end();
}

#[test]
#[ignore = "runs on the other machine: run by the test above"]
fn replay() {
    let packets = kept(Path::new(&std::env::var_os(CAUGHT).unwrap()));
    let socket = UdpSocket::bind("192.0.2.2:0").unwrap();
    for pair in packets.windows(2) {
        let (packet, next) = (&pair[0], &pair[1]);
        let to = if packet.to[0] < 224 { [192, 0, 2, 1] } else { packet.to };
        // A port on which nobody listens is told, and is no reason to stop.
        let _ = socket.send_to(&packet.bytes, (std::net::Ipv4Addr::from(to), packet.port));
        thread::sleep((next.at - packet.at).min(Duration::from_millis(2)));
    }
}
