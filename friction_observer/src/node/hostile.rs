//! Each row of [`ros_node::hostile`] that is the observer's, given to what it passes on its way.

use ros_node::{
    hostile::{self, Effect},
    one_writer::{OneWriter, Verdict, WriterId},
    stamps::{Follows, Forwards},
};

const ONE: WriterId = WriterId([1; 16]);
const OTHER: WriterId = WriterId([2; 16]);
const MS: u64 = 1_000_000;

fn effect(input: &str) -> Effect {
    match input {
        "a joint state of load_shaft, a voltage or a reference" => {
            let mut one = OneWriter::new(Some(500 * MS));
            one.open_contested();
            for cycle in 0..5000 {
                assert_eq!(one.hear(ONE, cycle * MS), Verdict::Taken { first: cycle == 0 });
                assert_eq!(one.hear(OTHER, cycle * MS), Verdict::Other(ONE));
            }
            Effect::Dropped
        }
        "a joint state with a stamp from the future, or not later" => {
            let mut forwards = Forwards::default();
            for cycle in 1..5000 {
                assert_eq!(forwards.take(cycle * MS, cycle * MS), Follows::Fits);
                assert_eq!(forwards.take(cycle * MS, cycle * MS), Follows::Backwards);
                assert_eq!(forwards.take((cycle + 10_000) * MS, cycle * MS), Follows::Future);
            }
            Effect::Dropped
        }
        other => panic!("no test gives `{other}` to the logic"),
    }
}

#[test]
fn every_hostile_input_does_what_the_table_says() {
    for row in hostile::of("friction_observer") {
        assert_eq!(effect(row.input), row.effect, "{row:?}");
    }
}
