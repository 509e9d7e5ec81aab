//! Setting a rig up: calibration finds what is wrong with a simulated rig's wiring, and with it the
//! rig is right.

use std::sync::atomic::AtomicBool;

use friction_model::{AnyModel, ModelName};
use rig_driver::{Calibration, Miswiring, Sign, SimulationOptions};
use rig_setup::{
    Findings, Procedure, RigChoice, RigSetup, RigSetupError, Session, read_calibration,
    render_calibration, run_procedure,
};

/// Breakaway voltage of the plant: F_s = .0994 N m times 4.8426 V/(N m).
const BREAKAWAY: f64 = 0.4814;

fn set_up(
    wiring: &str,
    calibration: Option<Calibration>,
    seed: u64,
) -> Result<Findings, RigSetupError> {
    let wiring = (!wiring.is_empty()).then(|| wiring.parse::<Miswiring>().unwrap());
    let plant = AnyModel::test_bed(ModelName::Proposed);
    let simulation = SimulationOptions { seed, ..SimulationOptions::default() };
    let setup =
        RigSetup { calibration, simulation, friction: plant, wiring, ..RigSetup::default() };
    let opened = RigChoice::Simulated.open(&setup)?;
    let stop = AtomicBool::new(false);
    run_procedure(&mut Session::new(opened, 2.0, &stop)?, &Procedure::default(), |_| {})
}

fn wrong(found: &Findings) -> Vec<&'static str> {
    found
        .verdicts()
        .into_iter()
        .filter(|verdict| verdict.wrong.is_some())
        .map(|verdict| verdict.what)
        .collect()
}

#[test]
fn a_rig_wired_right_passes_the_check_and_shows_its_breakaway_voltage() {
    let found = set_up("", None, 1).unwrap();
    assert_eq!(wrong(&found), Vec::<&str>::new());
    for deadband in [found.deadband_forward, found.deadband_backward] {
        let off = deadband.value - BREAKAWAY;
        assert!(
            off.abs() < 3.0 * deadband.standard_error && deadband.standard_error < 0.03,
            "{deadband:?}"
        );
    }
}

/// Gain and zeros lie within four standard errors of what the wiring was given, on many seeds, and
/// the errors are small enough to be of use.
#[test]
fn calibration_finds_the_mistakes_that_were_made() {
    for seed in 1..=6 {
        let found = set_up(
            "encoder,tachometer=-0.9,tachometer-zero=0.05,torque,torque-zero=-0.08",
            None,
            seed,
        )
        .unwrap();
        assert_eq!((found.encoder_sign, found.torque_sign), (Sign::Reversed, Some(Sign::Reversed)));
        let gain = found.tachometer_gain.unwrap();
        for (what, value, truth, useful) in [
            ("gain", gain, -1.0 / 0.9, 0.01),
            ("tachometer zero", found.tachometer_zero, 0.05, 1e-3),
            ("torque zero", found.torque_zero, -0.08, 1e-3),
        ] {
            let off = (value.value - truth).abs();
            assert!(
                off < 4.0 * value.standard_error,
                "{what}, seed {seed}: {value:?}, not {truth}"
            );
            assert!(value.standard_error < useful, "{what}: {value:?}");
        }
        assert_eq!(
            wrong(&found),
            ["encoder sign", "tachometer gain", "tachometer zero", "torque sign", "torque zero"]
        );
    }
}

#[test]
fn with_the_file_that_calibration_writes_the_same_rig_passes_the_check() {
    for wiring in [
        "encoder,tachometer=0.9,torque-zero=0.05",
        "motor",
        "tachometer=-1.3,tachometer-zero=-0.2,torque",
    ] {
        let found = set_up(wiring, None, 3).unwrap();
        assert!(!wrong(&found).is_empty(), "{wiring}");
        let file = render_calibration(&found, &RigChoice::Simulated);
        let calibration = read_calibration(&file).unwrap();
        assert_eq!(calibration, found.calibration(), "{file}");
        let after = set_up(wiring, Some(calibration), 4).unwrap();
        assert_eq!(wrong(&after), Vec::<&str>::new(), "{wiring}: {:?}", after.verdicts());
    }
}

#[test]
fn swapped_leads_of_the_motor_are_told_from_swapped_sensors() {
    let said = |wiring: &str| {
        let verdicts = set_up(wiring, None, 1).unwrap().verdicts();
        verdicts.into_iter().find(|verdict| verdict.what == "encoder sign").unwrap().wrong.unwrap()
    };
    assert!(said("motor").contains("motor's leads"));
    assert!(!said("encoder").contains("motor's leads"));
}

#[test]
fn plugs_that_are_out_are_named() {
    let error = set_up("encoder-unplugged", None, 1).unwrap_err();
    // The tachometer tells before the ramp has gone far beyond breakaway.
    assert!(
        matches!(error, RigSetupError::EncoderStands { volts, .. } if volts < 2.0 * BREAKAWAY),
        "{error}"
    );
    let error = set_up("encoder-unplugged,tachometer-unplugged", None, 1).unwrap_err();
    assert!(
        matches!(error, RigSetupError::DoesNotMove { direction: "forwards", travelled: 0, .. }),
        "{error}"
    );
    let found = set_up("tachometer-unplugged", None, 1).unwrap();
    assert_eq!(found.tachometer_gain, None);
    assert_eq!(wrong(&found), ["tachometer gain"]);
}

#[test]
fn a_session_stops_when_it_is_told_to_and_refuses_voltages_above_the_rigs() {
    let open = || {
        let friction = AnyModel::test_bed(ModelName::LuGre);
        RigChoice::Simulated.open(&RigSetup { friction, ..RigSetup::default() }).unwrap()
    };
    let stop = AtomicBool::new(true);
    let mut session = Session::new(open(), 2.0, &stop).unwrap();
    assert_eq!(session.step(|_| 1.0).unwrap_err(), RigSetupError::Stopped);
    for volts in [0.0, 7.0, f64::NAN] {
        let text = Session::new(open(), volts, &stop).map(drop).unwrap_err().to_string();
        assert!(text.contains("max_volts"), "{text}");
    }
}

#[test]
fn a_calibration_file_with_a_mistake_says_where() {
    for (text, said) in [
        ("a: 1", "ros__parameters"),
        ("/controller:\n  ros__parameters:\n    a: 1\n", "rig_driver"),
        ("/rig_driver:\n  ros__parameters:\n    a: 1\n", "there is no parameter `a`"),
        ("/rig_driver:\n  ros__parameters:\n    rig: simulated\n", "calibration"),
        (
            "/rig_driver:\n  ros__parameters:\n    calibration: {encoder_sign: 2, tachometer_gain: 1.0, tachometer_zero: 0.0, torque_sign: 1, torque_zero: 0.0, \
             deadband_forward: 0.0, deadband_backward: 0.0}\n",
            "1 or -1",
        ),
        (
            "/rig_driver:\n  ros__parameters:\n    calibration: {encoder_sign: 1, tachometer_gain: 0.0, tachometer_zero: 0.0, torque_sign: 1, torque_zero: 0.0, \
             deadband_forward: 0.0, deadband_backward: 0.0}\n",
            "tachometer_gain",
        ),
    ] {
        let message = read_calibration(text).unwrap_err().to_string();
        assert!(message.contains(said), "{text}: {message}");
    }
}
