//! The serial rig against the emulator, over a real pseudo-terminal.

mod bench;

use std::path::Path;

use bench::{Bench, cycle, drive_until_trouble, patient};
use friction_model::{AnyModel, ModelName};
use rig_driver::{
    Rig, RigError, SimulationOptions,
    safety::{Request, SafetyLimits, Supervised},
    serial::{Cause, SerialError, SerialOptions, SerialRig, State},
};

/// What was on the motor in each cycle, given to the same rig without any line, turns its shaft in
/// the same way to the last count.
#[test]
fn the_rig_behind_the_line_is_the_simulated_rig() {
    const CYCLES: usize = 300;
    let mut compared = 0;
    // A machine that is busy loses cycles; what the motor had in those is not known.
    for _ in 0..20 {
        let bench = Bench::start_patient(&["--period", "2000"]);
        let mut rig = bench.open();
        assert_eq!(rig.period(), 0.002);
        rig.activate().unwrap();
        let seen: Vec<_> = (0..CYCLES)
            .map(|k| cycle(&mut rig, 4.0 * (0.05 * k as f64).sin()).expect("a cycle"))
            .collect();
        drop(rig);
        let books = bench.finish();
        assert!(books["books"]["commands"].as_u64().unwrap() > 0, "{books}");
        let options = SimulationOptions { period: 0.002, ..Default::default() };
        let mut alone = options.build(AnyModel::test_bed(ModelName::Proposed)).unwrap();
        let in_turn = seen.windows(2).take_while(|pair| pair[1].cycle == pair[0].cycle + 1);
        let known = in_turn.count();
        for pair in seen[..known + 1].windows(2) {
            // The voltage before the second measurement.
            assert_eq!(alone.measure().encoder_counts, pair[0].encoder_counts);
            alone.apply(pair[1].voltage_applied).unwrap();
        }
        compared += known;
        if known + 1 < CYCLES {
            continue;
        }
        let travel = seen.iter().map(|seen| seen.encoder_position).fold(0.0, f64::max);
        assert!(travel > 0.2, "the shaft turned by {travel} rad only");
        let torque = seen.iter().map(|seen| seen.torque).fold(0.0, f64::max);
        assert!((0.05..0.4).contains(&torque), "{torque} N m of friction");
        assert!((seen[CYCLES - 1].time - 0.002 * (CYCLES - 1) as f64).abs() < 1e-9);
        return;
    }
    println!(
        "a busy machine: {compared} cycles in turn were compared, and no run came through whole"
    );
    assert!(compared > 0);
}

#[test]
fn a_command_is_on_the_motor_one_cycle_after_the_measurement_it_answers() {
    let bench = Bench::start_patient(&["--period", "5000"]);
    let mut rig = bench.open();
    rig.activate().unwrap();
    let mut asked = Vec::new();
    for k in 0..60u32 {
        let volts = f64::from(k) * 0.05;
        let seen = cycle(&mut rig, volts).unwrap();
        // In the measurement of cycle k stands what was on the motor from k-1 to k: what answered
        // k-2.
        asked.push((seen.cycle, volts, seen.voltage_applied));
    }
    let near = |volts: f64, applied: f64| (applied - volts).abs() <= 0.5 * 20.0 / 4096.0 + 1e-9;
    let mut right = 0;
    for (place, &(cycle, _, applied)) in asked.iter().enumerate().skip(2) {
        // A host that is late answers cycles later: then an older voltage is on the motor, never a
        // newer one.
        let (told, in_turn) = (&asked[..place - 1], asked[place - 2].0 + 2 == cycle);
        assert!(near(0.0, applied) || told.iter().any(|told| near(told.1, applied)), "{asked:?}");
        right += usize::from(in_turn && near(asked[place - 2].1, applied));
    }
    println!("{right} of {} right after two cycles", asked.len() - 2);
    assert!(right > 0);
    drop(rig);
    bench.finish();
}

#[test]
fn a_rig_without_sensors_says_so_and_takes_its_velocity_from_the_encoder() {
    let without = ["--without", "tachometer", "--without", "torque", "--without", "current"];
    let bench = Bench::start_patient(&without);
    let mut rig = bench.open();
    let channels = rig.hello().channels;
    assert!(
        channels.potentiometer && !channels.tachometer && !channels.torque && !channels.current
    );
    rig.activate().unwrap();
    let seen = (0..400).map(|_| cycle(&mut rig, 3.0).unwrap()).last().unwrap();
    assert_eq!((seen.motor_current, seen.torque), (None, 0.0));
    // K (u - 4.84 F), as every model settles: about 4.4 rad/s; the encoder's step over ten cycles
    // is .15 rad/s.
    assert!((2.0..6.0).contains(&seen.tachometer_velocity), "{} rad/s", seen.tachometer_velocity);
    drop(rig);
    bench.finish();
}

#[test]
fn a_device_of_another_version_is_refused_with_a_sentence() {
    for (theirs, remedy) in [("1", "build its firmware anew"), ("3", "update this program")] {
        let bench = Bench::start(&["--speak-version", theirs]);
        let error = SerialRig::open(bench.path(), patient()).unwrap_err();
        assert!(matches!(error, SerialError::WrongVersion { .. }), "{error}");
        let said = error.to_string();
        assert!(
            said.contains(&format!("speaks version {theirs}")) && said.contains("version 2"),
            "{said}"
        );
        assert!(said.contains(remedy), "{said}");
        let status = bench.finish();
        assert_eq!(status["books"]["sessions"], 0, "{status}");
    }
}

/// The shortest period that a device may have: 100 us, which once was 99.99999999999999 us.
#[test]
fn a_device_with_a_period_of_100_us_is_driven() {
    let bench = Bench::start(&["--period", "100"]);
    let rig = bench.open();
    assert_eq!(rig.period(), 1e-4);
    let limits = rig_driver::serial::limits(rig.hello());
    let mut rig = Supervised::new(rig, limits).expect("limits that fit");
    rig.request(Request::Configure).unwrap();
    rig.request(Request::Activate).unwrap();
    drop(rig);
    bench.finish();
}

#[test]
fn ports_that_cannot_be_used_are_told_apart() {
    let bench = Bench::start(&[]);
    let open = |path: &Path, answer| SerialRig::open(path, SerialOptions { answer, ..patient() });
    let error = open(Path::new("/dev/no-such-port"), 1.0).unwrap_err();
    assert!(matches!(error, SerialError::Open { .. }), "{error}");
    let file = tempfile::NamedTempFile::new().unwrap();
    let error = open(file.path(), 1.0).unwrap_err();
    assert!(matches!(error, SerialError::NotATerminal { .. }), "{error}");
    let first = bench.open();
    let error = open(bench.path(), 1.0).unwrap_err();
    assert!(matches!(error, SerialError::Busy { .. }), "{error}");
    drop(first);
    drop(bench.open());
    let wrong = SerialOptions { validity: 2.0, ..patient() };
    let error = SerialRig::open(bench.path(), wrong).unwrap_err();
    assert!(error.to_string().starts_with("validity must be from 0.001 to 1 s"), "{error}");
    bench.finish();
}

#[test]
fn a_device_that_does_not_answer_and_one_that_talks_nonsense_are_told_apart() {
    let mut bench = Bench::start(&[]);
    bench.order("hang 1000000");
    bench.order("lose 1000000 from-device");
    bench.status();
    let short = SerialOptions { answer: 0.3, ..patient() };
    let error = SerialRig::open(bench.path(), short).unwrap_err();
    assert!(matches!(error, SerialError::NoAnswer { .. }), "{error}");
    bench.finish();
    let bench = Bench::start(&["--corrupt", "1"]);
    let error = SerialRig::open(bench.path(), short).unwrap_err();
    let garbage = matches!(error, SerialError::Garbage { .. } | SerialError::NoAnswer { .. });
    assert!(garbage, "{error}");
    bench.finish();
}

#[test]
fn without_activation_the_motor_does_not_move() {
    let mut bench = Bench::start(&[]);
    let mut rig = bench.open();
    for _ in 0..20 {
        assert!(cycle(&mut rig, 0.0).is_ok());
        let error = rig.apply(2.0).unwrap_err();
        let RigError::Serial(SerialError::NotActive { state: State::Inactive, .. }) = error else {
            panic!("{error}")
        };
    }
    assert_eq!(bench.status()["books"]["driven"], 0);
    drop(rig);
    bench.finish();
}

#[test]
fn a_voltage_that_is_not_a_number_holds_the_motor_at_zero_until_cleared() {
    let bench = Bench::start_patient(&[]);
    let mut rig = bench.open();
    rig.activate().unwrap();
    cycle(&mut rig, 2.0).unwrap();
    rig.wait().unwrap();
    assert!(matches!(rig.apply(f64::NAN), Err(RigError::VoltageNotFinite(_))));
    for _ in 0..30 {
        assert!(cycle(&mut rig, 5.0).unwrap().fault);
    }
    let held = cycle(&mut rig, 5.0).unwrap();
    assert_eq!(held.voltage_applied, 0.0);
    rig.clear().unwrap();
    rig.activate().unwrap();
    // On a busy machine measurements from before the clearing may still be on their way.
    let mut cycles = (0..2000).map(|_| cycle(&mut rig, 2.0).unwrap());
    assert!(cycles.any(|moving| !moving.fault && moving.voltage_applied > 1.9));
    drop(rig);
    bench.finish();
}

#[test]
fn an_emergency_stop_latches_in_the_device_until_cleared() {
    let mut bench = Bench::start(&[]);
    let mut rig = bench.open();
    rig.activate().unwrap();
    cycle(&mut rig, 2.0).unwrap();
    rig.emergency_stop().unwrap();
    let stopped = |error: SerialError| {
        assert!(
            matches!(
                error,
                SerialError::NotActive {
                    state: State::EmergencyStopped,
                    cause: Cause::EmergencyStop
                }
            ) || matches!(error, SerialError::NotActive { state: State::Active, .. }),
            "{error}"
        );
    };
    stopped(drive_until_trouble(&mut rig, 2.0));
    bench.pass(5);
    assert!(rig.wait().is_ok() && rig.measure().fault);
    rig.clear().unwrap();
    assert_eq!(rig.state(), Some(State::Inactive));
    rig.activate().unwrap();
    assert!(cycle(&mut rig, 2.0).is_ok());
    // The switch on the device.
    bench.order("stop");
    stopped(drive_until_trouble(&mut rig, 2.0));
    bench.pass(2);
    assert_eq!(rig.last_fault().map(|report| report.cause), Some(Cause::EmergencyStop));
    bench.order("release");
    bench.pass(2);
    rig.clear().unwrap();
    rig.activate().unwrap();
    drop(rig);
    // Its last words are on the line; the device reads them in its next cycle.
    bench.pass(5);
    let status = bench.finish();
    assert_eq!(status["state"], "inactive", "a host that leaves deactivates");
}

/// Under the safety layer too, what the device stopped the motor for is told in the device's words,
/// and it is no matter of the line.
#[test]
fn the_safety_layer_names_what_the_device_stopped_the_motor_for() {
    for (order, words) in [("stop", "the emergency stop"), ("fault", "the motor's driver stage")] {
        let mut bench = Bench::start(&[]);
        let rig = bench.open();
        // A busy machine may be late.
        let limits = rig_driver::serial::limits(rig.hello());
        let limits = SafetyLimits { cycle_lost: 10.0, ..limits };
        let mut rig = Supervised::activated(rig, limits).unwrap();
        let mut drive = || {
            rig.wait()?;
            rig.measure();
            rig.apply(1.0)
        };
        (0..20).for_each(|_| drive().unwrap());
        bench.order(order);
        let error = (0..100_000).find_map(|_| drive().err()).unwrap();
        assert!(error.to_string().contains(words), "{order}: {error}");
        assert!(!error.is_of_the_line(), "{error:?}");
        drop(rig);
        bench.finish();
    }
}
