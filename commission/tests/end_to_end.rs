//! A commission of the simulated test bed, in lock-step.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use commission::axis::Known;
use commission::bed::Arm;
use commission::dossier::Identity;
use commission::{Asked, CommissionError, Dossier, Outcome, Stage, run};
use experiment_runner::run::Given;
use friction_model::{AnyModel, ModelName, Motor};
use rig_setup::{RigChoice, RigLimits, RigSetup};
use work::progress::Progress;

fn asked(plant: ModelName, seed: u64) -> Asked {
    let mut setup = RigSetup { friction: AnyModel::test_bed(plant), ..RigSetup::default() };
    setup.simulation.seed = seed;
    Asked {
        rig: RigChoice::Simulated,
        setup,
        wanted: "f_c:1%,f_s:3%,v_s:20%".parse().unwrap(),
        travel: None,
        allowed: 600.0,
    }
}

fn begun(asked: &Asked, folder: &Path) -> (Known, Dossier, Identity) {
    let known = commission::run::look(asked).unwrap();
    let identity = commission::run::identity(asked, Some(&known), None);
    let dossier = Dossier::begin(folder, &identity).unwrap();
    (known, dossier, identity)
}

fn go(asked: &Asked, folder: &Path) -> Result<Outcome, CommissionError> {
    let (known, dossier, _) = begun(asked, folder);
    run(asked, &known, &dossier, &Arc::default(), &Progress::new(600.0, true))
}

/// Volts that overcome 1 N m on the simulated rig.
fn volts() -> f64 {
    Motor::SRV02.volts_per_newton_metre()
}

#[test]
fn an_unknown_motor_is_compensated_and_the_intervals_hold_the_truth() {
    let folder = tempfile::tempdir().unwrap();
    let Outcome { found, document } = go(&asked(ModelName::Proposed, 1), folder.path()).unwrap();
    assert!(document.contains("frictionlab-commission"));

    let friction = AnyModel::test_bed(ModelName::Proposed);
    let truth = |name: &str| friction.parameter(name).unwrap();
    let slope = 1.0 / Motor::SRV02.gain() + volts() * truth("f_v");
    let gain = 1.0 / slope;
    let time_constant = Motor::SRV02.time_constant() * gain / Motor::SRV02.gain();
    let curve = &found.chosen.curve;
    for (name, found, truth) in [
        ("gain", found.drive.gain, gain),
        ("time constant", found.drive.time_constant, time_constant),
        ("f_c", curve.f_c, volts() * truth("f_c")),
        ("f_s", curve.f_s, volts() * truth("f_s")),
        ("v_s", curve.v_s, truth("v_s")),
        ("slope", curve.slope, slope),
    ] {
        assert!(found.relative().is_some(), "{name}: {found:?}");
        assert!(found.holds(truth), "{name}: {found:?} does not hold {truth}");
    }
    assert!(found.seconds <= 600.0, "{}", found.seconds);
    assert_eq!(found.control.arm, Arm::Friction);
    let ratio = found.proof.ratio.unwrap();
    assert!(ratio.high.unwrap() < 0.7, "{ratio:?}");

    // What is handed over is read by those who are to use it.
    let text = std::fs::read_to_string(folder.path().join("parameters.yaml")).unwrap();
    Given::default().take("parameters.yaml", &text).unwrap();
    rig_setup::read_calibration(&text).unwrap();
    assert!(folder.path().join("report.html").is_file());
    assert_eq!(Dossier::open(folder.path()).unwrap().0.done(), Stage::ALL);
}

#[test]
fn encoder_and_voltage_alone_do_and_a_reversed_encoder_is_put_right() {
    let folder = tempfile::tempdir().unwrap();
    let mut asked = asked(ModelName::LuGre, 1);
    asked.setup.wiring = Some("encoder,tachometer-unplugged".parse().unwrap());
    let found = go(&asked, folder.path()).unwrap().found;
    assert!(!found.met.tachometer && !found.met.corrected.is_empty(), "{:?}", found.met);
    let friction = AnyModel::test_bed(ModelName::LuGre);
    let curve = &found.chosen.curve;
    for (found, name) in [(curve.f_c, "f_c"), (curve.f_s, "f_s")] {
        let truth = volts() * friction.parameter(name).unwrap();
        assert!(found.holds(truth), "{name}: {found:?} does not hold {truth}");
    }
}

#[test]
fn a_rig_without_a_dip_is_not_given_one() {
    let folder = tempfile::tempdir().unwrap();
    let found = go(&asked(ModelName::CoulombViscous, 1), folder.path()).unwrap().found;
    assert_eq!(found.chosen.kind, commission::model::CurveKind::CoulombViscous);
    let friction = AnyModel::test_bed(ModelName::CoulombViscous);
    let truth = volts() * friction.parameter("f_c").unwrap();
    assert!(found.chosen.curve.f_c.holds(truth), "{:?} {truth}", found.chosen.curve);
}

#[test]
fn a_commission_that_was_stopped_goes_on_and_measures_nothing_twice() {
    let folder = tempfile::tempdir().unwrap();
    let asked = asked(ModelName::LuGre, 2);
    let (known, dossier, _) = begun(&asked, folder.path());
    let short = Asked { allowed: 130.0, ..asked.clone() };
    let progress = Progress::new(600.0, true);
    let stop: Arc<AtomicBool> = Arc::default();
    // The friction stage leaves no time for what is behind it.
    let error = run(&short, &known, &dossier, &stop, &progress).unwrap_err();
    assert!(matches!(error, CommissionError::OutOfTime { .. }), "{error}");
    let done = dossier.done();
    assert!(done.starts_with(&[Stage::Meet, Stage::Drive]) && done.len() < 6, "{done:?}");
    let before = std::fs::read_to_string(folder.path().join("drive.json")).unwrap();

    let outcome = run(&asked, &known, &dossier, &stop, &progress).unwrap();
    assert_eq!(std::fs::read_to_string(folder.path().join("drive.json")).unwrap(), before);
    assert!(outcome.found.seconds > 130.0 && outcome.found.seconds <= 600.0);

    // From a stage on, what is before it stays.
    let friction = std::fs::read_to_string(folder.path().join("friction.json")).unwrap();
    dossier.forget_from(Stage::Control).unwrap();
    run(&Asked { allowed: 900.0, ..asked }, &known, &dossier, &stop, &progress).unwrap();
    assert_eq!(std::fs::read_to_string(folder.path().join("friction.json")).unwrap(), friction);
}

#[test]
fn told_to_stop_it_ends_as_stopped_and_keeps_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    let asked = asked(ModelName::Proposed, 1);
    let (known, dossier, identity) = begun(&asked, folder.path());
    let stop = Arc::new(AtomicBool::new(true));
    let error = run(&asked, &known, &dossier, &stop, &Progress::new(600.0, true)).unwrap_err();
    assert!(error.is_stopped() && !error.is_bad_input(), "{error}");
    assert_eq!(dossier.done(), []);
    assert_eq!(Dossier::open(folder.path()).unwrap().1, identity);
}

#[test]
fn limits_that_contradict_each_other_are_refused_before_anything_moves() {
    let usual = asked(ModelName::Proposed, 1);
    let with = |limits: RigLimits| {
        let setup = RigSetup { limits, ..usual.setup };
        commission::run::look(&Asked { setup, ..usual.clone() }).unwrap_err()
    };
    let travel = rig_driver::safety::Travel { min: 1.0, max: -1.0, margin: 0.0 };
    for (limits, said) in [
        (RigLimits { voltage: Some(0.0), ..RigLimits::default() }, "voltage_limit"),
        (RigLimits { voltage: Some(50.0), ..RigLimits::default() }, "10 V"),
        (RigLimits { velocity: Some(-1.0), ..RigLimits::default() }, "velocity"),
        (
            RigLimits { cycle_late: Some(0.4), command_lost: Some(0.001), ..RigLimits::default() },
            "command_lost",
        ),
        (RigLimits { travel: Some(travel), ..RigLimits::default() }, "travel"),
    ] {
        let error = with(limits);
        assert!(error.is_bad_input() && error.to_string().contains(said), "{error}");
    }
}
