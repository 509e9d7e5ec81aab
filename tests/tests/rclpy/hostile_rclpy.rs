//! Publishers and callers that send what nobody should, before the real rclpy.

use serde_json::{Value, json};
use tests::network::session;

/// The voltage limit, and half a step of the converter that reads the voltage back [V].
const LIMIT: f64 = 6.0 + 0.0025;
/// What the shaft may turn in a phase with a reference of zero velocity [rad]: a few counts of the
/// encoder, 1.5 mrad each.
const AT_REST: f64 = 0.02;
const NODES: [&str; 3] = ["/rig_driver", "/friction_observer", "/controller"];

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

/// Runs parts of the session; asserts what holds in each.
fn hostile(parts: &[&str]) -> Value {
    let report = session("hostile_session.py", parts);
    assert_eq!(report["moves"], true, "{report}");
    for part in parts {
        let Some(phases) = report[part].as_object() else { continue };
        for (name, phase) in phases {
            if name.starts_with("comes back") {
                assert_eq!(phase, &json!([true, true, true]), "{part}: {name}");
            } else if phase.get("highest").is_some() {
                quiet(&format!("{part}: {name}"), phase);
            }
        }
    }
    assert_eq!(report["again"], json!([true, true, true]));
    for node in ["rig_driver", "friction_observer", "controller"] {
        let said = text(&report[&format!("said {node}")]);
        assert!(
            !said.contains("panicked") && !said.contains("starts anew"),
            "{node} said:\n{said}"
        );
    }
    for exit in report["exit"].as_array().expect("exits") {
        assert_eq!(exit[0], 0, "{exit}");
    }
    report
}

/// Nothing moved, within the limits, and the measurements went on.
fn quiet(name: &str, phase: &Value) {
    assert!(number(&phase["heard"]) > 200.0, "{name}: {phase}");
    assert!(number(&phase["highest"]) <= LIMIT, "{name}: {phase}");
    assert!(number(&phase["travel"]) < AT_REST, "{name}: {phase}");
    assert!(phase.get("not_finite").is_none_or(|count| count == 0), "{name}: {phase}");
    assert_eq!(phase["state"], "active", "a stranger stops nothing: {name}: {phase}");
}

#[tests::needs(rclpy, namespace)]
#[test]
fn numbers_that_no_shaft_has_are_left_out_and_told() {
    let report = hostile(&["numbers"]);
    // Six times twenty of references, and of joint states beyond a shaft's; of estimates those that
    // are no number.
    let left_out = text(&report["health"]["controller"]["messages without numbers"])
        .parse::<u32>()
        .unwrap_or(0);
    assert!(left_out >= 200, "{}", report["health"]["controller"]);
    assert!(text(&report["said controller"]).contains("is no number, or beyond what a shaft does"));
    // The controller commands: of anybody else a voltage that is no number is as good as none.
    let commands = &report["health"]["rig_driver: commands"];
    let refused = text(&commands["/motor_voltage refused from others"]).parse::<u32>().unwrap_or(0);
    assert!(refused >= 40, "three times twenty: {commands}");
    let said = text(&report["said rig_driver"]);
    assert!(
        !said.contains("command not finite") && said.contains("end the other publisher"),
        "{said}"
    );
}

#[tests::needs(rclpy, namespace)]
#[test]
fn joint_states_of_others_and_stamps_of_other_times_move_nothing() {
    let report = hostile(&["forms", "another_type"]);
    for node in ["controller", "friction_observer"] {
        assert!(
            text(&report[&format!("said {node}")])
                .contains("no position or no velocity of load_shaft"),
            "{node}"
        );
    }
    let commands = &report["health"]["rig_driver: commands"];
    let refused = text(&commands["/motor_voltage refused from others"]).parse::<u32>().unwrap_or(0);
    assert!(refused >= 40, "the controller commands, whatever the stamps of others: {commands}");
    quiet("another type", &report["another_type"]);
}

#[tests::needs(rclpy, namespace)]
#[test]
fn bytes_that_are_no_message_are_dropped_and_told() {
    let report = hostile(&["bytes"]);
    assert!(number(&report["bytes"]["cases"]) > 500.0);
    for (node, topic) in [
        ("rig_driver", "/motor_voltage"),
        ("controller", "/reference"),
        ("controller", "/friction_estimate"),
        ("friction_observer", "/joint_states"),
    ] {
        let said = text(&report[&format!("said {node}")]);
        assert!(said.contains(&format!("messages on {topic} were no ")), "{node}:\n{said}");
    }
}

#[tests::needs(rclpy, namespace)]
#[test]
fn a_flood_does_not_keep_the_loop_from_its_work_nor_the_nodes_from_answering() {
    let report = hostile(&["floods", "requests"]);
    for which in ["reference", "voltage"] {
        let flood = &report["floods"][which];
        // The node was asked, and the motor looked at, while these came.
        assert_eq!(flood["sent"], 15_000, "{which}: {flood}");
    }
    bad_requests_are_answered(&report["requests"]);
}

fn bad_requests_are_answered(report: &Value) {
    for node in NODES {
        for (what, said) in [
            ("unknown", "was not declared"),
            ("huge name", "(1000000 bytes)"),
            ("huge value", "(1000000 bytes)"),
            ("type", "is not allowed"),
            ("range", "but is"),
        ] {
            let answer = &report[what][node];
            assert!(
                answer[0] == false && text(&answer[1]).contains(said),
                "{what} of {node}: {answer}"
            );
            assert!(text(&answer[1]).len() < 1000, "{what} of {node} is short");
        }
    }
    assert_eq!(report["transition"], Value::from(vec![Value::from(vec![false; 3]); 3]));
    assert_eq!(report["get huge"], json!([[null], [null], [null]]));
    assert_eq!(report["states"], json!(["active", "active", "active"]));
}

/// What a node says whose middleware is lost in a packet: it computes, or takes memory.
const LOST: [&str; 2] = ["computes without end", "has grown by more than"];

fn is_lost(said: &str) -> bool {
    LOST.iter().any(|told| said.contains(told))
}

/// A node whose middleware a packet ended would start anew, and say so; a deaf one would not
/// answer. One whose middleware is lost in a packet ends.
#[tests::needs(rclpy, namespace)]
#[test]
fn damaged_dds_packets_neither_move_the_motor_nor_silence_the_nodes() {
    let packets = if std::env::var_os("FRICTION_FULL").is_some() { "30000" } else { "3000" };
    let report = session("packets_session.py", &[packets, "6"]);
    assert!(number(&report["sources"]) > 20.0, "{report}");
    assert!(number(&report["highest"]) < 1.0, "the loop holds still: {report}");
    for (index, node) in ["rig_driver", "friction_observer", "controller"].into_iter().enumerate() {
        let (said, exit) = (text(&report["said"][node]), &report["exit"][index]);
        let told = ["panicked", "starts anew", LOST[0], LOST[1]];
        for line in said.lines().filter(|line| told.iter().any(|part| line.contains(part))) {
            eprintln!("{node}: {line}");
        }
        if is_lost(said) {
            assert_eq!(exit[0], 1, "{node}: {exit}");
            continue;
        }
        assert_eq!(report["alive"][node], true, "{node}");
        assert!(["active", "inactive"].contains(&text(&report["states"][index])), "{report}");
        assert_eq!(exit[0], 0, "{node}: {exit}");
    }
}

/// The middleware listed what a HEARTBEAT said that it missed, however many billions.
#[tests::needs(rclpy, namespace)]
#[test]
fn a_packet_that_announces_billions_of_messages_changes_nothing() {
    let report = session("heartbeat_session.py", &[]);
    assert!(number(&report["heartbeats"]) > 0.0, "{report}");
    assert_eq!(report["states"], json!(["active", "active", "active"]), "{report}");
    assert!(report["moves"] == true && report["code"] == 0, "{report}");
    assert!(number(&report["gigabytes"]) < 0.5, "{report}");
}

/// `live` took 16 GB and did not hear ctrl-C.
#[tests::needs(rclpy, namespace)]
#[test]
fn a_live_run_goes_on_under_hostile_packets_and_hears_ctrl_c() {
    let program = tests::frictionlab().get_program().to_string_lossy().into_owned();
    let full = std::env::var_os("FRICTION_FULL").is_some();
    let attacks = [&["heartbeats"][..], &["heartbeats", "interrupted"], &["fragments"]];
    for attack in attacks.iter().take(if full { 3 } else { 1 }) {
        let arguments: Vec<&str> =
            [program.as_str()].into_iter().chain(attack.iter().copied()).collect();
        let report = session("live_attacked_session.py", &arguments);
        eprintln!("{attack:?}: ended after {} s with {} GB", report["took"], report["gigabytes"]);
        assert!(number(&report["writers"]) > 4.0, "{report}");
        assert_eq!(report["went_on"], true, "{report}");
        let code = report["code"].as_i64().expect("it ends");
        assert!([0, 130].contains(&code), "{report}");
        assert!(number(&report["gigabytes"]) < 1.0, "{report}");
    }
}
