//! What the nodes tell of themselves before anybody calls: their types, and their parameters when
//! they start.

use serde_json::{Value, json};
use tests::network::session;

#[tests::needs(rclpy, namespace)]
#[test]
fn types_and_first_parameters_are_told_as_rclpy_tells_its_own() {
    let program = tests::frictionlab();
    let program = program.get_program().to_str().expect("a plain path");
    let starts = if std::env::var_os("FRICTION_FULL").is_some() { "20" } else { "3" };
    let report = session("described_session.py", &[program, starts]);
    let nodes = report["nodes"].as_object().expect("nodes");
    assert_eq!(nodes.len(), 5, "{report}");
    for (node, types) in nodes {
        let types = types.as_object().expect("types");
        assert!(types.len() > 8, "{node}: {types:?}");
        for (name, wrong) in types {
            assert_eq!(wrong, &Value::Null, "{name} of {node}");
        }
    }
    let told = |node: &str, name: &str| nodes[node].get(name).is_some();
    assert!(told("/rig_driver", "friction_msgs/msg/RigMeasurement"));
    assert!(told("/experiment_runner", "friction_msgs/action/RunExperiment_SendGoal"));
    assert_eq!(report["same"], json!({"/rig_driver": [], "/experiment_runner": []}));
    let refused = &report["refused"];
    assert_eq!(refused[0], refused[1], "as rcl refuses it");
    assert_eq!(report["without_sources"], 0);
    let heard = report["starts"].as_array().expect("starts");
    assert!(!heard.is_empty() && heard.iter().all(|heard| *heard == true), "{heard:?}");
}
