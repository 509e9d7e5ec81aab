//! A late joiner of a latched topic is sent the last messages that its writer keeps, before the
//! real rclpy.

use std::io::BufRead;

use msgs::friction_msgs::ExperimentStatus;
use msgs::topics::{EXPERIMENT_STATUS, Qos};
use ros_node::{Discovery, Participant};
use serde_json::{Value, json};
use tests::{
    network::{namespaced, report, turn},
    python::{interpreter, script},
};

/// Publishes until as many are out as each line says; run by the test below.
#[test]
#[ignore = "the publisher of the other test, in a process of its own"]
fn publishes_as_told() {
    let participant = Participant::join(&Discovery::from_environment().expect("an environment"))
        .expect("a network");
    let node = participant.node("latched").expect("a node");
    let one = node.publisher(&EXPERIMENT_STATUS).expect("a publisher");
    let three = node
        .publisher_on("/last_three", Qos { depth: 3, transient_local: true })
        .expect("a publisher");
    let mut published = 0;
    for line in std::io::stdin().lock().lines() {
        let until: u32 = line.expect("a line").parse().expect("a number");
        while published < until {
            published += 1;
            let message = || ExperimentStatus {
                message: published.to_string(),
                ..ExperimentStatus::default()
            };
            one.publish(message()).expect("it is taken");
            three.publish(message()).expect("it is taken");
        }
    }
}

#[tests::needs(rclpy, namespace)]
#[test]
fn a_late_joiner_is_sent_the_last_messages_and_no_older_ones() {
    let (python, mut command) = (interpreter("rclpy"), namespaced());
    command.arg(&python).arg(script("latched_session.py"));
    command.arg(std::env::current_exe().expect("a running test knows its own file"));
    command.args(["--ignored", "--exact", "latched_rclpy::publishes_as_told", "--nocapture"]);
    command.env("ROS_DOMAIN_ID", "79").env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST");
    let _turn = turn();
    let (report, told) = report(command);
    assert_eq!(report["code"], 0, "{told}");
    for count in [1, 5, 100] {
        for depth in [1, 10] {
            let heard = &report[count.to_string()][depth.to_string()];
            assert_eq!(
                heard["/experiment_status"],
                json!([count]),
                "{count} published, depth {depth}: {heard}"
            );
            let three = heard["/last_three"].as_array().expect("a list");
            // A reader of depth 1 may take one before the next replaces it.
            let kept: Vec<Value> = ((count - 2).max(1)..=count).map(Value::from).collect();
            let in_order = three.windows(2).all(|two| two[0].as_u64() < two[1].as_u64());
            let right = if depth == 1 {
                in_order
                    && three.iter().all(|one| kept.contains(one))
                    && three.last() == kept.last()
            } else {
                *three == kept
            };
            assert!(right, "{count} published, depth {depth}: {heard}");
        }
    }
    // Who is there all the time hears every one, in order.
    for (topic, heard) in report["present"].as_object().expect("topics") {
        let heard: Vec<u64> =
            heard.as_array().expect("a list").iter().filter_map(Value::as_u64).collect();
        assert!(heard.is_sorted() && heard.last() == Some(&100), "{topic}: {heard:?}");
    }
}
