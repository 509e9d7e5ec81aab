//! The designed experiment against the fixed protocol of the thesis, on the simulated test bed.

use std::sync::Arc;

use commission::friction::wanted::Wanted;
use commission::protocols::test_bed::{PART, beside};
use commission::trial::{Trial, table, trial};
use commission::{Asked, Ranged};
use experiment_runner::protocol::ConstantVelocityProtocol;
use friction_model::{AnyModel, ModelName};
use machine_rig::{MachineFactory, random};
use rig_driver::RigRegistry;
use rig_setup::{RigChoice, RigSetup};
use work::progress::Progress;

/// The intervals of `run characterise` are those of its steady points: two sets of 12000 s, of which
/// one identifies.
#[test]
fn chosen_blocks_reach_the_intervals_of_characterise_in_a_twentieth_of_its_time() {
    let setup =
        RigSetup { friction: AnyModel::test_bed(ModelName::Proposed), ..RigSetup::default() };
    let wanted = Wanted::default();
    let asked = Asked { rig: RigChoice::Simulated, setup, wanted, allowed: 600.0, travel: None };
    let protocol = ConstantVelocityProtocol::default();
    let progress = Progress::new(1.0, true);
    let found = beside(&asked, &protocol, &Arc::default(), &progress).unwrap();
    println!("{found}");
    let (seconds, _) = found.reached.unwrap();
    assert!(seconds <= PART * found.protocol_seconds, "{found}");
    for row in &found.rows {
        // Narrow and wrong would be no reaching: it is as near the truth as the fixed protocol says
        // of itself.
        let half = |ranged: Ranged| 0.5 * (ranged.high.unwrap() - ranged.low.unwrap());
        assert!(half(row.designed) <= half(row.protocol), "{found}");
        let missed = (row.designed.value - row.truth.unwrap()).abs();
        assert!(missed <= half(row.protocol), "{}: {missed}\n{found}", row.name);
    }
}

#[test]
fn machines_of_a_trial_are_driven_by_both_and_counted_on_both_sides() {
    // Another test of this program may have done it.
    let _ = RigRegistry::standard().with(MachineFactory).install();
    let folder = tempfile::tempdir().unwrap();
    let protocol = ConstantVelocityProtocol { repetitions: 1, ..ConstantVelocityProtocol::quick() };
    let seconds = protocol.duration * protocol.velocities.len() as f64;
    // Two neighbours whose shafts turn freely: the fixed protocol goes one way for seconds.
    let free = |seed: &u64| (0..2).all(|i| random::machine(seed + i).stops.is_none());
    let asked = Trial {
        machines: 2,
        seed: (9102..).find(free).unwrap(),
        wanted: Wanted::default(),
        allowed: 600.0,
        protocol: Some(protocol),
        workers: std::thread::available_parallelism().map_or(1, usize::from),
    };
    let progress = Progress::new(1.0, true);
    let cases =
        trial(&asked, 0..asked.machines, folder.path(), &Arc::default(), &progress).unwrap();
    let found = table(&cases);
    let beside = found.beside.unwrap();
    assert_eq!((beside.machines, beside.told), (2, 2), "{found}");
    assert!(beside.protocol.seconds >= seconds, "{found}");
    assert!(beside.protocol.held.1 > 0 && beside.commission.held.1 > 0, "{found}");
    assert!(found.to_string().contains("fixed protocol"), "{found}");
}
