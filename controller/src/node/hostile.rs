//! What comes over the network and may not move the motor: each row of [`ros_node::hostile`] that
//! is the controller's, given to what it passes on its way.

use ros_node::{
    hostile::{self, Effect},
    one_writer::{OneWriter, Verdict, WriterId},
    stamps::{Follows, Forwards},
};

use super::{estimates::Estimates, friction::Friction, plausible, reference::ReferenceKeeper};
use crate::{Controller, ControllerOptions, Feedback, Reference};

const ONE: WriterId = WriterId([1; 16]);
const OTHER: WriterId = WriterId([2; 16]);
const MS: u64 = 1_000_000;
const BAD: [f64; 4] = [f64::NAN, f64::INFINITY, 1e308, -1e7];

/// A stranger that speaks as often as the one that was there first, and ten times as often.
fn from_another() -> Effect {
    let mut one = OneWriter::new(Some(500 * MS));
    one.open_contested();
    assert_eq!(one.hear(ONE, 0), Verdict::Taken { first: true });
    for cycle in 1..5000 {
        for _ in 0..10 {
            assert_eq!(one.hear(OTHER, cycle * MS), Verdict::Other(ONE));
        }
        assert_eq!(
            one.hear(ONE, cycle * MS),
            Verdict::Taken { first: false },
            "the genuine one loses nothing"
        );
    }
    Effect::Dropped
}

/// Joint states of a stamp, after a hundred good ones.
fn stamped(stamp: u64, follows: Follows) -> Effect {
    let mut forwards = Forwards::default();
    (1..=100).for_each(|cycle| assert_eq!(forwards.take(cycle * MS, cycle * MS), Follows::Fits));
    assert_eq!(forwards.take(stamp, 101 * MS), follows);
    assert_eq!(forwards.take(101 * MS, 101 * MS), Follows::Fits, "the next good one counts");
    Effect::Dropped
}

fn effect(input: &str) -> Effect {
    match input {
        "a joint state of load_shaft" | "a friction estimate" | "a reference" => from_another(),
        "a joint state with a stamp from the future" => stamped(10_101 * MS, Follows::Future),
        "a joint state with a stamp that is not later" => {
            stamped(100 * MS, Follows::Backwards);
            stamped(1, Follows::Backwards)
        }
        "a joint state of another joint" => {
            let names = ["elbow".to_owned()];
            assert_eq!(plausible::index_of("load_shaft", &names), None);
            assert_eq!(
                plausible::index_of("load_shaft", &[]),
                Some(0),
                "without names the first is meant"
            );
            Effect::Dropped
        }
        "a joint state beyond what a shaft does" => {
            assert!(plausible::is_beyond(0.0, 1e308) && plausible::is_beyond(1e7, 0.0));
            Effect::Dropped
        }
        "joint states that are no numbers" => {
            let mut controller = Controller::new(ControllerOptions::default()).unwrap();
            let moving = Reference { velocity: 3.0, ..Reference::default() };
            for _ in 0..1000 {
                let seen =
                    Feedback { position: f64::NAN, velocity: f64::NAN, friction: 0.0, cycle: None };
                assert_eq!(controller.step(&moving, &seen).total, 0.0);
            }
            Effect::Rests
        }
        "a friction estimate of no joint state" => {
            let mut estimates = Estimates::new(100);
            estimates.see(5 * MS);
            for stamp_ns in [1, 5 * MS - 1, 5 * MS + 1, u64::MAX] {
                estimates.take(Friction { stamp_ns, torque: 1.0 });
            }
            estimates.see(6 * MS);
            assert_eq!(estimates.newest(), Friction::default());
            Effect::Dropped
        }
        "a friction estimate that is no number" => {
            assert!(BAD[..2].iter().all(|torque| !torque.is_finite()));
            Effect::Dropped
        }
        "a reference that is no number, or beyond what a shaft does" => {
            for x in BAD {
                assert!(!plausible::is_reference(&Reference {
                    velocity: x,
                    ..Reference::default()
                }));
            }
            Effect::Dropped
        }
        "no reference for reference_timeout" => {
            let mut keeper = ReferenceKeeper::new(0.0);
            keeper.limit(0.5, 2.0, 10.0);
            keeper.take(Reference { velocity: 1.0, ..Reference::default() }, 0.0);
            let last = (0..1500).map(|_| keeper.next(1e-3).velocity).last();
            assert_eq!(last, Some(0.0));
            Effect::Rests
        }
        other => panic!("no test gives `{other}` to the logic"),
    }
}

#[test]
fn every_hostile_input_does_what_the_table_says() {
    for row in hostile::of("controller") {
        assert_eq!(effect(row.input), row.effect, "{row:?}");
    }
}
