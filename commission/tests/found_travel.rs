//! Ends that nobody knows are met gently, and never again.

use std::path::Path;
use std::sync::Arc;

use commission::friction::wanted::Wanted;
use commission::travel::TravelAsked;
use commission::trial::case;
use commission::{Asked, CommissionError, Dossier, Outcome, run};
use machine_rig::{Break, Breakdown, Machine, MachineFactory, Peaks, Stops, peaks, random};
use rig_driver::RigRegistry;
use rig_setup::{RigChoice, RigLimits, RigSetup};
use work::progress::Progress;

/// A touch is gentle at up to this share of the speed that the voltage limit gives: a hundredth of
/// the energy.
const GENTLE: f64 = 0.1;

/// A machine of the seed that counts right, with these ends or none.
fn machine(seed: u64, stops: Option<Stops>) -> Machine {
    let machine = random::machine(seed);
    let limits = RigLimits { travel: None, ..machine.limits };
    Machine { stops, limits, position_scale: 1.0, ..machine }
}

fn sought(
    machine: &Machine,
    folder: &Path,
    angle: f64,
) -> (Result<Outcome, CommissionError>, Dossier, Peaks) {
    let file = folder.join("machine.json");
    std::fs::write(&file, machine.text().unwrap()).unwrap();
    let place = file.display().to_string();
    machine_rig::forget(&place);
    let rig: RigChoice = format!("machine:{place}").parse().unwrap();
    let setup = RigSetup { limits: machine.limits, ..RigSetup::default() };
    let travel = Some(TravelAsked::Find(angle));
    let asked = Asked { rig, setup, wanted: Wanted::default(), travel, allowed: 900.0 };
    let known = run::look(&asked).unwrap();
    let results = folder.join("results");
    std::fs::create_dir(&results).unwrap();
    let dossier = Dossier::begin(&results, &run::identity(&asked, Some(&known), None)).unwrap();
    let outcome = run::run(&asked, &known, &dossier, &Arc::default(), &Progress::new(1.0, true));
    (outcome, dossier, peaks(&place).unwrap())
}

#[test]
fn ends_are_met_gently_and_the_travel_between_them_is_kept() {
    let _ = RigRegistry::standard().with(MachineFactory).install();
    let seeds = if std::env::var_os("FRICTION_FULL").is_some() { 3..23 } else { 3..8 };
    let mut commissioned = 0;
    let all = seeds.end - seeds.start;
    for seed in seeds {
        let folder = tempfile::tempdir().unwrap();
        let ends = Stops { low: -2.3, high: 3.4 };
        let machine = machine(seed, Some(ends));
        let (outcome, dossier, peaks) = sought(&machine, folder.path(), 8.0);
        let fastest = machine.limits.voltage.unwrap() * machine.motor.gain();
        println!("{seed}: hit at {:.3} of {fastest:.1} rad/s", peaks.hit);
        assert!(peaks.hit < GENTLE * fastest, "{seed}: {peaks:?} of {fastest}");
        if let Ok(Some(kept)) = dossier.travel() {
            let (low, high) = (kept.travel.min, kept.travel.max);
            // By the encoder, which may count the other way.
            let inside = (low > -2.3 && high < 3.4) || (low > -3.4 && high < 2.3);
            assert!(inside, "{seed}: {low} to {high}");
        }
        match outcome {
            Ok(outcome) => {
                commissioned += 1;
                let sought = outcome.found.met.sought.unwrap();
                println!("{seed}: {sought}, {:.0} s", outcome.found.seconds);
                let (low, high) = (sought.ends.low, sought.ends.high);
                assert!(low.is_some() && high.is_some(), "{seed}: {sought}");
                let walked = sought.ends.walked.1 - sought.ends.walked.0;
                assert!((walked - 5.7).abs() < 0.2, "{seed}: {sought}");
            }
            Err(error) => println!("{seed}: {error}"),
        }
    }
    assert!(10 * commissioned >= 6 * all, "{commissioned} of {all}");
}

#[test]
fn an_axis_without_ends_is_told_as_free_after_the_angle() {
    let _ = RigRegistry::standard().with(MachineFactory).install();
    let folder = tempfile::tempdir().unwrap();
    let (outcome, dossier, _) = sought(&machine(1, None), folder.path(), 4.0);
    let sought = outcome.unwrap().found.met.sought.unwrap();
    assert!(sought.travel.is_none() && dossier.travel().unwrap().is_none());
    assert!(sought.to_string().contains("4.0 rad either way"), "{sought}");
}

/// The encoder does not count from the start on, and the ends are not known: what moves the shaft is
/// not seen, and is not raised to the voltage limit.
#[test]
fn an_encoder_that_does_not_count_ends_the_search_early_with_what_to_look_at() {
    let _ = RigRegistry::standard().with(MachineFactory).install();
    for tachometer in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let mut machine = machine(1, Some(Stops { low: -20.0, high: 30.0 }));
        machine.sensed.tachometer = tachometer;
        machine.breaks = Some(Breakdown { what: Break::EncoderUnplugged, after: 0.0 });
        let (outcome, _, peaks) = sought(&machine, folder.path(), 8.0);
        let said = outcome.unwrap_err().to_string();
        assert!(said.contains("by hand") && said.contains("encoder's plug"), "{said}");
        let limit = machine.limits.voltage.unwrap();
        assert!(peaks.voltage <= 0.61 * limit, "{said}: {peaks:?} of {limit} V");
        assert_eq!(peaks.last_voltage, 0.0);
        // What the tachometer shows ends it as soon as the shaft turns.
        assert_eq!(said.contains("tachometer"), tachometer, "{said}");
        assert!(!tachometer || peaks.voltage < 0.5 * limit, "{peaks:?} of {limit} V");
    }
}

#[test]
fn a_trial_tells_a_gentle_touch_from_a_broken_limit() {
    let _ = RigRegistry::standard().with(MachineFactory).install();
    let folder = tempfile::tempdir().unwrap();
    let machine = machine(6, Some(Stops { low: -2.3, high: 3.4 }));
    let file = folder.path().join("machine.json");
    std::fs::write(&file, machine.text().unwrap()).unwrap();
    let results = folder.path().join("results");
    std::fs::create_dir(&results).unwrap();
    let asked = (&Wanted::default(), 900.0, None);
    let found = case(&machine, &file, &results, asked, &Arc::default()).unwrap();
    assert!(found.peaks.hit > 0.0 && !found.broke_limits(), "{:?}", found.peaks);
    let mut hard = found;
    hard.peaks.hit = 0.2 * machine.motor.gain() * machine.voltage_range;
    assert!(hard.broke_limits());
}
