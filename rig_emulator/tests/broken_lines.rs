//! Lines and devices that fail.

mod bench;

use bench::{Bench, cycle, drive_until_trouble, patient, wait_for_line};
use rig_driver::{
    Rig, RigError,
    serial::{Cause, SerialError, SerialOptions, SerialRig, State},
};
use serde_json::Value;

fn count(status: &Value, part: &str, name: &str) -> u64 {
    status[part][name].as_u64().unwrap_or_else(|| panic!("{part}.{name} in {status}"))
}

/// Drives `cycles` cycles.
fn drive(rig: &mut SerialRig, cycles: usize, volts: f64) {
    for _ in 0..cycles {
        cycle(rig, volts).unwrap();
    }
}

#[test]
fn lost_frames_are_counted_and_the_loop_goes_on() {
    let mut bench = Bench::start(&[]);
    let mut rig = bench.open();
    rig.activate().unwrap();
    drive(&mut rig, 20, 2.0);
    let before = rig.statistics().gaps;
    bench.order("lose 7 from-device");
    bench.order("lose 5 from-host");
    bench.pass(20);
    drive(&mut rig, 50, 2.0);
    let after = rig.statistics();
    assert!(after.gaps >= before + 7, "{after:?}");
    drop(rig);
    let status = bench.finish();
    assert_eq!(
        (count(&status, "from_device", "lost"), count(&status, "from_host", "lost")),
        (7, 5)
    );
}

#[test]
fn frames_that_come_twice_are_used_once() {
    let mut bench = Bench::start(&[]);
    let mut rig = bench.open();
    rig.activate().unwrap();
    bench.order("duplicate 20");
    drive(&mut rig, 100, 2.0);
    let statistics = rig.statistics();
    assert!(statistics.repeated >= 15, "{statistics:?}");
    drop(rig);
    let status = bench.finish();
    assert!(status["books"]["refusals"]["not_newer"].as_u64().unwrap() >= 10, "{status}");
}

#[test]
fn corrupted_and_split_frames_and_garbage_are_survived_in_both_directions() {
    let mut bench = Bench::start(&[]);
    let mut rig = bench.open();
    rig.activate().unwrap();
    drive(&mut rig, 20, 2.0);
    for order in ["corrupt 20", "garbage 500", "split 20", "garbage 37"] {
        bench.order(order);
        drive(&mut rig, 60, 2.0);
    }
    let statistics = rig.statistics();
    assert!(statistics.rejections.crc + statistics.rejections.framing >= 15, "{statistics:?}");
    let moving = cycle(&mut rig, 2.0).unwrap();
    assert!(moving.encoder_counts > 0);
    drop(rig);
    let status = bench.finish();
    let rejected =
        status["rejected"].as_object().unwrap().values().filter_map(Value::as_u64).sum::<u64>();
    assert!(rejected >= 15, "{status}");
}

/// A command that comes later than its validity is refused: its measurement is too old.
#[test]
fn late_commands_do_not_move_the_motor() {
    let mut bench = Bench::start(&["--host-timeout", "10000000"]);
    let mut rig = bench.open();
    rig.activate().unwrap();
    drive(&mut rig, 20, 2.0);
    bench.order("delay 200 40 from-host");
    drive(&mut rig, 30, 2.0);
    let during = bench.pass(30);
    assert_eq!(during["voltage"], 0, "{during}");
    drive(&mut rig, 300, 2.0);
    drop(rig);
    let status = bench.finish();
    assert!(status["books"]["refusals"]["stale"].as_u64().unwrap() >= 20, "{status}");
    assert!(count(&status, "books", "expired") >= 10, "{status}");
}

/// Everything at once, by chance.
#[test]
fn a_line_on_which_a_quarter_of_all_frames_go_wrong_still_drives_safely() {
    for seed in ["1", "2", "3"] {
        let part = |name| [name, "0.05"];
        let mut arguments = vec!["--seed", seed];
        for name in ["--lose", "--duplicate", "--corrupt", "--delay", "--split"] {
            arguments.extend(part(name));
        }
        let bench = Bench::start(&arguments);
        let mut rig = bench.open();
        rig.activate().unwrap();
        drive(&mut rig, 600, 2.0);
        let statistics = rig.statistics();
        assert!(statistics.gaps > 0 && statistics.repeated > 0, "{statistics:?}");
        assert!(statistics.rejections.total() > 0, "{statistics:?}");
        let travelled = cycle(&mut rig, 0.0).unwrap().encoder_position;
        assert!(travelled > 0.1, "{travelled} rad");
        drop(rig);
        bench.finish();
    }
}

#[test]
fn a_device_that_restarts_stays_at_zero_volts_until_activated_again() {
    let mut bench = Bench::start(&[]);
    let mut rig = bench.open();
    rig.activate().unwrap();
    drive(&mut rig, 50, 2.0);
    bench.order("reboot 30");
    let error = drive_until_trouble(&mut rig, 2.0);
    assert!(matches!(error, SerialError::Restarted { .. }), "{error}");
    let seen = wait_for_line(&mut rig);
    assert_eq!(seen.voltage_applied, 0.0);
    assert!(matches!(rig.apply(2.0), Err(RigError::Serial(SerialError::NotActive { .. }))));
    assert_eq!(bench.pass(50)["voltage"], 0);
    rig.activate().unwrap();
    drive(&mut rig, 50, 2.0);
    assert_eq!(rig.statistics().restarts, 1);
    drop(rig);
    let status = bench.finish();
    assert_eq!(count(&status, "books", "reboots"), 1);
}

#[test]
fn a_cable_that_was_pulled_and_put_back_leaves_the_motor_at_zero_volts_until_activated_again() {
    // Shorter and longer than the device waits for its host.
    for cycles in [60, 600] {
        let mut bench = Bench::start(&[]);
        let mut rig = bench.open();
        rig.activate().unwrap();
        drive(&mut rig, 50, 2.0);
        let before = rig.measure();
        bench.order(&format!("unplug {cycles}"));
        let error = drive_until_trouble(&mut rig, 2.0);
        assert!(matches!(error, SerialError::Disconnected { .. }), "{error}");
        assert!(error.to_string().contains("until activated again"));
        let error = loop {
            let after = wait_for_line(&mut rig);
            assert!(after.time > before.time && after.cycle > before.cycle, "time goes on");
            match rig.apply(2.0).unwrap_err() {
                // The last of the old line may be seen late.
                RigError::Serial(SerialError::Disconnected { .. }) => {}
                error => break error,
            }
        };
        assert!(matches!(error, RigError::Serial(SerialError::NotActive { .. })), "{error}");
        let status = bench.pass(30);
        assert_eq!((&status["voltage"], &status["state"]), (&0.into(), &"inactive".into()));
        rig.activate().unwrap();
        drive(&mut rig, 50, 2.0);
        assert!(rig.statistics().reconnects >= 1);
        drop(rig);
        bench.finish();
    }
}

#[test]
fn a_device_that_goes_silent_with_the_port_open_is_an_error() {
    let mut bench = Bench::start(&[]);
    let options = SerialOptions { silence: 0.2, ..patient() };
    let mut rig = SerialRig::open(bench.path(), options).unwrap();
    rig.activate().unwrap();
    cycle(&mut rig, 2.0).unwrap();
    bench.order("hang 2000");
    let error = drive_until_trouble(&mut rig, 2.0);
    assert!(matches!(error, SerialError::Silent { milliseconds: 200, .. }), "{error}");
    drop(rig);
    bench.finish();
}

#[test]
fn a_fault_of_the_driver_stage_is_reported_and_latched() {
    let mut bench = Bench::start(&[]);
    let mut rig = bench.open();
    rig.activate().unwrap();
    drive(&mut rig, 20, 2.0);
    bench.order("fault");
    let error = drive_until_trouble(&mut rig, 2.0);
    let latched = SerialError::NotActive { state: State::Fault, cause: Cause::DriverStage };
    assert_eq!(error, latched);
    assert!(error.to_string().contains("motor's driver stage"), "{error}");
    assert_eq!(
        rig.last_fault().map(|report| (report.cause, report.state)),
        Some((Cause::DriverStage, State::Fault))
    );
    assert_eq!(rig.activate(), Err(RigError::Serial(latched)));
    drop(rig);
    bench.finish();
}
