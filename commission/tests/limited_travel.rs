//! Machines whose travel has ends meet none.

use std::path::Path;
use std::sync::Arc;

use commission::friction::wanted::Wanted;
use commission::hand_over::summary;
use commission::travel::TravelAsked;
use commission::{Asked, CommissionError, Dossier, Outcome, run};
use machine_rig::{Machine, MachineFactory, Stops, peaks, random};
use rig_driver::RigRegistry;
use rig_driver::safety::Travel;
use rig_setup::{RigChoice, RigLimits, RigSetup};
use work::progress::Progress;

/// A machine of the seed with ends at -1.2 and 2.1 rad of its encoder.
fn ended(seed: u64) -> Machine {
    let machine = random::machine(seed);
    let limits = RigLimits { travel: None, ..machine.limits };
    let stops = Some(Stops { low: -1.2, high: 2.1 });
    Machine { stops, limits, wiring: None, position_scale: 1.0, ..machine }
}

fn commissioned(
    machine: &Machine,
    travel: impl Into<Option<TravelAsked>>,
    folder: &Path,
) -> (Result<Outcome, CommissionError>, String) {
    let file = folder.join("machine.json");
    std::fs::write(&file, machine.text().unwrap()).unwrap();
    let place = file.display().to_string();
    let rig: RigChoice = format!("machine:{place}").parse().unwrap();
    let setup = RigSetup { limits: machine.limits, ..RigSetup::default() };
    let travel = travel.into();
    let asked = Asked { rig, setup, wanted: Wanted::default(), travel, allowed: 600.0 };
    let go = || {
        let known = run::look(&asked)?;
        let results = folder.join("results");
        std::fs::create_dir(&results).unwrap();
        let dossier = Dossier::begin(&results, &run::identity(&asked, Some(&known), None))?;
        run::run(&asked, &known, &dossier, &Arc::default(), &Progress::new(1.0, true))
    };
    (go(), place)
}

/// The way back to where a block begins was as fast as the travel is long.
#[test]
fn a_slow_speed_limit_holds_on_the_way_to_where_a_block_begins_too() {
    let _ = RigRegistry::standard().with(MachineFactory).install();
    let folder = tempfile::tempdir().unwrap();
    let machine = random::machine(88_003);
    let allowed = machine.limits.velocity.unwrap();
    // Its travel is that of its file.
    let (outcome, place) = commissioned(&machine, None, folder.path());
    let said = outcome.err().map(|error| error.to_string()).unwrap_or_default();
    assert!(!said.contains("overspeed"), "{said}");
    assert!(peaks(&place).unwrap().velocity <= 1.1 * allowed, "{:?}", peaks(&place));
}

#[test]
fn a_shaft_with_ends_never_meets_one() {
    let _ = RigRegistry::standard().with(MachineFactory).install();
    let mut commissioned_some = false;
    for seed in [3, 4] {
        let folder = tempfile::tempdir().unwrap();
        let (outcome, place) =
            commissioned(&ended(seed), TravelAsked::Around(-1.1, 2.0), folder.path());
        let peaks = peaks(&place).unwrap();
        assert_eq!(peaks.hit, 0.0, "{seed}: {peaks:?}");
        match outcome {
            Ok(Outcome { found, .. }) => {
                commissioned_some = true;
                let fastest = found.friction.speeds.1;
                assert!(
                    fastest < 3.1,
                    "{seed}: a block at {fastest} rad/s does not fit in 3.1 rad"
                );
            }
            // A shaft that breaks away too fast for its travel is told so.
            Err(error) => assert!(error.to_string().contains("travel"), "{seed}: {error}"),
        }
    }
    assert!(commissioned_some);
}

/// Whoever asks, over the network too, is held to the travel of the rig's limits.
#[test]
fn a_travel_that_is_asked_for_is_never_wider_than_that_of_the_limits() {
    let own = Travel { min: -1.0, max: 1.0, margin: 0.1 };
    let limits = RigLimits { travel: Some(own), ..RigLimits::default() };
    let setup = RigSetup { limits, ..RigSetup::default() };
    let asked = |low, high| {
        let travel = Some(TravelAsked::Around(low, high));
        let (rig, wanted) = (RigChoice::Simulated, Wanted::default());
        run::look(&Asked { rig, setup, wanted, travel, allowed: 600.0 })
    };
    for (low, high) in [(-3.0, 3.0), (-0.5, 1.5), (-100.0, 0.5)] {
        let error = asked(low, high).unwrap_err();
        assert!(error.is_bad_input() && error.to_string().contains("limits"), "{error}");
    }
    let travel = asked(-0.8, 0.7).unwrap().travel.unwrap();
    assert!(travel.min >= -0.8 && travel.max <= 0.7, "{travel:?}");
}

#[test]
fn what_a_short_travel_keeps_from_being_seen_is_not_said_to_be_absent() {
    let folder = tempfile::tempdir().unwrap();
    let setup = RigSetup::default();
    let wanted = Wanted::default();
    let travel = Some(TravelAsked::Around(-0.6, 0.8));
    let asked = Asked { rig: RigChoice::Simulated, setup, wanted, travel, allowed: 600.0 };
    let known = run::look(&asked).unwrap();
    let dossier =
        Dossier::begin(folder.path(), &run::identity(&asked, Some(&known), None)).unwrap();
    let outcome =
        run::run(&asked, &known, &dossier, &Arc::default(), &Progress::new(1.0, true)).unwrap();
    let friction = &outcome.found.friction;
    let able = friction.kept_from.unwrap();
    assert!(able > 3.0 * friction.speeds.1, "{able} {:?}", friction.speeds);
    let said = summary(&outcome.found, &asked.wanted);
    assert!(said.contains("travel is too short for speeds above"), "{said}");
    // The test bed's levels in volts: 0.448 and 0.4815, which meet at 0.14 rad/s.
    let (low, high) = (friction.curve.f_c.low, friction.curve.f_c.high);
    let holds = low.is_none_or(|low| low <= 0.448) && high.is_none_or(|high| high >= 0.448);
    assert!(friction.curve.dips && holds, "{:?}", friction.curve);
}

#[test]
fn a_travel_that_is_too_small_is_refused_with_what_is_needed_and_nothing_moves() {
    let _ = RigRegistry::standard().with(MachineFactory).install();
    let folder = tempfile::tempdir().unwrap();
    let (outcome, place) = commissioned(&ended(3), TravelAsked::Around(-0.1, 0.1), folder.path());
    let error = outcome.unwrap_err();
    assert!(error.is_bad_input() && error.to_string().contains("0.5 rad"), "{error}");
    assert_eq!(peaks(&place).unwrap().voltage, 0.0);
}
