//! Every service and action is asked for the largest answer that it has, by the real rclpy: on one machine and over the network.

use serde_json::Value;
use tests::network::{ORDINARY_MTU, Place, session_at};
use tests::python::Distribution;

/// Every answer that was asked for came.
fn all_arrive(place: Place, distribution: Distribution) {
    let runs = tempfile::tempdir().expect("a folder");
    let (lab, runs) = (tests::frictionlab(), runs.path().join("runs").display().to_string());
    let lab = lab.get_program().to_str().expect("a path of text");
    let Some(report) = session_at(place, distribution, "large_answers_session.py", &[lab, &runs]) else {
        return;
    };
    eprintln!("{place:?}, {}: {report:#}", distribution.name());
    let answers = report.as_object().expect("answers by name");
    let missing: Vec<_> = answers.values().filter_map(Value::as_str).collect();
    assert!(missing.is_empty(), "{missing:#?}");
}

#[test]
fn over_an_ordinary_network() {
    all_arrive(Place::TwoPcs(ORDINARY_MTU), Distribution::Kilted);
}
