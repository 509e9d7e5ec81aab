//! Machines that nobody has seen, and machines that break.

use std::path::Path;
use std::sync::Arc;

use commission::friction::wanted::Wanted;
use commission::trial::{Trial, table, trial};
use commission::{Asked, CommissionError, Dossier, Outcome, run};
use machine_rig::{Break, Breakdown, Machine, MachineFactory, peaks, random};
use rig_driver::RigRegistry;
use rig_setup::{RigChoice, RigSetup};
use work::progress::Progress;

/// Machines of the short and of the full tier.
fn machines() -> u32 {
    if std::env::var_os("FRICTION_FULL").is_some() { 100 } else { 8 }
}

fn installed() {
    // Another test of this program may have done it.
    let _ = RigRegistry::standard().with(MachineFactory).install();
}

#[test]
fn strange_machines_are_commissioned_within_their_limits_and_their_parameters_lie_in_the_intervals()
{
    installed();
    let folder = tempfile::tempdir().unwrap();
    let asked = Trial {
        machines: machines(),
        seed: 5000,
        wanted: Wanted::default(),
        allowed: 600.0,
        protocol: None,
        workers: std::thread::available_parallelism().map_or(1, usize::from),
    };
    let progress = Progress::new(1.0, true);
    let cases =
        trial(&asked, 0..asked.machines, folder.path(), &Arc::default(), &progress).unwrap();
    let found = table(&cases);
    println!("{found}");
    // Of eight machines one may be refused; of a hundred five.
    assert!(found.commissioned >= if machines() == 8 { 0.87 } else { 0.95 }, "{found}");
    assert_eq!(found.contradicting.0, found.contradicting.1, "{found}");
    assert_eq!(found.broken, 0, "{found}");
    assert!(found.held.0 >= if machines() == 8 { 0.8 } else { 0.92 }, "{found}");
    assert!(found.seconds.1 <= 600.0, "{found}");
    assert!(found.error.0 <= 1.15, "{found}");
    assert!(
        !cases
            .iter()
            .any(|case| { case.refused.as_ref().is_some_and(|(_, why)| why.contains("panicked")) })
    );
}

/// A load behind a play: the shaft rested after each of the moves of the commission and of the proof,
/// and hunted after a later one.
#[test]
fn a_load_behind_a_play_rests_after_the_hand_over() {
    installed();
    let folder = tempfile::tempdir().unwrap();
    let asked = Trial {
        machines: 1,
        seed: 412_057,
        wanted: Wanted::default(),
        allowed: 600.0,
        protocol: None,
        workers: std::thread::available_parallelism().map_or(1, usize::from),
    };
    let progress = Progress::new(1.0, true);
    let found = table(
        &trial(&asked, 0..asked.machines, folder.path(), &Arc::default(), &progress).unwrap(),
    );
    assert_eq!(found.commissioned, 1.0, "{found}");
    assert_eq!(found.hunting.0, 0, "{found}");
}

/// The commission of a machine whose file is in `folder`, and its place.
fn asked(machine: &Machine, folder: &Path, name: &str) -> (Asked, String) {
    let file = folder.join(format!("{name}.json"));
    std::fs::write(&file, machine.text().unwrap()).unwrap();
    let place = file.display().to_string();
    let rig: RigChoice = format!("machine:{place}").parse().unwrap();
    let setup = RigSetup { limits: machine.limits, ..RigSetup::default() };
    (Asked { rig, setup, wanted: Wanted::default(), travel: None, allowed: 600.0 }, place)
}

/// What comes of it, in a folder of its own.
fn commissioned(asked: &Asked, folder: &Path, name: &str) -> Result<Outcome, CommissionError> {
    let known = run::look(asked).unwrap();
    let results = folder.join(name);
    std::fs::create_dir(&results).unwrap();
    let dossier = Dossier::begin(&results, &run::identity(asked, Some(&known), None)).unwrap();
    run::run(asked, &known, &dossier, &Arc::default(), &Progress::new(1.0, true))
}

/// Commissions a machine that breaks; what it said.
fn broken(what: Break, after: f64, folder: &Path) -> (CommissionError, String) {
    let mut machine: Machine = random::machine(1);
    machine.breaks = Some(Breakdown { what, after });
    let name = format!("{what:?}-{after}");
    let (asked, place) = asked(&machine, folder, &name);
    let error = commissioned(&asked, folder, &name).unwrap_err();
    assert!(!folder.join(name).join("parameters.yaml").exists(), "{what:?}: half a result");
    (error, place)
}

#[test]
fn another_machine_in_the_same_file_is_not_gone_on_with() {
    installed();
    let folder = tempfile::tempdir().unwrap();
    let of = |counts| {
        let mut machine = random::machine(1);
        machine.sensors.encoder_counts_per_turn = counts;
        let (asked, place) = asked(&machine, folder.path(), "machine");
        machine_rig::forget(&place);
        run::identity(&asked, Some(&run::look(&asked).unwrap()), None)
    };
    let said = of(1000).require(&of(4096), folder.path()).unwrap_err().to_string();
    assert!(said.contains("another device answers"), "{said}");
}

#[test]
fn a_machine_that_breaks_ends_at_zero_volts_with_what_to_look_at_and_hands_nothing_over() {
    installed();
    let folder = tempfile::tempdir().unwrap();
    // In the ramps, the tones, the blocks.
    for after in [0.5, 30.0, 80.0] {
        for (what, said) in [
            (
                Break::Blocked,
                &["encoder", "did not move", "turned steadily", "motor", "follow"][..],
            ),
            (Break::EncoderUnplugged, &["encoder", "steadily", "motor", "follow"]),
            (Break::Unplugged, &["line", "cable"]),
        ] {
            let (error, place) = broken(what, after, folder.path());
            let text = error.to_string();
            assert!(said.iter().any(|word| text.contains(word)), "{what:?} {after}: {text}");
            assert!(!error.is_stopped(), "{text}");
            let driven = peaks(&place).unwrap();
            assert_eq!(driven.last_voltage, 0.0, "{what:?} {after}: {text}");
        }
    }
}

/// What no sensor tells may be found out or be commissioned; the limits hold either way.
#[test]
fn a_shaft_that_tears_loose_or_an_encoder_that_skips_stays_within_the_limits() {
    installed();
    let folder = tempfile::tempdir().unwrap();
    for what in [Break::TornLoose, Break::EncoderSkips] {
        for after in [30.0, 80.0] {
            let mut machine = random::machine(1);
            machine.breaks = Some(Breakdown { what, after });
            let (asked, place) = asked(&machine, folder.path(), &format!("{what:?}-{after}"));
            let outcome = commissioned(&asked, folder.path(), &format!("{what:?}-{after}"));
            let driven = peaks(&place).unwrap();
            let (voltage, velocity) =
                (machine.limits.voltage.unwrap(), machine.limits.velocity.unwrap());
            assert!(driven.voltage <= 1.01 * voltage, "{what:?} {after}: {driven:?}");
            assert!(driven.velocity <= 1.1 * velocity, "{what:?} {after}: {driven:?}");
            assert_eq!(driven.last_voltage, 0.0, "{what:?} {after}: {outcome:?}");
        }
    }
}

/// The shaft runs away from its reference: the loop, or the safety layer, has it at once.
#[test]
fn a_loop_whose_encoder_turns_round_ends_at_zero_volts_within_the_limits() {
    installed();
    let folder = tempfile::tempdir().unwrap();
    // In the blocks, and in the proof.
    for after in [80.0, 330.0] {
        let (error, place) = broken(Break::EncoderReversed, after, folder.path());
        let text = error.to_string();
        let limits = random::machine(1).limits;
        let driven = peaks(&place).unwrap();
        assert_eq!(driven.last_voltage, 0.0, "{after}: {text}");
        assert!(driven.voltage <= 1.01 * limits.voltage.unwrap(), "{after}: {driven:?}");
        assert!(driven.velocity <= 1.2 * limits.velocity.unwrap(), "{after}: {driven:?}");
        assert!(
            ["sign", "overspeed", "steadily", "encoder", "steady"].iter().any(|w| text.contains(w)),
            "{after}: {text}"
        );
    }
}

/// A torque sensor is not used: at the end of its range it is told, or does no harm.
#[test]
fn a_torque_sensor_at_the_end_of_its_range_is_told_or_does_no_harm() {
    installed();
    let folder = tempfile::tempdir().unwrap();
    for after in [0.0, 80.0] {
        let mut machine = random::machine(1);
        machine.sensed = machine_rig::Sensed { tachometer: true, torque: true, current: false };
        machine.breaks = Some(Breakdown { what: Break::TorqueSaturated, after });
        let name = format!("torque-{after}");
        let (asked, place) = asked(&machine, folder.path(), &name);
        let parameters = folder.path().join(&name).join("parameters.yaml");
        match commissioned(&asked, folder.path(), &name) {
            Ok(_) => assert!(parameters.is_file()),
            Err(error) => {
                let text = error.to_string();
                assert!(text.contains("torque"), "{after}: {text}");
                assert!(!parameters.exists(), "{after}: half a result");
            }
        }
        assert_eq!(peaks(&place).unwrap().last_voltage, 0.0, "{after}");
    }
}
