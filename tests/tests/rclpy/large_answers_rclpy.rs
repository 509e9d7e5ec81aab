//! Every service and the action are asked for the largest answer that they have, by the real rclpy:
//! on one machine and over networks, with large questions, and with large messages of topics both
//! ways.

use serde_json::Value;
use tests::network::{Place, session_at};
use tests::python::Distribution::{self, Jazzy, Kilted};

/// What an ordinary network takes in one packet [bytes].
const ONE_PACKET: u64 = 1400;
/// As many models as make a result of an experiment of several packets.
const MODELS: &[&str] = &["coulomb_viscous", "stribeck", "lugre", "proposed"];

/// Every answer that was asked for came, and what else is large arrived. `models` are those of an
/// experiment that is run and identified.
fn all_arrive(place: Place, distribution: Distribution, models: &[&str]) -> Value {
    let folder = tempfile::tempdir().expect("a folder");
    let (lab, runs) = (tests::frictionlab(), folder.path().join("runs").display().to_string());
    let lab = lab.get_program().to_str().expect("a path of text");
    let arguments = [&[lab, runs.as_str()], models].concat();
    let report = session_at(place, distribution, "large_answers_session.py", &arguments);
    let answers = report["answers"].as_object().expect("answers by name");
    let missing: Vec<_> = answers.iter().filter(|(_, answer)| answer.is_string()).collect();
    assert!(missing.is_empty(), "{place:?}, {distribution:?}: {missing:#?}");
    assert_eq!(report["unasked"], serde_json::json!([]), "services that nobody asked");
    let is_large = |answer: &&Value| answer[0].as_u64() > Some(ONE_PACKET);
    let large = answers.values().filter(is_large).count();
    assert!(large >= 12, "{large} answers of several packets: {answers:#?}");
    assert!(report["largest_event"].as_u64() > Some(ONE_PACKET), "{report}");
    assert!(report["logged"].as_u64() > Some(0), "{report}");
    let joints = &report["joint_states"];
    assert!(
        joints[0].as_u64() > Some(ONE_PACKET) && joints[1] == true,
        "a large message is not heard: {report}"
    );
    let exits = report["exit"].as_array().expect("codes");
    assert!(exits.len() == 4 && exits.iter().all(|code| code == 0), "{report}");
    report
}

#[tests::needs(rclpy, machines)]
#[test]
fn on_a_network_that_loses_packets() {
    let report = all_arrive(Place::CrowdedNetwork, Kilted, &[]);
    assert!(report["dropped"].as_u64() > Some(0), "nothing was lost: {report}");
}

#[tests::needs(rclpy, jazzy, machines, long_tier)]
#[test]
fn everywhere_with_both_distributions() {
    for distribution in [Kilted, Jazzy] {
        for place in Place::of_tier(Place::CrowdedNetwork) {
            let report = all_arrive(place, distribution, MODELS);
            let result = &report["answers"]["/experiment_runner/run_experiment result"];
            assert!(result[0].as_u64() > Some(ONE_PACKET), "{result}");
        }
    }
}
