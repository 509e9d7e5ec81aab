use std::path::Path;
use std::sync::Arc;

use friction_model::{AnyModel, ModelName};
use rig_driver::Sensors;

use crate::compensation::{Arm, Means};
use crate::experiments;
use crate::run::experiment::Selection;
use crate::run::options::tests::options;
use crate::run::*;
use recording::bag::BagReader;
use work::progress::Progress;

fn run(options: &RunOptions, folder: &Path) -> Outcome {
    execute(options, folder, &Progress::new(1.0, true), &Arc::default()).unwrap()
}

/// The shipped tasks, shortened.
fn short() -> RunOptions {
    let mut options = RunOptions {
        experiment: Selection::alone(Arc::new(experiments::Compensation)),
        ..options()
    };
    for task in &mut options.compensation.tasks {
        task.protocol.duration = 6.0;
        task.protocol.repetitions = 2;
    }
    options
}

#[test]
fn every_task_has_its_rows_whatever_the_number_of_threads() {
    let root = tempfile::tempdir().unwrap();
    let means = vec![Means::Feedback, Means::Feedforward];
    let outcome = run(&RunOptions { means, ..short() }, &root.path().join("a"));
    let found = &outcome.results;
    assert_eq!((found.status, found.compensation.len()), (Status::Complete, 4));
    for task in &found.compensation {
        let rows = &task.comparison.rows;
        assert_eq!(rows.len(), 5, "{}", task.name);
        assert!(rows.iter().all(|row| row.effort > 0.0 && row.torque_error.is_some()));
        let mse = |arm: Arm| rows.iter().find(|row| row.arm == arm).unwrap().mse;
        assert!(mse(Arm::observer(ModelName::Proposed)) < mse(Arm::None), "{}", task.name);
    }
    let bag = BagReader::open(&outcome.folder.join("bag")).unwrap();
    assert!(!bag.messages::<msgs::sensor_msgs::JointState>("/joint_states").unwrap().is_empty());
    // Another number of workers, the same figures.
    let means = vec![Means::Feedback, Means::Feedforward];
    let again = run(&RunOptions { means, workers: 1, ..short() }, &root.path().join("b"));
    assert_eq!(
        serde_json::to_string(&found.compensation).unwrap(),
        serde_json::to_string(&again.results.compensation).unwrap()
    );
}

/// The thesis's test bed does not hunt: what its Stribeck curve falls by is less than viscous
/// friction and back-EMF rise by. A contact with stiff bristles that falls from .2 to .0925 N m
/// within .01 rad/s does. Its slips span at least what the PID's proportional part turns into the
/// fall of the friction, 4.84 V per N m (F_s - F_c) / 5.7517 V per rad = .0905 rad, an amplitude of
/// .045 rad, and less than twice that.
#[test]
fn a_sticky_plant_hunts_and_the_test_bed_does_not() {
    let root = tempfile::tempdir().unwrap();
    let mut options = RunOptions { models: vec![], ..short() };
    options.test_bed.simulation.sensors = Sensors::ideal();
    options.compensation.tasks.drain(..3);
    options.compensation.tasks[0].protocol.duration = 60.0;
    let outcome = run(&options, &root.path().join("rest"));
    assert_eq!(outcome.results.compensation[0].comparison.rows[0].limit_cycle, None);

    let mut parameters = AnyModel::test_bed(ModelName::Proposed).parameters();
    for (name, value) in [("f_s", 0.2), ("v_s", 0.01), ("z_b", 0.001)] {
        assert!(parameters.set(name, value));
    }
    options.test_bed.friction = parameters.try_into().unwrap();
    let outcome = run(&options, &root.path().join("hunt"));
    let cycle = outcome.results.compensation[0].comparison.rows[0].limit_cycle.unwrap();
    assert_eq!(cycle.repetitions, 2);
    assert!((0.045..0.09).contains(&cycle.amplitude), "{cycle:?}");
    assert!(cycle.amplitude_deviation < 1e-12 && cycle.period > 1.0, "{cycle:?}");
}
