//! The designed experiment against the fixed protocol of the thesis, on the simulated test bed.

use std::sync::Arc;

use commission::friction::wanted::Wanted;
use commission::protocols::test_bed::{PART, beside};
use commission::{Asked, Ranged};
use experiment_runner::protocol::ConstantVelocityProtocol;
use friction_model::{AnyModel, ModelName};
use rig_setup::{RigChoice, RigSetup};
use work::progress::Progress;

/// The intervals of `run characterise` are those of its steady points: two sets of 12000 s, of which
/// one identifies.
#[test]
fn chosen_blocks_reach_the_intervals_of_characterise_in_a_twentieth_of_its_time() {
    let setup =
        RigSetup { friction: AnyModel::test_bed(ModelName::Proposed), ..RigSetup::default() };
    let wanted = Wanted::default();
    let asked = Asked { rig: RigChoice::Simulated, setup, wanted, allowed: 600.0 };
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
