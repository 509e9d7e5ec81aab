//! `frictionlab launch` and its nodes before the real rclpy, on a PC that looks for others on its
//! network; its commands beside those of the launch files.

use std::collections::BTreeMap;
use std::process::Command;

use msgs::interfaces::{ACTIONS, EVERY_NODE, NODES, SERVICES, topics};
use recording::bag::BagReader;
use serde_json::{Value, json};
use tests::{
    network::{Place, session_at},
    python::{self, Distribution},
};

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

/// Names with their types, without those that every node of rcl has or that belong to an action.
fn named(value: &Value) -> BTreeMap<String, String> {
    value
        .as_object()
        .expect("names with types")
        .iter()
        .filter(|(name, _)| !name.contains("/_action/"))
        .map(|(name, types)| (name.clone(), text(&types[0]).to_owned()))
        .collect()
}

/// What the tables say that a node publishes and hears, beside what every node has.
fn topics_of(node: &str) -> [BTreeMap<String, String>; 2] {
    let of = |pick: fn(&msgs::interfaces::TopicInterface) -> &'static [&'static str]| {
        topics()
            .iter()
            .filter(|topic| pick(topic).contains(&node))
            .map(|t| (t.name.to_owned(), t.kind.clone()))
            .collect()
    };
    let mut publishes: BTreeMap<String, String> = of(|topic| topic.publishers);
    let mut hears: BTreeMap<String, String> = of(|topic| topic.subscribers);
    publishes.insert("/rosout".into(), "rcl_interfaces/msg/Log".into());
    publishes.insert("/parameter_events".into(), "rcl_interfaces/msg/ParameterEvent".into());
    publishes
        .insert(format!("/{node}/transition_event"), "lifecycle_msgs/msg/TransitionEvent".into());
    hears.insert("/clock".into(), "rosgraph_msgs/msg/Clock".into());
    [publishes, hears]
}

fn services_of(node: &str) -> BTreeMap<String, String> {
    let own = SERVICES.iter().filter(|of| of.node == node).map(|of| (of.name, of.kind));
    let every = EVERY_NODE.iter().map(|(name, kind, _)| (*name, *kind));
    own.chain(every).map(|(name, kind)| (format!("/{node}/{name}"), kind.to_owned())).collect()
}

#[tests::needs(rclpy, machines)]
#[test]
fn launched_nodes_offer_what_the_tables_say_and_end_together() {
    let program = tests::frictionlab();
    let program = program.get_program().to_str().expect("a plain path");
    let folder = tempfile::tempdir().expect("a folder");
    let bag = folder.path().join("bag");
    let report = session_at(
        Place::OnePcOnItsNetwork,
        Distribution::Kilted,
        "launch_session.py",
        &[program, bag.to_str().expect("a plain path")],
    );
    for node in NODES {
        let offered = &report["offered"][node];
        let [publishes, hears] = topics_of(node);
        let said = named(&offered["publishes"]);
        // Each participant tells of its parameter events once, at whichever of its nodes.
        assert_eq!(said, publishes, "{node} publishes");
        assert_eq!(named(&offered["hears"]), hears, "{node} hears");
        assert_eq!(named(&offered["serves"]), services_of(node), "{node} serves");
        let actions: BTreeMap<String, String> = ACTIONS
            .iter()
            .filter(|of| of.node == node)
            .map(|of| (format!("/{node}/{}", of.name), of.kind.to_owned()))
            .collect();
        assert_eq!(named(&offered["acts"]), actions, "actions of {node}");
    }
    assert_eq!(report["model"], json!(["lugre"]), "the argument model:= reaches the observer");
    assert_eq!(
        report["children"],
        json!(["controller", "experiment_runner", "friction_observer", "rig_driver"])
    );
    beside_running_nodes(&report["doctor"]);

    let interrupted = &report["interrupted"];
    assert_eq!(interrupted["code"], 0, "{interrupted}");
    assert!(interrupted["seconds"].as_f64().is_some_and(|seconds| seconds < 2.5), "{interrupted}");
    assert_eq!((&report["left"], &report["gone"]), (&json!([]), &json!(true)));
    assert!(
        text(&interrupted["said"]).lines().any(|line| line.starts_with("[rig_driver] ")),
        "{interrupted}"
    );

    assert_eq!(report["in_namespace"], true);
    let killed = &report["killed"];
    assert_eq!((&killed["code"], &report["left_after_kill"]), (&json!(1), &json!([])), "{killed}");
    assert!(
        text(&killed["said"]).contains("axis_1/friction_observer has ended by itself (signal 9)"),
        "{killed}"
    );

    // The recorder ends with the others, its bag whole.
    let bag = BagReader::open(&bag).expect("a whole bag");
    for topic in [
        "/axis_1/joint_states",
        "/axis_1/motor_voltage",
        "/axis_1/friction_estimate",
        "/diagnostics",
    ] {
        let of = bag.topics().iter().find(|of| of.name == topic).expect(topic);
        assert!(of.count > if topic == "/diagnostics" { 1 } else { 1000 }, "{topic}: {}", of.count);
    }
}

/// The doctor's figures beside a loop that runs.
fn beside_running_nodes(doctor: &Value) {
    let sections = doctor["found"]["sections"].as_array().expect("sections");
    let finding = |section: &str, subject: &str| -> Value {
        sections
            .iter()
            .filter(|found| found["name"] == section)
            .flat_map(|found| found["findings"].as_array().expect("findings"))
            .find(|found| found["subject"] == subject)
            .unwrap_or_else(|| panic!("no finding on {subject} in {section}: {doctor}"))
            .clone()
    };
    for node in NODES {
        finding("Other nodes", &format!("/{node}"));
    }
    assert!(
        text(&finding("Other nodes", "/rig_driver")["found"]).contains("lifecycle state active"),
        "{doctor}"
    );
    assert!(
        text(&finding("Other nodes", "/experiment_runner")["found"])
            .contains("lifecycle state active"),
        "{doctor}"
    );
    let timing = finding("Control loops", "/rig_driver");
    let figures = timing["figures"].as_array().expect("figures");
    for name in ["command age p50", "command age p99", "period p50", "period p99"] {
        let figure = figures.iter().find(|figure| figure["name"] == name).expect(name);
        assert!(
            figure["value"].as_f64().is_some_and(|value| value > 0.0) && figure["unit"] == "us",
            "{figure}"
        );
    }
}

/// The commands of `frictionlab launch --show`, one list of words a process.
fn shown(arguments: &[String]) -> Vec<Vec<String>> {
    let output = tests::frictionlab()
        .arg("launch")
        .arg("--show")
        .args(arguments)
        .output()
        .expect("it starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout)
        .lines()
        // A node of its own executable there is the same node in `frictionlab` here.
        .map(|line| line.strip_prefix("frictionlab node ").unwrap_or(line))
        .map(|line| line.split_whitespace().map(str::to_owned).collect())
        .collect()
}

#[tests::needs(bag_tools)]
#[test]
fn launch_starts_what_the_launch_files_start() {
    let python = python::interpreter("bag_tools");
    let bringup = tests::checkout().join("launch_configs");
    let config = bringup.join("config").canonicalize().expect("the folder of parameter files");
    let folder = tempfile::tempdir().expect("a folder");
    let parameters = folder.path().join("parameters.yaml");
    std::fs::write(&parameters, "{}").expect("the folder can be written");
    let params_file = format!("params_file:={}", parameters.display());
    let record = format!("record:={}", folder.path().join("bag").display());
    let cases: [(&str, &str, &[&str]); 7] = [
        ("friction.launch.py", "friction", &[]),
        (
            "friction.launch.py",
            "friction",
            &["rig:=simulated", "mode:=velocity", "model:=proposed"],
        ),
        (
            "friction.launch.py",
            "friction",
            &["rig:=serial:/dev/ttyACM0@115200", "mode:=position", "log_level:=debug"],
        ),
        ("friction.launch.py", "friction", &["namespace:=axis_1", "model:=gms", &params_file]),
        ("friction.launch.py", "friction", &["namespace:=axis_1", &record]),
        ("two_axes.launch.py", "two-axes", &[]),
        ("two_axes.launch.py", "two-axes", &["rig_2:=serial:/dev/ttyACM1", "model_1:=lugre"]),
    ];
    for (file, ours, given) in cases {
        let file = bringup.join("launch").join(file).canonicalize().expect("a launch file");
        let words: Vec<&str> = std::iter::once(file.to_str().expect("a plain path"))
            .chain(given.iter().copied())
            .collect();
        let theirs = python::json(&python, "launch_commands.py", &words);
        let theirs: Vec<Vec<String>> = theirs
            .as_array()
            .expect("processes")
            .iter()
            .map(|process| serde_json::from_value(process["command"].clone()).expect("words"))
            .collect();
        let arguments: Vec<String> =
            ["--file".to_owned(), ours.to_owned(), format!("files:={}", config.display())]
                .into_iter()
                .chain(given.iter().map(|text| (*text).to_owned()))
                .collect();
        let mut ours = shown(&arguments);
        if ours[0][0] == "frictionlab" {
            // There is no `ros2` here to record with.
            assert!(theirs[0][0] == "ros2" && ours[0][1..3] == ["bag", "record"], "{:?}", ours[0]);
            ours[0].clone_from(&theirs[0]);
        }
        assert_eq!(ours, theirs, "{given:?}");
    }
}

#[test]
fn launch_refuses_what_cannot_be_and_names_a_missing_program() {
    for (given, said) in [
        ("mode:=torque", "velocity or position"),
        ("rig:=seriel:/dev/ttyACM0", "serial:PORT"),
        ("spin:=fast", "there is no argument `spin`"),
    ] {
        let output = tests::frictionlab().args(["launch", given]).output().expect("it starts");
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{given}: {message}");
        assert!(message.contains(said), "{given}: {message}");
    }
}

/// One program is all that `cargo install` has to install.
#[test]
fn frictionlab_alone_in_a_folder_has_the_nodes_in_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let alone = folder.path().join("frictionlab");
    std::fs::copy(tests::frictionlab().get_program(), &alone).expect("a copy");
    let run = |arguments: &[&str]| {
        let output = Command::new(&alone)
            .args(arguments)
            .env("PATH", folder.path())
            .output()
            .expect("it starts");
        (
            output.status.code(),
            String::from_utf8_lossy(&output.stdout).into_owned(),
            String::from_utf8_lossy(&output.stderr).into_owned(),
        )
    };
    let (code, shown, _) = run(&["launch", "--show"]);
    assert_eq!(code, Some(0));
    for node in ["rig_driver", "friction_observer", "controller", "experiment_runner"] {
        assert!(shown.contains(&format!("\nfrictionlab node {node} --ros-args")), "{shown}");
        let (code, help, _) = run(&["node", node, "--help"]);
        assert!(code == Some(0) && help.contains(&format!("Usage: {node} [--ros-args")), "{help}");
        let (code, _, message) = run(&["node", node, "spin"]);
        assert!(
            code == Some(2) && message.contains("the argument `spin` is unknown"),
            "{code:?} {message}"
        );
    }
}
