use super::*;
use crate::bag::{BagOptions, BagWriter};
use crate::joints::JOINT_STATES;
use msgs::sensor_msgs::JointState;
use msgs::std_msgs::Header;

/// A bag of an arm: three joints, the second without a velocity, and messages of a gripper
/// between.
fn arm(dir: &Path) {
    let mut bag = BagWriter::create(dir, BagOptions::default()).unwrap();
    for i in 0..40u64 {
        let stamp = 1_600_000_000_000_000_000 + i * 1_000_000;
        let value = i as f64;
        let state = JointState {
            header: Header::at(stamp),
            name: ["shoulder", "elbow", "wrist"].map(str::to_owned).to_vec(),
            position: vec![0.1 * value, 0.2 * value, 0.3 * value],
            velocity: vec![value, f64::NAN, 3.0 * value],
            effort: vec![10.0, 20.0 + value, 30.0],
        };
        bag.write(JOINT_STATES, stamp, &state).unwrap();
        let gripper = JointState {
            header: Header::at(stamp + 500_000),
            name: vec!["gripper".into()],
            position: vec![7.0],
            velocity: vec![],
            effort: vec![],
        };
        bag.write(JOINT_STATES, stamp + 500_000, &gripper).unwrap();
    }
    bag.finish().unwrap();
}

#[test]
fn a_joint_is_read_by_its_name_with_all_its_fields() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("bag");
    arm(&dir);
    let joint =
        |name: &str| JointChoice { name: Some(name.to_owned()), effort: Some(Effort::Driving) };
    let wrist = read(&dir, None, &joint("wrist"), 0.05).unwrap();
    assert_eq!((wrist.samples(), wrist.friction_only), (40, false));
    assert_eq!(wrist.velocity.as_ref().unwrap()[2], 6.0);
    assert!((wrist.position.as_ref().unwrap()[2] - 0.6).abs() < 1e-12);
    assert_eq!(wrist.force, vec![30.0; 40]);
    assert_eq!(wrist.sources.force.name, "/joint_states effort of wrist");
    let names: Vec<&str> = wrist.beside.iter().map(|other| other.joint.as_str()).collect();
    assert_eq!(names, ["shoulder", "elbow"], "the gripper is held");
    assert!((wrist.beside[1].travel - 7.8).abs() < 1e-12, "{:?}", wrist.beside);
    let elbow = read(&dir, None, &joint("elbow"), 0.05).unwrap();
    assert_eq!((elbow.velocity, elbow.force[1]), (None, 21.0));
    assert!((elbow.position.unwrap()[1] - 0.2).abs() < 1e-12);
}

#[test]
fn a_choice_that_is_missing_is_asked_for_and_the_joints_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("bag");
    arm(&dir);
    let message = |name: Option<&str>, effort: Option<Effort>| {
        let choice = JointChoice { name: name.map(str::to_owned), effort };
        read(&dir, None, &choice, 0.05).unwrap_err().to_string()
    };
    for (name, effort, parts) in [
        (None, None, &["shoulder, elbow, wrist, gripper", "several joints"][..]),
        (Some("hand"), None, &["no joint `hand`", "shoulder, elbow"]),
        (Some("wrist"), None, &["wrist", "drives", "friction"]),
        (Some("gripper"), Some(Effort::Driving), &["effort"]),
    ] {
        let said = message(name, effort);
        assert!(parts.iter().all(|part| said.contains(part)), "{said}");
    }
}

/// A bag whose messages `state` makes, on this topic.
fn bag(dir: &Path, topic: &str, state: impl Fn(u64) -> JointState) {
    let mut bag = BagWriter::create(dir, BagOptions::default()).unwrap();
    for i in 0..40u64 {
        let stamp = 1_600_000_000_000_000_000 + i * 1_000_000;
        let state = JointState { header: Header::at(stamp), ..state(i) };
        bag.write(topic, stamp, &state).unwrap();
    }
    bag.finish().unwrap();
}

fn state(names: &[&str], effort: f64) -> JointState {
    JointState {
        header: Header::at(0),
        name: names.iter().map(|name| (*name).to_owned()).collect(),
        position: vec![0.5; names.len().max(1)],
        velocity: vec![1.0; names.len().max(1)],
        effort: vec![effort; names.len().max(1)],
    }
}

const DRIVING: JointChoice = JointChoice { name: None, effort: Some(Effort::Driving) };

/// One message without an effort and the whole bag was refused.
#[test]
fn messages_without_a_number_are_left_out_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("bag");
    bag(&dir, JOINT_STATES, |i| state(&["j"], if i < 3 || i == 20 { f64::NAN } else { 2.0 }));
    let found = read(&dir, None, &DRIVING, 0.05).unwrap();
    assert_eq!((found.irregularities.blank, found.samples()), (4, 37));
    assert!(found.force.iter().all(|force| *force == 2.0));
    let seen = crate::overview::look(&dir, &Default::default(), &DRIVING).unwrap();
    assert_eq!((seen.samples, seen.blank), (36, 4));
    let none = folder.path().join("none");
    bag(&none, JOINT_STATES, |_| state(&["j"], f64::NAN));
    let said = read(&none, None, &DRIVING, 0.05).unwrap_err();
    assert!(
        matches!(said, RecordingError::NoEffort { without: 40, all: 40, voltage: false, .. }),
        "{said}"
    );
    let said = said.to_string();
    assert!(said.contains("joint j of /joint_states") && said.contains("no effort"), "{said}");
    assert!(said.contains("what drives it") && !said.contains("voltage, which"), "{said}");
}

#[test]
fn a_robot_may_be_named_before_the_topic() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("bag");
    bag(&dir, "/left_arm/joint_states", |_| state(&["j"], 2.0));
    let found = read(&dir, None, &DRIVING, 0.05).unwrap();
    assert_eq!(found.sources.force.name, "/left_arm/joint_states effort of j");
}

/// The first of several values was read, whichever joint it belonged to.
#[test]
fn joints_that_cannot_be_told_apart_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let nameless = folder.path().join("nameless");
    bag(&nameless, JOINT_STATES, |_| JointState { effort: vec![1.0, 2.0], ..state(&[], 1.0) });
    let said = read(&nameless, None, &DRIVING, 0.05).unwrap_err().to_string();
    assert!(said.contains("2 joints and no names"), "{said}");
    let twice = folder.path().join("twice");
    bag(&twice, JOINT_STATES, |_| state(&["j", "j"], 1.0));
    let said = read(&twice, None, &DRIVING, 0.05).unwrap_err().to_string();
    assert!(said.contains("`j` twice"), "{said}");
}

#[test]
fn reads_both_kinds_of_force() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("bag");
    let mut bag = BagWriter::create(&dir, BagOptions::default()).unwrap();
    for i in 0..10u64 {
        let stamp = 1_600_000_000_000_000_000 + i * 1_000_000;
        let header = Header::at(stamp);
        let state = JointState {
            header: header.clone(),
            name: vec!["load_shaft".into()],
            position: vec![0.0],
            velocity: vec![i as f64],
            effort: vec![0.1],
        };
        bag.write(JOINT_STATES, stamp, &state).unwrap();
        let rig = RigMeasurement { header, voltage_applied: 1.0, ..RigMeasurement::default() };
        bag.write(RIG_MEASUREMENT, stamp, &rig).unwrap();
    }
    bag.finish().unwrap();
    let friction = read(&dir, None, &JointChoice::default(), 0.05).unwrap();
    assert!((friction.time_step - 1e-3).abs() < 1e-9);
    assert_eq!(friction.force, vec![0.1; 10]);
    assert_eq!(friction.velocity.as_ref().unwrap()[9], 9.0);
    assert!(friction.friction_only);
    let driven = read(&dir, Some(&Motor::SRV02), &JointChoice::default(), 0.05).unwrap();
    assert!((driven.force[0] - 0.2065).abs() < 1e-4 && !driven.friction_only);
}
