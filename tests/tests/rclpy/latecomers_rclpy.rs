//! Who comes late gets answers: subscribers, callers and nodes, before the real rclpy.

use serde_json::{Value, json};
use tests::network::session;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

#[tests::needs(rclpy, namespace)]
#[test]
fn nodes_callers_and_subscribers_may_come_in_any_order() {
    let program = tests::frictionlab();
    let program = program.get_program().to_str().expect("a plain path");
    let report = session("latecomers_session.py", &[program]);
    let orders = report["orders"].as_object().expect("orders");
    assert_eq!(orders.len(), 3);
    assert!(orders.values().all(|moves| *moves == true), "{orders:?}");
    let nodes = &report["nodes"];
    for node in ["/rig_driver", "/friction_observer", "/controller"] {
        assert_eq!(nodes[node][0], json!(["active", true]), "{node}: {nodes}");
        eprintln!("{node} answered a newcomer after {} s", nodes[node][1]);
        assert!(number(&nodes[node][1]) < 15.0);
    }
    assert_eq!(nodes["reset"], json!([true, "the estimator is at rest"]));
    assert_eq!((&nodes["voltages"][0], &nodes["estimates"][0]), (&json!(true), &json!(true)));
    // A killed runner comes back, finds the bag that was cut, and goes on; its last status waits
    // for whoever comes.
    let (killed, ended) = (&report["runner"]["SIGKILL"], &report["runner"]["SIGINT"]);
    for one in [killed, ended] {
        assert!(number(&one["experiments"]) >= 8.0, "{one}");
        assert_eq!(one["started"], true, "{one}");
    }
    assert_eq!((&killed["code"], &ended["code"]), (&json!(-9), &json!(0)));
    assert_eq!(ended["complete"], true, "{ended}");
    assert!(ended["status"].as_str().is_some_and(|told| told.contains("is complete")), "{ended}");
}
