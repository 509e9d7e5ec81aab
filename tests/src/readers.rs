//! A loop in real time beside readers that do not keep up.

use serde_json::Value;

use crate::network::{ORDINARY_MTU, report, turn, two_machines};

use crate::python;

/// A loop in real time and what reads its topics.
#[derive(Debug, Clone, Copy)]
pub struct LoopAndReaders<'a> {
    /// `launch`, `live` or `processes`.
    pub way: &'a str,
    /// How long the readers are as they are, after a while without them \[s\].
    pub seconds: u32,
    /// Each `stopped`, `killed`, `slow`, `best_effort` or `gone`.
    pub readers: &'a [&'a str],
}

/// What a reader of rclpy that keeps up hears of a loop beside others that do not.
///
/// # Panics
/// When two machines or rclpy cannot be had, or the session fails; the message carries what it said.
pub fn beside_readers(what: &LoopAndReaders<'_>) -> Value {
    let _turn = turn();
    let python = python::interpreter("rclpy");
    let mut command = two_machines(ORDINARY_MTU);
    command.arg(&python).arg(python::script("frozen_session.py")).arg(crate::node_programs());
    command.arg(crate::frictionlab().get_program()).args([what.way, &what.seconds.to_string()]);
    command
        .args(what.readers)
        .env("ROS_DOMAIN_ID", "77")
        .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET");
    report(command).0
}
