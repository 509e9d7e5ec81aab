//! The driving process is killed and stopped at random moments, and the motor stands still in time,
//! by the device's own count.

mod bench;

use std::{
    env,
    process::{Child, Command, Stdio},
    time::Duration,
};

use bench::{Bench, assert_safe, patient};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rig_driver::{Rig, serial::SerialRig};
use rustix::process::{Pid, Signal, kill_process};

/// Names the port for the process that drives.
const PORT: &str = "RIG_EMULATOR_TEST_PORT";

/// Not a test by itself: what the other one starts, stops and kills. It drives with 3 V until
/// something goes wrong.
#[test]
#[ignore = "stopped and killed: run by the other one"]
fn the_driving_process() {
    let port = env::var_os(PORT).expect("a port");
    let mut rig = SerialRig::open(port.as_ref(), patient()).expect("the port opens");
    rig.activate().expect("it activates");
    // Nobody activates it again.
    while rig.wait().is_ok() && rig.apply(3.0).is_ok() {}
}

fn start(bench: &Bench) -> Child {
    Command::new(env::current_exe().expect("the test's own file"))
        .args(["--ignored", "--exact", "the_driving_process"])
        .env(PORT, bench.path())
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the driving process starts")
}

fn signal(child: &Child, signal: Signal) {
    let pid = i32::try_from(child.id()).ok().and_then(Pid::from_raw).expect("a process id");
    kill_process(pid, signal).expect("the signal arrives");
}

fn number(status: &serde_json::Value, name: &str) -> u64 {
    status["books"][name].as_u64().expect("a number")
}

#[test]
fn a_driver_that_is_killed_or_stopped_leaves_the_motor_at_zero_volts_within_the_validity() {
    let rounds = if env::var_os("FRICTION_FULL").is_some() { 200 } else { 10 };
    let mut random = Pcg64Mcg::seed_from_u64(20_171_101);
    let mut bench = Bench::start(&[]);
    let limit = bench.status()["validity_limit_cycles"].as_u64().expect("a number");
    let timeout = 250;
    let (mut stops, mut given_up) = (0, 0);
    for round in 0..rounds {
        let before = number(&bench.status(), "driven");
        let mut child = start(&bench);
        // It drives. Where it is given no processor for too long it gives up, and is started again.
        while number(&bench.status(), "driven") < before + 5 {
            if child.try_wait().expect("a state").is_some() {
                given_up += 1;
                assert!(given_up <= rounds, "round {round}: the drivers end by themselves");
                let status = bench.pass(limit + 1);
                assert_eq!(status["voltage"], 0, "round {round}: the driver ended by itself");
                assert_safe(&status);
                child = start(&bench);
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_micros(random.random_range(0..60_000)));
        if random.random::<bool>() {
            stops += 1;
            signal(&child, Signal::STOP);
            let stopped_for = random.random_range(limit + 2..2 * timeout);
            let status = bench.pass(stopped_for);
            assert_eq!(status["voltage"], 0, "round {round}: {stopped_for} cycles after SIGSTOP");
            assert_safe(&status);
            let lost = stopped_for > timeout;
            assert!(!lost || status["state"] == "inactive", "round {round}: {status}");
            let activations = number(&status, "activations");
            signal(&child, Signal::CONT);
            let status = bench.pass(limit + 20);
            assert_safe(&status);
            // After the host's time the motor stays where it is: nobody activated it again.
            if lost {
                assert_eq!(status["voltage"], 0, "round {round}: after SIGCONT");
                assert_eq!(number(&status, "activations"), activations);
            }
        }
        signal(&child, Signal::KILL);
        child.wait().expect("it ends");
        let status = bench.pass(limit + 1);
        assert_eq!(status["voltage"], 0, "round {round}: {limit} cycles and one after SIGKILL");
        assert_safe(&status);
    }
    assert!(0 < stops && stops < rounds);
    let status = bench.finish();
    let (after, within) = (number(&status, "longest_drive_after_a_command"), limit);
    println!(
        "{rounds} rounds, {stops} of them stopped, {given_up} drivers that ended by themselves: at most {after} cycles with volts after a command; limit {within}"
    );
    assert!(after > 0);
}
