//! Each side of the loop ends, is killed, stands still and comes back while the others go on,
//! before the real rclpy.

use serde_json::{Value, json};
use tests::network::session;

/// `command_age` [s]: older commands do not count.
const COMMAND_AGE: f64 = 0.02;
/// `command_lost` [s]: without a command for so long it is a fault.
const COMMAND_LOST: f64 = 0.5;
/// The voltage that a measurement tells of was applied in the cycle before, and an age is judged
/// once a cycle [s].
const TWO_CYCLES: f64 = 0.002;
/// By how much a busy machine may delay the cycle that sees it [s]. When a loop that keeps its time
/// sees it is tested where time is simulated.
const LATE: f64 = 0.5;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// Every program ended with code 0.
fn assert_ended(exits: &Value) {
    let exits = exits.as_array().expect("a list");
    assert!(!exits.is_empty() && exits.iter().all(|exit| exit[0] == 0), "{exits:?}");
}

#[tests::needs(rclpy, namespace)]
#[test]
fn the_motor_stands_while_its_controller_is_gone_and_the_loop_closes_again_with_whoever_comes_back()
{
    let report = session("restarts_session.py", &[]);
    assert_eq!(report["moves"], true, "the rig comes last: {report}");
    for (how, code) in [("SIGINT", 0), ("SIGKILL", -9)] {
        let gone = &report[how]["controller"];
        assert_eq!(gone["code"], code, "{how}: {gone}");
        let last_voltage = number(&gone["last_voltage"]);
        assert!(
            last_voltage > -TWO_CYCLES && last_voltage <= COMMAND_AGE + TWO_CYCLES,
            "{how}: a command counts for {COMMAND_AGE} s: {gone}"
        );
        let fault = number(&gone["fault"]);
        // A stamp is that of its cycle, which may have begun when the command came.
        let about = COMMAND_LOST - TWO_CYCLES..COMMAND_LOST + TWO_CYCLES + LATE;
        assert!(about.contains(&fault), "{how}: {gone}");
        println!("{how}: the fault came {:.3} s late", fault - COMMAND_LOST);
        assert_eq!(
            (&gone["state"], &gone["commands_again"]),
            (&json!("inactive"), &json!(true)),
            "{how}"
        );
        assert_eq!(gone["voltage_in_fault"], 0.0, "{how}: new commands do not clear a fault");
        assert_eq!(
            (&gone["cleared"], &gone["moves_again"]),
            (&json!([true, true]), &json!(true)),
            "{how}"
        );

        let alone = &report[how]["friction_observer"];
        assert_eq!(
            (&alone["friction"], &alone["faults"]),
            (&json!(0.0), &json!(0)),
            "{how}: {alone}"
        );
        assert_eq!(
            (&alone["moves"], &alone["compensates_again"]),
            (&json!(true), &json!(true)),
            "{how}: {alone}"
        );

        let rig = &report[how]["rig_driver"];
        assert_eq!((&rig["code"], &rig["moves_again"]), (&json!(code), &json!(true)), "{how}");
    }
    assert_eq!(report["waits"], json!(["unconfigured", true]));
    assert_eq!((&report["heard_waiting"], &report["voltage_waiting"]), (&json!(true), &json!(0.0)));
    assert_eq!(report["activated"], json!([true, true]));
    assert_ended(&report["exit"]);
}

/// The middleware's own threads do not survive SIGSTOP and SIGCONT: the node notices and starts
/// anew.
#[tests::needs(rclpy, namespace)]
#[test]
fn a_process_that_stood_still_comes_back_and_nothing_that_waited_moves_the_motor() {
    let report = session("pauses_session.py", &[]);
    assert_eq!(report["moves"], true, "{report}");
    for node in ["rig_driver", "friction_observer", "controller"] {
        let one = &report[node];
        assert_eq!(one["moves_again"], true, "{node}: {one}");
        // The position has no jumps: 6 V turn the shaft by less than 10 mrad in a cycle. How near it
        // stays to its reference of 1 rad/s depends on what else the machine does; that nothing kicks
        // it is tested where time is simulated (`controller/tests/change.rs`).
        assert!(number(&one["steepest"]) < 0.01, "{node}: {one}");
        println!("{node}: at most {} rad/s around the pause", one["fastest"]);
    }
    let paused = &report["controller"];
    assert_eq!(
        (&paused["fault_before"], &paused["fault"]),
        (&json!(true), &json!(true)),
        "{paused}"
    );
    assert!(number(&paused["last_voltage"]) <= COMMAND_AGE + TWO_CYCLES, "{paused}");
    assert_eq!(
        (&paused["voltage_after"], &paused["state"]),
        (&json!(0.0), &json!("inactive")),
        "what it says when it wakes moves nothing"
    );
    assert_eq!(
        report["friction_observer"]["fault"], false,
        "the loop goes on without the observer"
    );
    // What was asked for while there was no rig, or while the rig driver stood still.
    assert_eq!(report["heard_again"], true);
    assert!(number(&report["old_references"]) < 0.01, "rad: {report}");
    assert_eq!(report["moves_with_new"], true);
    assert!(
        number(&report["unstamped_moves"]) > 1.9,
        "commands without a stamp count when they come: {report}"
    );
    let cycles = report["old_unstamped"].as_array().unwrap().len();
    assert!(cycles <= 1, "the first cycle afterwards takes the voltage away: {report}");
    assert_ended(&report["exit"]);
}
