//! Viewers that others wrote: a client of the view's protocol, and a viewer of bags. And the
//! layouts that are shipped for them.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use msgs::RosMessage;
use msgs::topics::{
    CONTROLLER_STATE, DIAGNOSTICS, EXPERIMENT_STATUS, FRICTION_ESTIMATE, JOINT_STATES,
    MOTOR_VOLTAGE, REFERENCE, RIG_MEASUREMENT, Topic,
};
use serde_json::{Value, json};
use tests::network::{namespaced, run_ignored, turn};
use tests::python;
use tests::tab::Tab;

/// Runs a test of this file that is ignored elsewhere, on a machine with loopback only.
fn inside(test: &str) {
    let _turn = turn();
    let program = tests::frictionlab().get_program().to_owned();
    run_ignored(namespaced(), test, &[("FRICTIONLAB_BIN", &program)]);
}

/// A program that is ended with the test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A text of the layouts' folder.
fn layout(name: &str) -> String {
    let file = tests::checkout().join("view/layouts").join(name);
    std::fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()))
}

/// Curves of Foxglove's layout, each as topic and steps: `/joint_states.position[0]`.
fn foxglove_paths() -> Vec<(String, Vec<String>)> {
    let tree: Value = serde_json::from_str(&layout("foxglove.json")).expect("a layout is JSON");
    let panels = tree["configById"].as_object().expect("panels").values();
    let mut found = Vec::new();
    for panel in panels {
        let paths = panel["paths"].as_array().into_iter().flatten();
        for path in paths.chain([&panel["xAxisPath"]]) {
            let Some(path) = path["value"].as_str() else { continue };
            let mut steps = path.replace('[', ".").replace(']', "");
            steps = steps.trim_start_matches('/').to_owned();
            let mut steps = steps.split('.').map(str::to_owned);
            found.push((format!("/{}", steps.next().expect("a topic")), steps.collect()));
        }
    }
    found
}

/// Curves of PlotJuggler's layout: `/rig_measurement/torque`.
fn plotjuggler_paths() -> Vec<(String, Vec<String>)> {
    let text = layout("plotjuggler.xml");
    let quoted = text.split('"').filter(|word| word.starts_with('/'));
    let split = |path: &str| {
        let mut steps = path.trim_start_matches('/').split('/').map(str::to_owned);
        (format!("/{}", steps.next().expect("a topic")), steps.collect())
    };
    // What stands between two elements is no value of an attribute.
    quoted.filter(|word| !word.contains('>')).map(split).collect()
}

/// What lies at the end of the steps.
fn at<'a>(message: &'a Value, steps: &[String]) -> Option<&'a Value> {
    steps.iter().try_fold(message, |value, step| match step.parse::<usize>() {
        Ok(number) => value.get(number),
        Err(_) => value.get(step.as_str()),
    })
}

#[test]
fn layouts_name_what_is_served() {
    fn usual<M: RosMessage + Default + serde::Serialize>(topic: &Topic<M>) -> (String, Value) {
        (topic.name.to_owned(), serde_json::to_value(M::default()).expect("a message"))
    }
    let mut messages = BTreeMap::from([
        usual(&JOINT_STATES),
        usual(&RIG_MEASUREMENT),
        usual(&REFERENCE),
        usual(&MOTOR_VOLTAGE),
        usual(&FRICTION_ESTIMATE),
        usual(&CONTROLLER_STATE),
        usual(&EXPERIMENT_STATUS),
        usual(&DIAGNOSTICS),
    ]);
    // One joint.
    for list in ["position", "velocity", "effort"] {
        messages.get_mut("/joint_states").expect("the topic")[list] = json!([0.0]);
    }
    let paths = [foxglove_paths(), plotjuggler_paths()];
    assert!(paths.iter().all(|paths| paths.len() > 8), "{paths:?}");
    for (topic, steps) in paths.concat() {
        let message = messages.get(&topic).unwrap_or_else(|| panic!("no topic {topic}"));
        let found = at(message, &steps);
        assert!(found.is_some_and(Value::is_number), "{topic} has no number at {steps:?}");
    }
}

#[tests::needs(namespace, viewer_client)]
#[test]
fn a_client_that_others_wrote_reads_everything() {
    inside("inside_client");
}

#[test]
#[ignore = "in a network namespace only"]
fn inside_client() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut live = Running(
        tests::frictionlab()
            .args(["live", "--serve", "--view", "--view-port", "0", "--out", "out"])
            .current_dir(folder.path())
            .env("ROS_DOMAIN_ID", "77")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .expect("it starts"),
    );
    let mut lines = BufReader::new(live.0.stdout.take().expect("its output is ours")).lines();
    let url = lines
        .by_ref()
        .map_while(Result::ok)
        .find_map(|line| Some(line.split_once("view: http")?.1.trim().to_owned()))
        .expect("a view");
    thread::spawn(move || lines.for_each(drop));
    let seen = Command::new("node")
        .arg(machine::viewer_client().join("client.mjs"))
        .arg(format!("ws{}", url.trim_end_matches('/')))
        .output()
        .expect("node starts");
    assert!(seen.status.success(), "{}", String::from_utf8_lossy(&seen.stderr));
    let seen: Value = serde_json::from_slice(&seen.stdout).expect("the client writes JSON");
    assert_eq!(seen["errors"], json!([]));
    for (topic, kind) in [
        (JOINT_STATES.name, "sensor_msgs/msg/JointState"),
        (RIG_MEASUREMENT.name, "friction_msgs/msg/RigMeasurement"),
        (REFERENCE.name, "friction_msgs/msg/Reference"),
        (MOTOR_VOLTAGE.name, "friction_msgs/msg/MotorVoltage"),
        (FRICTION_ESTIMATE.name, "friction_msgs/msg/FrictionEstimate"),
        (CONTROLLER_STATE.name, "friction_msgs/msg/ControllerState"),
    ] {
        let about = &seen["topics"][topic];
        assert_eq!(about["schemaName"], kind, "{topic}");
        assert_eq!(about["messages"], 20, "{topic}: {about}");
    }
    // Other topics are there with schemas that the client can read; nothing need happen on them.
    for topic in [EXPERIMENT_STATUS.name, DIAGNOSTICS.name, "/rosout"] {
        assert!(seen["topics"][topic].is_object(), "{topic}: {}", seen["topics"]);
    }
    for (topic, steps) in [foxglove_paths(), plotjuggler_paths()].concat() {
        let found = at(&seen["topics"][&topic]["last"], &steps);
        assert!(found.is_some_and(Value::is_number), "{topic} has no number at {steps:?}");
    }
    let parameters = seen["parameters"].as_array().expect("parameters");
    for node in ["/rig_driver.", "/friction_observer.", "/controller."] {
        let of_node =
            |one: &&Value| one["name"].as_str().is_some_and(|name| name.starts_with(node));
        assert!(parameters.iter().filter(of_node).count() > 5, "{node}");
    }
    assert_eq!(
        seen["set"],
        json!([{ "name": "/controller.reference_timeout", "value": 0.5, "type": "float64" }])
    );
    let services = seen["services"].as_object().expect("services");
    for node in ["rig_driver", "friction_observer", "controller"] {
        let state = &services[&format!("/{node}/get_state")]["answer"]["current_state"]["label"];
        assert_eq!(*state, "active", "{node}");
    }
    let experiments = &services["/experiment_runner/list_experiments"]["answer"]["experiments"];
    assert!(experiments.as_array().is_some_and(|list| list.len() > 5), "{experiments}");
    assert!(services.contains_key("/rig_driver/emergency_stop"));
}

/// A bag of four seconds of the loop, in a folder.
fn bag(folder: &Path) -> std::path::PathBuf {
    let run = tests::frictionlab()
        .args(["live", "--quiet", "--duration", "4", "--out", "out"])
        .current_dir(folder)
        .env("ROS_DOMAIN_ID", "77")
        .output()
        .expect("it starts");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    folder.join("out/bag/bag_0.mcap")
}

/// The viewer, which neither asks nor sends anything.
fn rerun(folder: &Path) -> Command {
    let mut command = Command::new(python::rerun());
    command.env("HOME", folder).env("RERUN_ANALYTICS", "false").current_dir(folder);
    command
}

#[tests::needs(namespace, rerun)]
#[test]
fn a_viewer_that_others_wrote_reads_the_bag() {
    inside("inside_reads_the_bag");
}

#[test]
#[ignore = "in a network namespace only"]
fn inside_reads_the_bag() {
    let folder = tempfile::tempdir().expect("a folder");
    let bag = bag(folder.path());
    let run = rerun(folder.path()).args(["mcap", "info"]).arg(&bag).output().expect("it starts");
    let told = String::from_utf8_lossy(&run.stdout) + String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "{told}");
    let ours = tests::frictionlab()
        .args(["bag", "info", "--json"])
        .arg(folder.path().join("out/bag"))
        .output()
        .expect("it starts");
    let ours: Value = serde_json::from_slice(&ours.stdout).expect("JSON");
    let topics = ours["topics"].as_array().expect("topics");
    assert!(topics.len() >= 6, "{ours}");
    for topic in topics.iter().filter(|topic| topic["messages"] != 0) {
        let (name, kind) = (topic["name"].as_str().unwrap(), topic["type"].as_str().unwrap());
        let count = topic["messages"].to_string();
        let found = told.lines().find(|line| line.split_whitespace().nth(1) == Some(name));
        let words: Vec<&str> = found.unwrap_or_default().split_whitespace().collect();
        assert!(words.contains(&count.as_str()) && words.contains(&kind), "{name}: {told}");
    }
}

#[tests::needs(chromium, namespace, rerun, long_tier)]
#[test]
fn a_viewer_that_others_wrote_shows_the_curves_of_a_bag() {
    inside("inside_shows_curves");
}

#[test]
#[ignore = "in a network namespace only"]
fn inside_shows_curves() {
    let folder = tempfile::tempdir().expect("a folder");
    let bag = bag(folder.path());
    let _viewer = Running(
        rerun(folder.path())
            .arg(&bag)
            .args(["--serve-web", "--web-viewer-port", "9090", "--port", "9876"])
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("it starts"),
    );
    let until = Instant::now() + Duration::from_secs(60);
    for port in [9090_u16, 9876] {
        while std::net::TcpStream::connect(("127.0.0.1", port)).is_err() {
            assert!(Instant::now() < until, "the viewer does not listen");
            thread::sleep(Duration::from_millis(100));
        }
    }
    let mut tab = Tab::drawing();
    tab.look(1400, false);
    tab.go("http://127.0.0.1:9090/?url=rerun%2Bhttp%3A%2F%2F127.0.0.1%3A9876%2Fproxy");
    // The curves of position, velocity and effort have a colour each.
    let mut eyes = Tab::open();
    let until = Instant::now() + Duration::from_secs(180);
    let picture = Path::new(env!("CARGO_TARGET_TMPDIR")).join("rerun.png");
    loop {
        tab.picture(&picture);
        let colours = tests::pictures::strong_colours(&mut eyes, &picture);
        if colours.len() >= 3 && colours.values().all(|&count| count > 300) {
            break;
        }
        assert!(Instant::now() < until, "no curves in {}: {colours:?}", picture.display());
        thread::sleep(Duration::from_secs(1));
    }
}
