//! The loop of three processes for a while, and killed at random moments, before the real rclpy.
//! `cargo xtask soak` has the long form.

use serde_json::{Value, json};
use tests::network::session;

/// A command counts for so long [s], and two cycles: the voltage is told with the next one.
const LAST_VOLTAGE: f64 = 0.02 + 0.002;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

fn assert_ended(exits: &Value) {
    let exits = exits.as_array().expect("a list");
    assert!(!exits.is_empty() && exits.iter().all(|exit| exit[0] == 0), "{exits:?}");
}

#[tests::needs(rclpy, namespace)]
#[test]
fn ten_seconds_at_1_khz_lose_nothing_and_do_not_drift() {
    let report = session("soak_session.py", &["10", "processes"]);
    assert!(number(&report["heard"]) > 9000.0, "{report}");
    // A subscriber in Python that does not get its share of a busy machine loses what its queue of
    // two seconds does not hold.
    for what in ["missing_at_subscriber", "commands_missing"] {
        assert!(number(&report[what]) < 0.02 * number(&report["heard"]), "{what}: {report}");
    }
    let health = &report["health"];
    assert_eq!(health["rig_driver: control loop"]["not published"], "0", "{health}");
    assert_eq!(health["controller"]["not published"], "0", "{health}");
    assert_eq!(report["disordered"], 0);
    assert!(number(&report["cycles_against_stamps"]).abs() < 1e-3, "{report}");
    assert!(number(&report["stamps_against_wall_clock"]).abs() < 1e-3, "{report}");
    for (process, growth) in report["memory_growth"].as_object().expect("processes") {
        // Queues and histories still fill in the first seconds: a leak of a message a cycle would
        // be more.
        assert!(number(growth) < 0.5, "{process}: {report}");
    }
    assert_ended(&report["exit"]);
}

#[tests::needs(rclpy, namespace)]
#[test]
fn whoever_is_killed_the_motor_stands_within_the_age_of_a_command() {
    let rounds = if std::env::var_os("FRICTION_FULL").is_some() { "50" } else { "3" };
    let report = session("killed_session.py", &[rounds, "6"]);
    for round in report["rounds"].as_array().expect("rounds") {
        assert!(number(&round["highest"]) <= 6.0 + 0.0025, "{round}");
        assert_eq!(round["moves_again"], true, "{round}");
        if round["victim"] == "controller" {
            assert!(number(&round["last_voltage"]) <= LAST_VOLTAGE, "{round}");
            assert_eq!(
                (&round["faulted"], &round["cleared"]),
                (&json!(true), &json!([true, true])),
                "{round}"
            );
        }
    }
    assert_ended(&report["exit"]);
}
