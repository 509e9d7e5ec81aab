//! Somebody else writes to the line of a rig that is driven: a second process with the same port
//! open. None of its frames moves the motor, the driver notices, and who is the driver's is told
//! from who is not.

mod bench;

use std::{
    fs::{File, OpenOptions},
    io::Write,
};

use bench::{Bench, cycle, patient};
use rig_driver::{
    Rig, RigError,
    safety::{Fault, Request, State, Supervised},
    serial::{self, SerialError, SerialOptions, SerialRig},
};
use rig_protocol::{HostMessage, Message, Origin, Session, VoltageCommand};
use serde_json::Value;

/// A second program on the line.
struct Stranger {
    port: File,
}

impl Stranger {
    fn open(bench: &Bench) -> Self {
        Self {
            port: OpenOptions::new()
                .write(true)
                .open(bench.path())
                .expect("whoever is first or root may open it"),
        }
    }

    fn write(&mut self, bytes: &[u8]) {
        // A zero ends whatever the driver was saying.
        self.port.write_all(&[&[0], bytes].concat()).expect("the line takes it");
    }

    fn say(&mut self, message: &HostMessage) {
        self.write(message.frame().as_bytes());
    }
}

fn count(status: &Value, name: &str) -> u64 {
    status["books"][name].as_u64().unwrap_or_else(|| panic!("{name} in {status}"))
}

fn refusals(status: &Value) -> u64 {
    status["books"]["refusals"]
        .as_object()
        .expect("a table")
        .values()
        .filter_map(Value::as_u64)
        .sum()
}

/// Of a version 1 host, as the earlier PROTOCOL.md had it: an activation and 2.5 V.
const OLD: [&[u8]; 2] = [
    &[0x0b, 1, 4, 0xcd, 0xab, 0x34, 0x12, 0x23, 0xd2, 0x87, 0x96, 0],
    &[4, 1, 2, 7, 1, 1, 3, 0xe8, 3, 1, 1, 4, 0xfe, 0x20, 0x4e, 1, 5, 0x1d, 0x51, 0x12, 0xbf, 0],
];

fn guessed(number: u32) -> Session {
    Session::new(number).expect("not zero")
}

fn command(origin: Origin, answers: u32) -> HostMessage {
    HostMessage::Voltage(VoltageCommand { origin, answers, voltage: 1000, validity_us: 1_000_000 })
}

/// All that a stranger can say without hearing the device: version 1, a session that it guesses,
/// numbers that it guesses.
fn say_everything(stranger: &mut Stranger, cycle: u32) {
    OLD.iter().for_each(|frame| stranger.write(frame));
    for session in [1, 305_441_741, u32::MAX] {
        stranger.say(&HostMessage::Hello { number: guessed(session) });
        for sequence in [1, 2, 1000, u32::MAX] {
            let origin = Origin { session: guessed(session), sequence };
            stranger.say(&HostMessage::Clear(origin));
            stranger.say(&HostMessage::Activate(origin));
            for answers in cycle.saturating_sub(5)..cycle + 5 {
                stranger.say(&command(origin, answers));
            }
        }
    }
}

/// Nobody is there but the stranger, who does not hear what the device answers: it never learns the
/// session that it was granted.
#[test]
fn who_writes_blindly_does_not_move_a_motor_without_a_host() {
    let mut bench = Bench::start(&[]);
    let mut stranger = Stranger::open(&bench);
    for _ in 0..10 {
        let cycle = count(&bench.pass(5), "cycles") as u32;
        say_everything(&mut stranger, cycle);
    }
    let status = bench.pass(50);
    assert_eq!((count(&status, "driven"), count(&status, "activations")), (0, 0), "{status}");
    assert!(
        count(&status, "sessions") > 0 && refusals(&status) > 100,
        "the device heard it: {status}"
    );
    bench.finish();
}

/// The host is there, its rig inactive: the motor stays where it is, the host keeps its session,
/// and says that somebody else writes.
#[test]
fn a_stranger_does_not_move_a_motor_that_rests_and_is_told() {
    let mut bench = Bench::start(&[]);
    let mut rig = bench.open();
    let session = rig.session();
    for _ in 0..20 {
        cycle(&mut rig, 0.0).unwrap();
    }
    let mut stranger = Stranger::open(&bench);
    let now = count(&bench.status(), "cycles") as u32;
    say_everything(&mut stranger, now);
    let found = (0..100_000).find_map(|_| {
        rig.wait().expect("the line is there");
        assert!(rig.measure().voltage_applied == 0.0);
        rig.latched_fault()
    });
    let report = found.expect("it is noticed");
    assert_eq!(report.fault, Fault::ForeignFrames, "{report}");
    assert!(report.to_string().contains("somebody else writes to the line"), "{report}");
    assert_eq!(rig.session(), session, "no hello took the device away");
    let error = rig.activate().unwrap_err();
    assert!(matches!(error, RigError::Safety(_)), "{error}");
    assert_eq!(count(&bench.pass(20), "driven"), 0);
    // With the stranger gone, it goes on.
    drop(stranger);
    rig.clear().unwrap();
    rig.activate().unwrap();
    for _ in 0..20 {
        cycle(&mut rig, 1.0).unwrap();
    }
    assert!(rig.statistics().foreign > 2, "{:?}", rig.statistics());
    drop(rig);
    bench.finish();
}

/// A stranger that does hear the line repeats what the host has said, to the last bit. Everything
/// counts once.
#[test]
fn replayed_frames_are_refused() {
    let mut bench = Bench::start(&[]);
    let mut rig = bench.open();
    let session = rig.session().expect("a session");
    rig.activate().unwrap();
    for _ in 0..50 {
        cycle(&mut rig, 1.0).unwrap();
    }
    rig.deactivate().unwrap();
    for _ in 0..50 {
        cycle(&mut rig, 0.0).unwrap();
    }
    let before = bench.pass(5);
    let mut stranger = Stranger::open(&bench);
    let now = count(&before, "cycles") as u32;
    // Every number that was used; those of activations are among them.
    for sequence in 1..=50 {
        let origin = Origin { session, sequence };
        stranger.say(&HostMessage::Activate(origin));
        stranger.say(&command(origin, now));
    }
    let after = bench.pass(30);
    assert_eq!(
        (count(&after, "driven"), &after["state"]),
        (count(&before, "driven"), &"inactive".into())
    );
    let not_newer = after["books"]["refusals"]["not_newer"].as_u64();
    assert!(not_newer >= Some(50), "{after}");
    drop(rig);
    bench.finish();
}

/// Who reads the line knows session and numbers, and can forge: this protocol does not keep that
/// out. It is noticed at the next measurement, and the device is deactivated.
#[test]
fn a_forged_command_is_noticed_and_the_device_deactivated() {
    let mut bench = Bench::start(&[]);
    let rig = bench.open();
    let session = rig.session().expect("a session");
    let limits = serial::limits(rig.hello());
    let mut rig = Supervised::new(rig, limits).unwrap();
    rig.request(Request::Configure).unwrap();
    rig.wait().unwrap();
    rig.measure();
    rig.request(Request::Activate).unwrap();
    let mut stranger = Stranger::open(&bench);
    let found = (0..100_000u32).find_map(|round| {
        let _ = rig.wait();
        rig.measure();
        let _ = rig.apply(0.0);
        if round % 10 == 9 {
            let now = count(&bench.status(), "cycles") as u32;
            stranger.say(&command(Origin { session, sequence: 30_000 + round }, now));
        }
        rig.latched_fault()
    });
    let report = found.expect("it is noticed");
    // The host's own numbers are old then: that, too, is told. Which comes first depends on when
    // the frame came.
    assert!(matches!(report.fault, Fault::UnknownEcho | Fault::CommandsRefused), "{report}");
    assert_eq!(rig.supervisor().state(), State::Faulted);
    for _ in 0..20 {
        let _ = rig.wait();
        rig.measure();
        let _ = rig.apply(0.0);
    }
    let status = bench.pass(30);
    assert_eq!((&status["state"], &status["voltage"]), (&"inactive".into(), &0.into()), "{status}");
    drop(rig);
}

/// A second driver is kept out by the lock on the port; one that does not look at locks by the
/// device, as long as the first is alive.
#[test]
fn the_device_keeps_to_the_host_that_is_alive_and_is_had_again_when_that_is_gone() {
    let mut bench = Bench::start(&["--host-timeout", "400000"]);
    let mut stranger = Stranger::open(&bench);
    stranger.say(&HostMessage::Hello { number: guessed(77) });
    bench.pass(3);
    // Its session holds the device for the host timeout; then the driver gets it.
    let early = SerialRig::open(bench.path(), SerialOptions { answer: 0.1, ..patient() });
    // A machine that is busy may come to it after the host timeout: then the device is its own.
    let sessions = if early.is_err() { 2 } else { 3 };
    if let Err(error) = early {
        assert!(matches!(error, SerialError::Held { .. }), "{error}");
        assert!(error.to_string().contains("has another host"), "{error}");
    }
    let mut rig = bench.open();
    rig.activate().unwrap();
    cycle(&mut rig, 1.0).unwrap();
    assert_eq!(count(&bench.status(), "sessions"), sessions);
    drop(rig);
    // Closed, it is free at once.
    let again = SerialRig::open(bench.path(), patient()).expect("nobody has it");
    drop(again);
    bench.finish();
}

/// A stop that is asked of the driver reaches the device, latches there, and is acknowledged,
/// though frames are lost.
#[test]
fn an_emergency_stop_of_the_driver_is_latched_in_the_device_though_frames_are_lost() {
    for lost in [0, 3] {
        let mut bench = Bench::start(&[]);
        let rig = bench.open();
        let limits = serial::limits(rig.hello());
        let mut rig = Supervised::new(rig, limits).unwrap();
        rig.request(Request::Configure).unwrap();
        rig.request(Request::Activate).unwrap();
        for _ in 0..20 {
            let _ = rig.wait();
            rig.measure();
            let _ = rig.apply(1.0);
        }
        if lost > 0 {
            bench.order(&format!("lose {lost} from-host"));
            bench.status();
        }
        let outcome = rig.request(Request::EmergencyStop);
        assert!(
            outcome.is_ok()
                || matches!(
                    outcome,
                    Err(RigError::Serial(SerialError::StopNotAcknowledged { .. }))
                )
        );
        assert_eq!(rig.supervisor().state(), State::EmergencyStopped);
        let latched = (0..1000).any(|_| {
            let _ = rig.wait();
            rig.measure();
            let _ = rig.apply(0.0);
            bench.status()["state"] == "emergency_stopped"
        });
        assert!(latched, "{}", bench.status());
        assert_eq!(rig.request(Request::Clear), Ok(State::Unconfigured));
        assert_eq!(bench.status()["state"], "inactive");
        drop(rig);
        bench.finish();
    }
}

/// A device that does not hear the stop is a fault, not a silence.
#[test]
fn a_stop_that_the_device_does_not_acknowledge_is_a_fault() {
    let mut bench = Bench::start(&["--host-timeout", "10000000"]);
    let mut rig = bench.open();
    rig.activate().unwrap();
    cycle(&mut rig, 1.0).unwrap();
    bench.order("lose 1000000 from-host");
    bench.status();
    rig.deactivate().unwrap();
    let found = (0..100_000).find_map(|_| {
        let _ = cycle(&mut rig, 0.0);
        rig.latched_fault()
    });
    let report = found.expect("it is told");
    assert_eq!(report.fault, Fault::StopNotAcknowledged, "{report}");
    // The command's own validity has ended the voltage all the same.
    assert_eq!(bench.status()["voltage"], 0);
    drop(rig);
    bench.finish();
}
