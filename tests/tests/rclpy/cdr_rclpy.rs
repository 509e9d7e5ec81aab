//! Every message, byte by byte: what rclpy writes is what is written here, and each reads what the
//! other wrote.

use std::io::Write;
use std::process::{Command, Stdio};

use msgs::RosMessage;
use msgs::cdr;
use msgs::{
    diagnostic_msgs::*, friction_msgs::*, lifecycle_msgs::*, rosgraph_msgs::*, sensor_msgs::*,
    std_msgs::*, std_srvs::*,
};
use serde_json::{Map, Value};
use tests::filled::filled;
use tests::python;

/// Calls a generic function for every type that goes over the wire or into a bag.
macro_rules! for_each {
    ($function:ident, $argument:expr; $($type:ty),* $(,)?) => { $($function::<$type>($argument);)* };
}

macro_rules! for_each_type {
    ($function:ident, $argument:expr) => {
        for_each!($function, $argument;
            msgs::builtin_interfaces::Time, Header, JointState, KeyValue, DiagnosticStatus, DiagnosticArray,
            RigMeasurement, Reference, MotorVoltage, FrictionEstimate, ControllerState, ExperimentStatus,
            EstimatedParameter, Figure, ModelFit, Setting, ExperimentParameter, ExperimentDescription,
            RunExperimentGoal, RunExperimentResult, RunExperimentFeedback, StartExperimentRequest,
            StartExperimentResponse, ListExperimentsRequest, ListExperimentsResponse, IdentifyRequest, IdentifyResponse,
            TriggerRequest, TriggerResponse, Clock, State, Transition, TransitionDescription, TransitionEvent,
            ChangeStateRequest, ChangeStateResponse, GetStateRequest, GetStateResponse, GetAvailableStatesRequest,
            GetAvailableStatesResponse, GetAvailableTransitionsRequest, GetAvailableTransitionsResponse)
    };
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn bytes(text: &Value) -> Vec<u8> {
    let text = text.as_str().expect("hexadecimal");
    let pair = |at: usize| u8::from_str_radix(&text[at..at + 2], 16).expect("hexadecimal");
    (0..text.len()).step_by(2).map(pair).collect()
}

/// Asserts that rclpy's bytes are ours but for padding, whose content CDR leaves open: between
/// fields, and up to three bytes behind them.
fn assert_same<M: RosMessage>(which: &str, theirs: &[u8], ours: &[u8]) {
    let name = M::type_name();
    let read: M = cdr::decode(theirs).unwrap_or_else(|error| panic!("{which}: {error}"));
    assert_eq!(cdr::encode(&read).expect("bytes"), ours, "{name}, {which}: the values");
    let more = theirs.len().checked_sub(ours.len());
    assert!(
        more.is_some_and(|more| more < 4),
        "{name}, {which}: {} bytes against {}",
        theirs.len(),
        ours.len()
    );
    for (at, (left, right)) in theirs.iter().zip(ours).enumerate() {
        assert!(
            left == right || is_padding::<M>(ours, at),
            "{name}, {which}: byte {at} is {left}, not {right}"
        );
    }
}

/// Whether the byte at that place says nothing: changed, it gives the same message.
fn is_padding<M: RosMessage>(bytes: &[u8], at: usize) -> bool {
    let mut changed = bytes.to_vec();
    changed[at] ^= 0x55;
    let same = |message: &M| cdr::encode(message).is_ok_and(|encoded| encoded == bytes);
    at >= 4 && cdr::decode::<M>(&changed).is_ok_and(|message| same(&message))
}

#[tests::needs(rclpy)]
#[test]
fn rclpy_and_rust_write_the_same_bytes_and_read_each_others() {
    let python = python::interpreter("rclpy");
    fn put<M: RosMessage>(given: &mut Map<String, Value>) {
        given.insert(M::type_name(), hex(&cdr::encode(&filled::<M>()).expect("bytes")).into());
    }
    let mut given = Map::new();
    for_each_type!(put, &mut given);

    let mut peer = Command::new(python)
        .arg(python::script("cdr_peer.py"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("Python starts");
    let text = Value::Object(given).to_string();
    peer.stdin.take().expect("its input").write_all(text.as_bytes()).expect("it listens");
    let output = peer.wait_with_output().expect("its end");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let answer: Value = serde_json::from_slice(&output.stdout).expect("JSON");

    fn check<M: RosMessage>(answer: &Value) {
        let answer = &answer[M::type_name()];
        let ours = cdr::encode(&filled::<M>()).expect("bytes");
        assert!(ours.len() > 4);
        for which in ["filled", "returned"] {
            assert_same::<M>(which, &bytes(&answer[which]), &ours);
        }
    }
    for_each_type!(check, &answer);
}
