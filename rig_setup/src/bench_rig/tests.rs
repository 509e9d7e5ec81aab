//! Turns on the simulated rig.

use friction_model::{AnyModel, ModelName};

use super::*;
use crate::{RigChoice, RigSetup};

fn bench(stop: &Arc<AtomicBool>) -> BenchRig {
    let friction = AnyModel::test_bed(ModelName::LuGre);
    BenchRig::new(
        RigChoice::Simulated.open(&RigSetup { friction, ..RigSetup::default() }).unwrap(),
        Arc::clone(stop),
    )
    .unwrap()
}

#[test]
fn every_turn_begins_at_rest_and_counts_from_its_own_zero() {
    let bench = bench(&Arc::default());
    for _ in 0..3 {
        let mut turn = bench.lend().unwrap();
        let first = turn.measure();
        assert_eq!((first.cycle, first.time, first.encoder_counts), (0, 0.0, 0));
        assert!(first.tachometer_velocity.abs() < 0.1, "{first:?}");
        for _ in 0..500 {
            turn.apply(2.0).unwrap();
            turn.measure();
        }
        let last = turn.measure();
        assert!(last.encoder_position > 0.5 && (last.time - 0.5).abs() < 0.01, "{last:?}");
    }
}

#[test]
fn nobody_takes_it_while_it_is_lent() {
    let bench = bench(&Arc::default());
    let turn = bench.lend().unwrap();
    assert_eq!(bench.lend().err(), Some(RigError::Lent));
    drop(turn);
    assert!(bench.lend().is_ok());
}

#[test]
fn told_to_stop_it_goes_to_zero_volts_at_once_and_moves_no_more() {
    let stop = Arc::new(AtomicBool::new(false));
    let bench = bench(&stop);
    let mut turn = bench.lend().unwrap();
    turn.measure();
    turn.apply(3.0).unwrap();
    stop.store(true, Ordering::Relaxed);
    turn.measure();
    assert_eq!(turn.apply(3.0), Err(RigError::Stopped));
    turn.measure();
    assert_eq!(turn.measure().voltage_applied, 0.0);
    drop(turn);
    assert_eq!(bench.lend().err(), Some(RigError::Stopped));
}

#[test]
fn a_fault_ends_the_turn_and_is_told_to_the_next() {
    let bench = bench(&Arc::default());
    let mut turn = bench.lend().unwrap();
    turn.measure();
    assert!(turn.apply(f64::NAN).is_err());
    drop(turn);
    let refused = bench.lend().err().unwrap().to_string();
    assert!(refused.contains("activate") || refused.contains("fault"), "{refused}");
}
