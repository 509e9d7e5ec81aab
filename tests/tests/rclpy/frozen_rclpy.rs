//! Readers that do not keep up, before the real rclpy: frozen, killed, slow, gone from the network.
//! The loop goes on, and whoever keeps up hears everything.

use serde_json::Value;
use tests::readers::{LoopAndReaders, beside_readers};

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// What one who keeps up must hear, whatever others do, and whatever else the machine does.
fn assert_unharmed(report: &Value, phase: &str) {
    let about = format!("{} beside {}, {phase}", report["way"], report["readers"]);
    let heard = &report[phase];
    for (topic, heard) in heard["topics"].as_object().expect("topics") {
        eprintln!("{about}: {topic} {heard}");
        assert_eq!(
            (&heard["lost"], &heard["disordered"]),
            (&0.into(), &0.into()),
            "{about}: {topic} {heard}"
        );
        assert_eq!(heard["silent_windows"], 0, "{about}: {topic} {heard}");
        assert!(number(&heard["longest_gap_s"]) < 0.5, "{about}: {topic} {heard}");
    }
    assert_eq!(heard["faults"], 0, "{about}: {}", report["said"]);
    for (node, health) in heard["health"].as_object().expect("nodes") {
        // A machine that is busy fills the queues, whoever reads.
        eprintln!("{about}: {node} {}, late {}", health["not published"], health["overruns"]);
    }
}

/// How often the loop is tried: five readers that start at once, on two cores that have other work
/// too, may keep a command from the rig driver for half a second. What a reader does to the loop it
/// does each time.
const TRIES: usize = 3;

/// The loop beside these readers.
fn hold(way: &str, seconds: u32, readers: &[&str]) {
    let tried = |_| beside_readers(&LoopAndReaders { way, seconds, readers });
    let stopped = |report: &Value| {
        let stopped = report["said"].as_str().is_some_and(|said| said.contains("command lost"));
        if stopped {
            println!("a command was late by half a second");
        }
        stopped
    };
    let mut reports = (0..TRIES).map(tried);
    let report = reports.find(|report| !stopped(report)).expect("once the loop goes on");
    let said = report["said"].as_str().expect("text");
    for phase in ["alone", "beside", "after"] {
        assert_unharmed(&report, phase);
    }
    for (index, kind) in readers.iter().enumerate().filter(|(_, kind)| **kind != "best_effort") {
        let lags = |line: &&str| {
            line.contains(&format!("/{kind}_{index} ")) && line.contains("does not keep up")
        };
        // The signals are what fills a reader; those of every node have their own.
        for topic in ["/joint_states", "/motor_voltage", "/friction_estimate"] {
            assert!(
                said.lines().filter(lags).any(|line| line.contains(topic)),
                "{kind} on {topic}: {said}"
            );
        }
        // Not once a message: at most a line in ten seconds for each topic.
        let most = 13 * (2 + seconds as usize / 10);
        assert!(said.lines().filter(lags).count() <= most, "{kind}: {said}");
    }
    for (name, hears) in report["hears"].as_object().expect("readers that came back") {
        assert_eq!(hears, true, "{name} hears of the loop again: {said}");
    }
    for (name, told) in report["back"].as_object().expect("readers that came back") {
        assert_eq!(told, true, "{name} keeps up again: {said}");
    }
    assert!(
        report["early"].as_array().is_some_and(|early| early.iter().all(Value::is_null)),
        "{said}"
    );
    assert!(
        report["codes"].as_array().is_some_and(|codes| codes.iter().all(|code| code == 0)),
        "{said}"
    );
}

/// Longer than eight thousand messages at 1 kHz take.
const SHORT: u32 = 12;

#[tests::needs(rclpy, machines)]
#[test]
fn no_reader_stops_the_loop_of_the_launched_nodes() {
    hold("launch", SHORT, &["stopped", "killed", "slow", "best_effort", "gone"]);
}

/// Every kind alone; three and ten of them with every way to run the loop, until the lease of those
/// that are gone has ended.
#[tests::needs(rclpy, machines, long_tier)]
#[test]
fn no_number_of_readers_stops_any_loop() {
    for kind in ["stopped", "killed", "slow", "best_effort", "gone"] {
        hold("launch", SHORT, &[kind]);
    }
    for way in ["launch", "live", "processes"] {
        hold(way, 30, &["stopped", "killed", "gone"]);
        hold(
            way,
            30,
            &[
                "stopped",
                "killed",
                "slow",
                "best_effort",
                "gone",
                "stopped",
                "killed",
                "stopped",
                "killed",
                "gone",
            ],
        );
    }
}
