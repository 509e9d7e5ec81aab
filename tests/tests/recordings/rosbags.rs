//! A bag of the laboratory in other people's readers: types out of the bag, counts, stamps, values.

use std::process::Command;

use msgs::RosMessage;
use msgs::diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue};
use msgs::friction_msgs::{
    ControllerState, ExperimentDescription, ExperimentStatus, FrictionEstimate, IdentifyRequest,
    IdentifyResponse, ListExperimentsRequest, ListExperimentsResponse, MotorVoltage, Reference,
    RigMeasurement, RunExperimentFeedback, RunExperimentGoal, RunExperimentResult,
    StartExperimentRequest, StartExperimentResponse,
};
use msgs::sensor_msgs::JointState;
use msgs::std_msgs::Header;
use msgs::std_srvs::{TriggerRequest, TriggerResponse};
use msgs::type_hashes;
use recording::bag::{BagOptions, BagWriter};
use serde_json::json;
use tests::python;

const START: u64 = 1_600_000_000_000_000_000;

fn stamp(index: u64) -> u64 {
    START + index * 1_000_000
}

fn joint_state(index: u64) -> JointState {
    JointState {
        header: Header::at(stamp(index)),
        name: vec!["load_shaft".into()],
        position: vec![0.25 * index as f64],
        velocity: vec![1.0],
        effort: vec![-0.5],
    }
}

#[tests::needs(bag_tools)]
#[test]
fn rosbags_reads_types_counts_and_stamps_out_of_the_bag() {
    let python = python::interpreter("bag_tools");
    let folder = tempfile::tempdir().expect("a folder");
    let dir = folder.path().join("bag");
    let mut bag = BagWriter::create(&dir, BagOptions::default()).expect("a new bag");
    for index in 0..1000 {
        bag.write("/joint_states", stamp(index), &joint_state(index)).expect("a write");
        let estimate = FrictionEstimate {
            header: Header::at(stamp(index)),
            model: "lugre".into(),
            torque: 0.125,
            regime: FrictionEstimate::SLIP,
            ..Default::default()
        };
        bag.write("/friction_estimate", stamp(index), &estimate).expect("a write");
    }
    let header = Header::at(stamp(999));
    let status =
        ExperimentStatus { header: header.clone(), stage: "done".into(), ..Default::default() };
    bag.write("/experiment_status", stamp(999), &status).expect("a write");
    let values = vec![KeyValue { key: "overruns".into(), value: "0".into() }];
    let health = DiagnosticStatus { values, ..Default::default() };
    bag.write(
        "/diagnostics",
        stamp(999),
        &DiagnosticArray { header: header.clone(), status: vec![health] },
    )
    .expect("a write");
    bag.write(
        "/rig_measurement",
        stamp(999),
        &RigMeasurement { header: header.clone(), ..Default::default() },
    )
    .expect("a write");
    bag.write(
        "/controller_state",
        stamp(999),
        &ControllerState { header: header.clone(), ..Default::default() },
    )
    .expect("a write");
    bag.write(
        "/reference",
        stamp(999),
        &Reference { header: header.clone(), ..Default::default() },
    )
    .expect("a write");
    bag.write("/motor_voltage", stamp(999), &MotorVoltage { header, voltage: 1.5 })
        .expect("a write");
    bag.finish().expect("the end");

    let seen = python::json(&python, "read_bag.py", &[dir.to_str().expect("a plain path")]);
    assert_eq!(seen["message_count"], 2006);
    assert_eq!(seen["start_time"], START);
    // rosbags counts the end as the nanosecond behind the last message.
    assert!(
        [999_000_000, 999_000_001].contains(&seen["duration"].as_u64().expect("a duration")),
        "{}",
        seen["duration"]
    );
    assert_eq!(seen["ros_distro"], "kilted");
    let expected = [
        ("/joint_states", JointState::type_name(), JointState::TYPE_HASH, 1000, 100, "VOLATILE"),
        (
            "/friction_estimate",
            FrictionEstimate::type_name(),
            FrictionEstimate::TYPE_HASH,
            1000,
            100,
            "VOLATILE",
        ),
        (
            "/experiment_status",
            ExperimentStatus::type_name(),
            ExperimentStatus::TYPE_HASH,
            1,
            1,
            "TRANSIENT_LOCAL",
        ),
        (
            "/diagnostics",
            DiagnosticArray::type_name(),
            DiagnosticArray::TYPE_HASH,
            1,
            10,
            "VOLATILE",
        ),
        (
            "/rig_measurement",
            RigMeasurement::type_name(),
            RigMeasurement::TYPE_HASH,
            1,
            100,
            "VOLATILE",
        ),
        (
            "/controller_state",
            ControllerState::type_name(),
            ControllerState::TYPE_HASH,
            1,
            100,
            "VOLATILE",
        ),
        ("/reference", Reference::type_name(), Reference::TYPE_HASH, 1, 100, "VOLATILE"),
        ("/motor_voltage", MotorVoltage::type_name(), MotorVoltage::TYPE_HASH, 1, 100, "VOLATILE"),
    ];
    for (topic, type_name, hash, count, depth, durability) in expected {
        let topic_seen = &seen["topics"][topic];
        assert_eq!(topic_seen["type"], json!(type_name), "{topic}");
        assert_eq!(topic_seen["digest"], json!(hash), "{topic}");
        assert_eq!(topic_seen["count"], count, "{topic}");
        assert_eq!(topic_seen["depth"], depth, "{topic}");
        assert_eq!(topic_seen["reliability"], "RELIABLE", "{topic}");
        assert_eq!(topic_seen["durability"], durability, "{topic}");
        assert_eq!(topic_seen["messages"].as_array().map(Vec::len), Some(count), "{topic}");
        assert_eq!(seen["mcap_ros2"][topic], count, "{topic} by mcap-ros2-support");
    }
    let joints = seen["topics"]["/joint_states"]["messages"].as_array().expect("messages");
    for (index, joint) in (0..).zip(joints) {
        assert_eq!(joint["log_time"], stamp(index));
        assert_eq!(joint["stamp"], stamp(index));
        assert_eq!(joint["name"], json!(["load_shaft"]));
        assert_eq!(joint["position"], json!([0.25 * index as f64]));
        assert_eq!(joint["effort"], json!([-0.5]));
    }
    let estimate = &seen["topics"]["/friction_estimate"]["messages"][500];
    assert_eq!((&estimate["model"], &estimate["regime"]), (&json!("lugre"), &json!(1)));
    assert_eq!(estimate["torque"], 0.125);
    assert_eq!(seen["topics"]["/experiment_status"]["messages"][0]["stage"], "done");
    assert_eq!(seen["topics"]["/motor_voltage"]["messages"][0]["voltage"], 1.5);
}

#[tests::needs(rclpy)]
#[test]
fn type_hashes_are_those_that_ros_generates() {
    let python = python::interpreter("rclpy");
    fn of<M: RosMessage>() -> (String, &'static str) {
        (M::type_name(), M::TYPE_HASH)
    }
    let ours = [
        of::<JointState>(),
        of::<Header>(),
        of::<DiagnosticArray>(),
        of::<RigMeasurement>(),
        of::<Reference>(),
        of::<MotorVoltage>(),
        of::<FrictionEstimate>(),
        of::<ControllerState>(),
        of::<ExperimentStatus>(),
        of::<ExperimentDescription>(),
        of::<RunExperimentGoal>(),
        of::<RunExperimentResult>(),
        of::<RunExperimentFeedback>(),
        of::<StartExperimentRequest>(),
        of::<StartExperimentResponse>(),
        of::<ListExperimentsRequest>(),
        of::<ListExperimentsResponse>(),
        of::<IdentifyRequest>(),
        of::<IdentifyResponse>(),
        of::<TriggerRequest>(),
        of::<TriggerResponse>(),
    ];
    let announced = type_hashes::all().iter().map(|(name, hash)| (name.clone(), *hash));
    let ours: Vec<_> = ours.into_iter().chain(announced).collect();
    let names: Vec<&str> = ours.iter().map(|(name, _)| name.as_str()).collect();
    let generated = python::json(&python, "type_hashes.py", &names);
    for (name, hash) in &ours {
        assert_eq!(generated[name], json!(hash), "{name}");
    }
}

#[tests::needs(bag_tools)]
#[test]
fn the_python_package_makes_a_table_of_a_bag() {
    let python = python::interpreter("bag_tools");
    let folder = tempfile::tempdir().expect("a folder");
    let dir = folder.path().join("bag");
    let mut bag = BagWriter::create(&dir, BagOptions::default()).expect("a new bag");
    for index in 0..10 {
        bag.write("/joint_states", stamp(index), &joint_state(index)).expect("a write");
        // Every second cycle only: the table has a gap where nothing was recorded.
        if index % 2 == 0 {
            let message = MotorVoltage { header: Header::at(stamp(index)), voltage: index as f64 };
            bag.write("/motor_voltage", stamp(index), &message).expect("a write");
        }
    }
    bag.finish().expect("the end");

    let package = tests::checkout().join("python");
    let csv = folder.path().join("table.csv");
    let run = |arguments: &[&std::ffi::OsStr]| {
        Command::new(&python)
            .env("PYTHONPATH", &package)
            .args(arguments)
            .output()
            .expect("Python starts")
    };
    let output =
        run(&["-m".as_ref(), "friction_analysis.table".as_ref(), dir.as_ref(), csv.as_ref()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = std::fs::read_to_string(&csv).expect("the table");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "t_s,position_rad,velocity_rad_s,torque_Nm,voltage_V");
    assert_eq!(lines.len(), 11);
    assert_eq!(lines[3], "0.002,0.5,1.0,-0.5,2.0");
    assert_eq!(lines[4], "0.003,0.75,1.0,-0.5,");

    let nowhere = folder.path().join("nowhere");
    let output =
        run(&["-m".as_ref(), "friction_analysis.table".as_ref(), nowhere.as_ref(), csv.as_ref()]);
    let complaint = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{complaint}");
    assert!(complaint.contains("nowhere") && !complaint.contains("Traceback"), "{complaint}");
}
