//! The nodes of `frictionlab live` before the real rclpy: what the executables offer, in one
//! process, on a PC with a network card.

use std::path::Path;

use msgs::friction_msgs::{FrictionEstimate, Reference};
use msgs::sensor_msgs::JointState;
use recording::bag::BagReader;
use serde_json::{Value, json};
use tests::network::Place;
use tests::python;

/// Time in which a program that is asked to end has ended, on a busy machine too \[s\].
const SOON: f64 = 30.0;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

/// What the session `script` in `folder` reports.
fn session(script: &str, folder: &Path) -> Value {
    let python = python::interpreter("rclpy");
    let _turn = tests::network::turn();
    let mut command = Place::OnePc.command();
    let output = command
        .arg(&python)
        .arg(python::script(script))
        .arg(tests::frictionlab().get_program())
        .arg(folder)
        .env("ROS_DOMAIN_ID", "75")
        .env("ROS_LOG_DIR", folder.join("log"))
        .output()
        .expect("unshare starts");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}");
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}\n{told}"))
}

#[tests::needs(rclpy, machines)]
#[test]
fn one_process_offers_what_the_executables_offer_and_its_loop_obeys() {
    let folder = tempfile::tempdir().expect("a folder");
    let report = session("live_nodes_session.py", folder.path());
    assert_eq!(report["active"], true, "{report}");
    for node in ["/rig_driver", "/friction_observer", "/controller", "/experiment_runner"] {
        assert!(
            report["nodes"].as_array().is_some_and(|nodes| nodes.contains(&json!(node))),
            "{report}"
        );
    }
    // The options are the parameters.
    let given = &report["given"];
    assert_eq!(given["rig"], json!(["simulated", "lugre", 7, true]));
    assert_eq!(given["observer"], json!(["dahl", "velocity", "feedback"]));
    assert_eq!(given["controller"], json!(["velocity", true, "lag", 1.5136]));
    assert_eq!(given["runner"], json!(["runs"]));
    assert_eq!(report["states"], json!(["active", "active", "active", "active"]));
    assert!(text(&report["described"][0]).contains("[N/m or N m/rad]"), "{}", report["described"]);
    assert_eq!(report["described"][1], "above 0");
    assert!(
        report["experiments"]
            .as_array()
            .is_some_and(|all| all.contains(&json!("constant-velocity"))),
        "{}",
        report["experiments"]
    );
    // Set while the loop runs.
    assert_eq!(report["set"], json!([[true, ""]]));
    assert_eq!(report["models"], json!([["dahl"], ["lugre"]]));
    assert_eq!(report["events"], json!([["/friction_observer", "model", "lugre"]]));
    assert!(
        report["refused"][0][0] == false
            && text(&report["refused"][0][1]).contains("0 to 2, but is 3")
    );
    assert!(report["refused"][1][0] == false && text(&report["refused"][1][1]).contains("above 0"));
    assert_eq!(report["scale"], json!([1.0]));
    // The motor moves in active only.
    let moves = |what: &str| number(&report[what][0]) > 0.5 && number(&report[what][1]) > 0.3;
    assert!(moves("moving") && moves("moving_again") && moves("closed_again"), "{report}");
    assert_eq!(
        (&report["deactivate"], &report["still"]),
        (&json!([true, "inactive"]), &json!([0.0, 0.0]))
    );
    assert_eq!(report["activate"], json!([true, "active"]));
    assert_eq!(
        (&report["observer_off"], &report["silent"]),
        (&json!([true, "inactive"]), &json!(0))
    );
    assert_eq!(report["uncompensated"], 0.0, "an estimate that does not come is not compensated");
    assert_eq!((&report["observer_on"], &report["reset"]), (&json!(true), &json!([true, true])));
    let commands = &report["commands"];
    assert_eq!(
        (&commands[0][0], &commands[0][2]),
        (&json!(0), &json!("0")),
        "its own are none: {commands}"
    );
    assert_eq!(commands[1][0], 2, "{commands}");
    assert!(
        text(&commands[1][1]).contains("while the controller in this process commands"),
        "{commands}"
    );
    assert!(moves("nan_from_elsewhere") && report["nan_from_elsewhere"][2] == "active", "{report}");
    assert_eq!(
        (&report["nobody_inherits"], &report["handed_over"]),
        (&json!(0), &json!([true, true])),
        "{report}"
    );
    assert_eq!(
        (&report["controller_off"], &report["open_loop"]),
        (&json!(true), &json!([2.5])),
        "{report}"
    );
    assert_eq!((&report["stop"][0], &report["stopped"]), (&json!(true), &json!([0.0, 0.0])));
    assert_eq!((&report["activate_stopped"], &report["clear"][0]), (&json!(false), &json!(true)));
    assert_eq!(report["configure"], json!([true, true, true]));
    assert!(moves("after_stop"), "{report}");
    // A reference from elsewhere.
    assert_eq!((&report["ready"], &report["scale_given"]), (&json!(true), &json!([0.75])));
    // It stands, within a step of the encoder (1.5 mrad) or two.
    assert!(number(&report["without_reference"][1]).abs() < 0.004, "{report}");
    // The lag compensator leaves an error under friction that is compensated in part.
    assert!((number(&report["velocity"]) + 1.5).abs() < 0.35, "{}", report["velocity"]);
    assert!(number(&report["reference_gone"][1]) < 0.05, "{}", report["reference_gone"]);
    for exit in ["own_exit", "ros_exit"] {
        assert!(report[exit][0] == 0 && number(&report[exit][1]) < SOON, "{}", report[exit]);
    }
    check_bags(folder.path());
}

#[tests::needs(rclpy, machines)]
#[test]
fn two_processes_are_two_axes_of_one_domain() {
    let folder = tempfile::tempdir().expect("a folder");
    let report = session("live_axes_session.py", folder.path());
    assert_eq!(report["follow"], true, "each its own reference: {}", report["velocities"]);
    let names = ["controller", "experiment_runner", "friction_observer", "rig_driver"];
    let nodes: Vec<String> = ["/axis_1", "/axis_2"]
        .iter()
        .flat_map(|axis| names.map(|name| format!("{axis}/{name}")))
        .collect();
    assert_eq!(report["nodes"], json!(nodes));
    assert_eq!((&report["stop"][0], &report["stands"]), (&json!(true), &json!(true)), "{report}");
    assert_eq!(report["other_goes_on"], true, "{report}");
    for exit in report["exits"].as_array().expect("exits") {
        assert!(exit[0] == 0 && number(&exit[1]) < SOON, "{exit}");
    }
}

/// The bags hold what was published, the parameter file beside it, and estimates only while the
/// observer was active.
fn check_bags(folder: &Path) {
    let bag = BagReader::open(&folder.join("own/bag")).expect("the first bag");
    let attached = bag.attachment("parameters.yaml").expect("a whole bag").expect("the parameters");
    assert!(String::from_utf8_lossy(&attached).contains("model: dahl"));
    let (joints, estimates) = (
        bag.messages::<JointState>("/joint_states").expect("joint states"),
        bag.messages::<FrictionEstimate>("/friction_estimate").expect("estimates"),
    );
    assert!(
        joints.len() > 5000 && estimates.len() + 500 < joints.len(),
        "{} {}",
        joints.len(),
        estimates.len()
    );
    let bag = BagReader::open(&folder.join("ros/bag")).expect("the second bag");
    let references = bag.messages::<Reference>("/reference").expect("references");
    assert!(references.iter().any(|(_, reference)| reference.velocity == -1.5));
}
