//! Every service that a node shows answers, and every node answers what `ros2 param list` asks,
//! before the real rclpy.

use serde_json::{Value, json};
use tests::network::session;

#[tests::needs(rclpy, namespace)]
#[test]
fn what_a_node_shows_is_there() {
    let program = tests::frictionlab();
    let program = program.get_program().to_str().expect("a plain path");
    let full = std::env::var_os("FRICTION_FULL").is_some();
    // The nodes that `launch` starts are asked for all they have by other tests too.
    let ways: &[&str] = if full {
        &["live", "live --serve", "launch", "launch record:=bag", "serve"]
    } else {
        &["live", "serve"]
    };
    let report = session("served_session.py", &[&[program][..], ways].concat());
    for way in ways {
        let nodes = report[way].as_object().expect("nodes");
        let of_way = if *way == "serve" { 1 } else { 4 };
        assert!(nodes.len() >= of_way, "{way}: {nodes:?}");
        for (node, asked) in nodes {
            let services = asked.as_object().expect("services");
            for (service, answer) in services {
                assert_eq!(answer, &json!(true), "{way}: {service} of {node} does not answer");
            }
            for parameters in
                ["list_parameters", "get_parameters", "describe_parameters", "set_parameters"]
            {
                let there = services.get(&format!("{node}/{parameters}")).and_then(Value::as_bool);
                assert_eq!(there, Some(true), "{way}: {node} has no {parameters}: {services:?}");
            }
        }
    }
}
