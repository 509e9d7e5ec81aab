//! Nodes and services seen over Cyclone DDS as `rmw_cyclonedds` puts them, while rclpy asks the
//! same ones over Fast DDS.

use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use std::time::Duration;

use msgs::std_srvs::{Trigger, TriggerRequest, TriggerResponse};
use msgs::type_hashes;
use ros_node::{Discovery, Participant};
use serde_json::{Value, json};
use tests::{
    network::{self, namespaced},
    python,
};

/// Set where a test runs itself in a namespace.
const INSIDE: &str = "FRICTION_CYCLONE_INSIDE";
/// Longest wait for an answer.
const PATIENCE: Duration = Duration::from_secs(30);

fn session() -> Value {
    let cyclone = python::cyclone();
    let rclpy = python::interpreter("rclpy");
    let mut command = namespaced();
    command.arg(cyclone).arg(python::script("cyclone_session.py")).arg(tests::node_programs());
    command.arg(tests::frictionlab().get_program()).arg(rclpy);
    command.env("ROS_DOMAIN_ID", "74").env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST");
    let (report, told) = network::report(command);
    // What Cyclone DDS cannot read it says.
    assert!(!told.contains("deserialization"), "{told}");
    report
}

#[tests::needs(rclpy, cyclone, namespace)]
#[test]
fn what_people_do_with_nodes_is_done_over_cyclone_beside_fast_dds() {
    let report = session();
    topics_pass_both_ways(&report["topics"]);
    parameters_are_listed_read_and_set(&report["parameters"]);
    states_change(&report["lifecycle"]);
    the_motor_is_stopped(&report);
    a_goal_has_feedback_and_a_result(&report["action"]);
    rclpy_is_served_at_the_same_time(&report);
    every_endpoint_tells_its_types_hash(&report);
}

fn topics_pass_both_ways(topics: &Value) {
    assert_eq!(topics["exchanged"], true, "{topics}");
    assert_eq!(topics["joint"], json!(["load_shaft"]));
}

fn parameters_are_listed_read_and_set(parameters: &Value) {
    let listed = parameters["listed"].as_u64().expect("a number");
    assert!(listed > 10, "{parameters}");
    let lists = parameters["lists"].as_array().expect("a list");
    assert!(lists.len() == 30 && lists.iter().all(|n| *n == listed), "{parameters}");
    assert_eq!(parameters["values"], json!([0.0, 1.5]));
    assert_eq!(parameters["set"][0], json!([true, ""]));
    assert_eq!(parameters["set"][1][0], false);
    assert!(
        parameters["set"][1][1].as_str().is_some_and(|why| why.contains("injection")),
        "{parameters}"
    );
}

fn states_change(lifecycle: &Value) {
    assert_eq!(lifecycle["states"], json!(["active", "inactive", "active"]));
    assert_eq!(lifecycle["wrong"], false);
}

fn the_motor_is_stopped(report: &Value) {
    assert_eq!(report["stop"]["success"], true, "{report}");
    assert_eq!(report["stop"]["again"], true, "{report}");
    let said = report["said"].as_str().expect("a text");
    assert!(
        said.contains("emergency_stop was not understood"),
        "a request that is too short: {said}"
    );
    // The environment asks for a middleware that nobody knows.
    assert!(said.contains("`rmw_cyclone`") && said.contains("rmw_cyclonedds_cpp"), "{said}");
}

fn a_goal_has_feedback_and_a_result(action: &Value) {
    assert_eq!(action["accepted"], true, "{action}");
    assert_eq!(action["result"][0], 4, "{action}");
    assert_eq!(action["result"][1], true, "{action}");
    assert_eq!(action["again"], true, "{action}");
    // It has ended: there is nothing to be cancelled (ERROR_GOAL_TERMINATED).
    assert_eq!(action["cancelled_late"], json!([3, 0]));
    assert!(action["feedback"].as_u64() > Some(0) && action["of_this_goal"] == true, "{action}");
}

fn rclpy_is_served_at_the_same_time(report: &Value) {
    let beside = &report["beside"];
    let lists = beside["lists"].as_array().expect("a list");
    assert!(
        !lists.is_empty() && lists.iter().all(|n| *n == report["parameters"]["listed"]),
        "{beside}"
    );
    assert_eq!(beside["stops"], lists.len(), "{beside}");
    let states = beside["states"].as_array().expect("a list");
    assert!(states.iter().all(|state| state == "active" || state == "inactive"), "{beside}");
    for (topic, kind) in [
        ("/joint_states", "sensor_msgs/msg/JointState"),
        ("/rosout", "rcl_interfaces/msg/Log"),
        ("/parameter_events", "rcl_interfaces/msg/ParameterEvent"),
        ("/rig_driver/transition_event", "lifecycle_msgs/msg/TransitionEvent"),
    ] {
        let hashes = beside["hashes"][topic].as_array().expect("a list");
        let expected = type_hashes::all()[kind];
        assert!(
            !hashes.is_empty() && hashes.iter().all(|hash| *hash == expected),
            "{topic}: {beside}"
        );
    }
    assert_eq!(beside["enclaves"], json!(["/"]));
}

fn every_endpoint_tells_its_types_hash(report: &Value) {
    let all = ["endpoints", "action_endpoints"].map(|of| report[of].as_array().expect("a list"));
    assert!(all.iter().all(|some| some.len() > 30), "{report}");
    for endpoint in all.into_iter().flatten() {
        let kind = endpoint[1].as_str().expect("a type");
        let expected = type_hashes::of_dds(kind).map(|hash| format!("typehash={hash};"));
        assert_eq!(endpoint[2].as_str(), expected.as_deref(), "{endpoint}");
    }
    let participants = report["participants"].as_array().expect("a list");
    assert_eq!(participants, &vec![json!("enclave=/;"); 3]);
}

#[tests::needs(cyclone, namespace)]
#[test]
fn a_server_of_cyclone_is_asked_as_it_reads() {
    if std::env::var_os(INSIDE).is_some() {
        return inside();
    }
    let cyclone = python::cyclone();
    let mut command = namespaced();
    let this = std::env::current_exe().expect("a test knows its program");
    let output = command
        .arg(this)
        .args(["--exact", "a_server_of_cyclone_is_asked_as_it_reads", "--nocapture"])
        .env(INSIDE, cyclone)
        .output()
        .expect("unshare starts");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}\n{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.contains("1 passed"), "{said}");
}

fn inside() {
    let cyclone = std::env::var_os(INSIDE).expect("the interpreter");
    let participant = Participant::join(&Discovery::default()).expect("joins");
    let node = participant.node("asker").expect("a node");
    let client = node.client::<Trigger>("/ping").expect("a client");
    let mut server = Command::new(cyclone)
        .arg(python::script("cyclone_server.py"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("Python starts");
    let mut line = String::new();
    BufReader::new(server.stdout.take().expect("its output is ours"))
        .read_line(&mut line)
        .expect("a line");
    let ping = TriggerRequest::default();
    let first = client.call_until_answered(&ping, PATIENCE).expect("an answer");
    assert!(first.message.starts_with("pong"), "{first:?}");
    // From here on each call is heard once.
    let count = |answer: &TriggerResponse| {
        answer.message["pong ".len()..].parse::<u32>().expect("a number")
    };
    for expected in (count(&first) + 1..).take(20) {
        let answer = client.call(ping, PATIENCE).expect("an answer");
        assert_eq!(count(&answer), expected);
    }
    drop(server.stdin.take());
    server.wait().expect("it ends");
    // One of the laboratory's own takes its place.
    let own = participant.node("server").expect("a node");
    own.serve::<Trigger>("/ping", |_| TriggerResponse { success: true, message: "own".into() })
        .expect("a service");
    let answer = client.call_until_answered(&ping, PATIENCE).expect("an answer");
    assert_eq!(answer.message, "own");
}
