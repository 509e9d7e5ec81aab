//! Strangers that command the motor, or speak for its sensors, a thousand times a second, beside
//! the nodes that may: before the real rclpy.

use serde_json::{Value, json};
use tests::network::session;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

#[tests::needs(rclpy, namespace)]
#[test]
fn one_commands_whoever_else_speaks() {
    let more: &[&str] = if std::env::var_os("FRICTION_FULL").is_some() { &["whole"] } else { &[] };
    let report = session("writers_session.py", more);
    strangers_move_nothing_and_are_told(&report["strangers"]);
    the_later_of_two_drivers_gives_way(&report["twin"]);
    stamps_of_no_measurement_move_nothing(&report["invented"], text(&report["said"]));
}

/// A stranger's voltages with stamps ten seconds ahead once owned nine cycles of ten; joint states
/// of another writer drove the motor to six volts.
fn strangers_move_nothing_and_are_told(report: &Value) {
    assert_eq!(report["moves"], true, "{report}");
    assert!(text(&report["commander"]).starts_with("/controller (GUID "), "{report}");
    let attacks =
        report.as_object().into_iter().flatten().filter(|(_, attack)| attack.get("said").is_some());
    let attacks: Vec<_> = attacks.collect();
    assert!(attacks.len() >= 4, "{report}");
    for (what, attack) in attacks {
        let said = text(&attack["said"]);
        assert!(said.contains("/stranger") && said.contains("were refused"), "{what}: {attack}");
        assert!(number(&attack["heard"]) > 200.0, "{what}: {attack}");
        // About 1.5 V are enough for 1 rad/s; a stranger's voltage, or its speed, would make it
        // six.
        assert!(number(&attack["highest"]) < 5.5, "{what}: {attack}");
        assert_eq!(
            (&attack["state"], &attack["moves"]),
            (&json!("active"), &json!(true)),
            "{what}: {attack}"
        );
        assert_eq!(attack["fine"], true, "an error no longer than it lasts: {what}: {attack}");
    }
    let commands = report["commands"].as_array().expect("commands");
    assert!(commands.iter().any(|count| number(count) > 900.0), "{commands:?}");
}

fn the_later_of_two_drivers_gives_way(report: &Value) {
    assert!(text(&report["first says"]).contains("a second node /rig_driver has come"), "{report}");
    let second = text(&report["second says"]);
    assert!(second.contains("another node /rig_driver was there before"), "{second}");
    assert_eq!((&report["code"], &report["goes on"]), (&json!(0), &json!(true)), "{report}");
}

fn stamps_of_no_measurement_move_nothing(report: &Value, said: &str) {
    assert_eq!(report["active"], json!([true, true]), "{report}");
    for what in ["never measured", "from the future", "long ago"] {
        assert_eq!(report[what], 0.0, "{what}: {report}");
    }
    let count = |key: &str| text(&report["told"][key]).parse::<u64>().unwrap_or(0);
    assert!(count("commands with a stamp of no measurement") >= 50, "{}", report["told"]);
    assert!(count("commands with a stamp from the future") >= 50, "{}", report["told"]);
    assert!(count("stale commands") >= 50, "{}", report["told"]);
    assert!(
        number(&report["measured"]) > 2.0,
        "the same voltage in answer to a measurement moves it: {report}"
    );
    assert_eq!(report["state"], "active");
    assert_eq!((&report["both"], &report["refused"]), (&json!(true), &json!(false)), "{report}");
    assert!(said.contains("two publish on /motor_voltage at the same time"), "{said}");
    // A name comes in a message of its own, on a busy machine seconds after the first voltage; the
    // GUIDs are there from the start.
    let told =
        said.split("two publish on /motor_voltage at the same time").nth(1).unwrap_or_default();
    let told = told.lines().next().unwrap_or_default();
    assert!(told.matches("(GUID ").count() == 2 && told.contains("/caller (GUID"), "{said}");
    assert_eq!(report["named"], json!([[true, ""], true]), "{report}");
    assert_eq!(report["with a name"], json!(["active", 0.0]), "{report}");
    assert!(text(&report["relative"][1]).contains("/axis_1/controller"), "{report}");
}
