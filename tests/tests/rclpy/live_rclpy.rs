//! `frictionlab live` heard by the real rclpy, in a network namespace of its own.

use std::collections::HashMap;
use std::path::Path;

use msgs::friction_msgs::{FrictionEstimate, MotorVoltage};
use msgs::sensor_msgs::JointState;
use recording::bag::BagReader;
use serde_json::Value;
use tests::{network::namespaced, python};

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

/// What rclpy received on a topic, by stamp.
fn received(report: &Value, topic: &str) -> Vec<(u64, Vec<u64>)> {
    let messages = report["topics"][topic].as_array().expect("a list");
    let number = |value: &Value| value.as_u64().expect("a whole number");
    messages
        .iter()
        .map(|message| {
            (
                number(&message[0]),
                message[1].as_array().expect("values").iter().map(number).collect(),
            )
        })
        .collect()
}

/// Each received message is in the bag with its stamp and every value to the last bit, in order and
/// each once, and between the first and the last of them hardly one is missing.
fn assert_same(topic: &str, received: &[(u64, Vec<u64>)], recorded: &HashMap<u64, Vec<u64>>) {
    // Discovery takes a second or two of the six; after that it is a thousand a second.
    assert!(received.len() > 1500, "{topic}: only {} messages arrived", received.len());
    assert!(
        received.windows(2).all(|pair| pair[0].0 < pair[1].0),
        "{topic}: out of order or twice"
    );
    for (stamp, values) in received {
        assert_eq!(
            recorded.get(stamp),
            Some(values),
            "{topic}: the message of {stamp} against the bag"
        );
    }
    let (first, last) = (received[0].0, received[received.len() - 1].0);
    let sent = recorded.keys().filter(|stamp| (first..=last).contains(stamp)).count();
    assert!(received.len() * 100 >= sent * 95, "{topic}: {} of {sent} arrived", received.len());
    let rate = (sent - 1) as f64 / ((last - first) as f64 * 1e-9);
    assert!((rate - 1000.0).abs() < 1.0, "{topic}: stamps come at {rate} Hz");
}

#[tests::needs(rclpy, namespace)]
#[test]
fn rclpy_receives_what_the_bag_holds() {
    let python = python::interpreter("rclpy");
    let _turn = tests::network::turn();
    let mut command = namespaced();
    let folder = tempfile::tempdir().expect("a folder");
    let (result, out) = (folder.path().join("received.json"), folder.path().join("run"));
    let program = tests::frictionlab();
    let output = command
        .arg(&python)
        .arg(python::script("live_session.py"))
        .arg(&result)
        .arg(program.get_program())
        .args([
            "live",
            "--duration",
            "6",
            "--seed",
            "3",
            "--model",
            "lugre",
            "--amplitude",
            "1.5",
            "--frequency",
            "3",
        ])
        .arg("--out")
        .arg(&out)
        .env("ROS_DOMAIN_ID", "73")
        .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        .env("ROS_LOG_DIR", folder.path().join("log"))
        .output()
        .expect("unshare starts");
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{told}");
    let text = std::fs::read_to_string(&result).expect("the listener's result");
    let report: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(report["exit_code"], 0, "{told}");
    check(&report, &out.join("bag"));
}

fn check(report: &Value, bag: &Path) {
    let bag = BagReader::open(bag).expect("the run's bag");
    let joints = bag.messages::<JointState>("/joint_states").expect("joint states");
    assert_eq!(joints.len(), 6000, "the bag has every cycle");
    for (log_time, message) in &joints {
        assert_eq!(message.header.stamp.to_nanos(), *log_time);
    }
    let joints: HashMap<_, _> = joints
        .into_iter()
        .map(|(stamp, m)| (stamp, bits(&[m.position[0], m.velocity[0], m.effort[0]])))
        .collect();
    assert_same("/joint_states", &received(report, "/joint_states"), &joints);

    let estimates: HashMap<_, _> = bag
        .messages::<FrictionEstimate>("/friction_estimate")
        .expect("estimates")
        .into_iter()
        .map(|(stamp, m)| {
            let values =
                [m.torque, m.deflection, m.gamma, f64::from(m.regime), m.velocity, m.residual];
            (stamp, bits(&values))
        })
        .collect();
    assert_same("/friction_estimate", &received(report, "/friction_estimate"), &estimates);

    let voltages: HashMap<_, _> = bag
        .messages::<MotorVoltage>("/motor_voltage")
        .expect("voltages")
        .into_iter()
        .map(|(stamp, m)| (stamp, bits(&[m.voltage])))
        .collect();
    assert_same("/motor_voltage", &received(report, "/motor_voltage"), &voltages);

    assert_eq!(report["joint_names"], serde_json::json!(["load_shaft"]));
    assert_eq!(report["models"], serde_json::json!(["lugre"]));
    let nodes: Vec<&str> =
        report["nodes"].as_array().expect("names").iter().filter_map(Value::as_str).collect();
    for node in ["rig_driver", "friction_observer", "controller", "experiment_runner"] {
        assert!(nodes.contains(&node), "{node} is not among {nodes:?}");
    }
    let diagnostics = report["diagnostics"].as_array().expect("diagnostics every second");
    let health = diagnostics.iter().rfind(|health| health["not recorded"].is_string());
    let health = health.expect("diagnostics of the loop");
    assert!(health["period p99 [us]"].is_string() && health["overruns"].is_string(), "{health}");
}
