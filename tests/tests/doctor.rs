//! `frictionlab doctor` in network namespaces: alone, with a domain that is none, without loopback.
//! Beside running nodes: `launch_rclpy.rs`.

use std::process::{Command, Output};

use serde_json::Value;
use tests::network::namespaced;

/// Runs the doctor by `command`, a namespace and perhaps more, and returns its exit code and
/// findings.
fn doctor(mut command: Command, variables: &[(&str, &str)]) -> (Option<i32>, Value) {
    let folder = tempfile::tempdir().expect("a folder");
    let program = tests::frictionlab();
    let output = command
        .arg(program.get_program())
        .args(["doctor", "--json", "--runs"])
        .arg(folder.path().join("runs"))
        .env_remove("RMW_IMPLEMENTATION")
        .env_remove("ROS_STATIC_PEERS")
        .env_remove("ROS_AUTOMATIC_DISCOVERY_RANGE")
        .env("ROS_DOMAIN_ID", "75")
        .envs(variables.iter().copied())
        .output()
        .expect("unshare starts");
    (output.status.code(), findings(&output))
}

fn findings(output: &Output) -> Value {
    let told = String::from_utf8_lossy(&output.stderr);
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {told}"))
}

/// The findings of a section whose subject begins so.
fn of<'a>(report: &'a Value, section: &str, subject: &str) -> &'a Value {
    report["sections"]
        .as_array()
        .expect("sections")
        .iter()
        .filter(|found| found["name"] == section)
        .flat_map(|found| found["findings"].as_array().expect("findings"))
        .find(|found| found["subject"].as_str().is_some_and(|name| name.starts_with(subject)))
        .unwrap_or_else(|| panic!("no finding on {subject} in {section}: {report}"))
}

fn figure(finding: &Value, name: &str) -> f64 {
    let figures = finding["figures"].as_array().expect("figures");
    let found = figures
        .iter()
        .find(|figure| figure["name"] == name)
        .unwrap_or_else(|| panic!("{name}: {finding}"));
    found["value"].as_f64().expect("a number")
}

#[tests::needs(namespace)]
#[test]
fn alone_nothing_is_broken_and_every_figure_is_there() {
    let command = namespaced();
    let (code, report) = doctor(command, &[]);
    assert_ne!(report["verdict"], "broken", "{report}");
    assert_eq!(code, Some(0), "{report}");
    let bare = of(&report, "Scheduling", "bare loop");
    assert!(
        figure(bare, "lateness p50") > 0.0
            && figure(bare, "lateness p99") >= figure(bare, "lateness p50")
    );
    assert!(figure(of(&report, "Clocks", "monotonic clock"), "resolution") > 0.0);
    assert!(figure(of(&report, "Clocks", "system clock"), "watched for") > 2.0);
    assert_eq!(of(&report, "Network", "multicast on 127.0.0.1")["verdict"], "fine");
    assert_eq!(
        figure(of(&report, "Network", "ROS_DOMAIN_ID"), "first port"),
        7400.0 + 75.0 * 250.0
    );
    assert_eq!(figure(of(&report, "Other nodes", "other nodes"), "nodes"), 0.0);
    let none = of(&report, "Control loops", "control loop");
    assert!(
        none["found"].as_str().is_some_and(|found| found.contains("frictionlab launch")),
        "{none}"
    );
    assert!(figure(of(&report, "Rigs and disk", "disk"), "free") > 0.0);
}

#[tests::needs(namespace)]
#[test]
fn a_domain_that_is_none_is_broken_and_said_how_to_mend() {
    let command = namespaced();
    let (code, report) =
        doctor(command, &[("ROS_DOMAIN_ID", "999"), ("RMW_IMPLEMENTATION", "rmw_zenoh_cpp")]);
    assert_eq!((code, &report["verdict"]), (Some(1), &Value::from("broken")), "{report}");
    let domain = of(&report, "Network", "ROS_DOMAIN_ID");
    assert_eq!(domain["verdict"], "broken");
    assert!(domain["found"].as_str().is_some_and(|found| found.contains("999")), "{domain}");
    assert!(
        domain["mend"].as_str().is_some_and(|mend| mend.contains("export ROS_DOMAIN_ID=")),
        "{domain}"
    );
    assert_eq!(of(&report, "Network", "RMW_IMPLEMENTATION")["verdict"], "look_at_this");
    // The rest is looked at all the same.
    assert!(figure(of(&report, "Scheduling", "bare loop"), "lateness p99") > 0.0);
}

#[tests::needs(namespace)]
#[test]
fn a_loopback_that_is_down_is_broken_and_said_how_to_mend() {
    let mut command = namespaced();
    command.args(["bash", "-c", "ip link set lo down && exec \"$@\"", "--"]);
    let (code, report) = doctor(command, &[]);
    assert_eq!(code, Some(1), "{report}");
    let loopback = of(&report, "Network", "loopback");
    assert_eq!(loopback["verdict"], "broken", "{loopback}");
    assert!(
        loopback["mend"].as_str().is_some_and(|mend| mend.contains("ip link set lo up")),
        "{loopback}"
    );
}
