//! `frictionlab run --resume`: a run that was killed goes on, on the simulated rig and on a device.

use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

use serde_json::Value;
use tests::emulated_rig::{EmulatedRig, SHORT_PROTOCOL, said};

/// `frictionlab run` in a folder that has the protocol.
fn run(folder: &Path, arguments: &[&str]) -> Command {
    std::fs::write(folder.join("protocol.yaml"), SHORT_PROTOCOL).expect("a protocol");
    let mut command = tests::frictionlab();
    command.current_dir(folder).arg("run").args(arguments).stdin(Stdio::null());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn resume(run: &Path, from: &Path) -> Output {
    let mut command = tests::frictionlab();
    command.current_dir(from).args(["run", "--json", "--resume"]).arg(run).stdin(Stdio::null());
    command.output().expect("it runs")
}

/// Kills the run once its journal has `jobs` jobs. What it said, where it ended by itself before.
fn kill_after(mut child: Child, run: &Path, jobs: usize) -> Result<(), String> {
    let done = || {
        let text = std::fs::read_to_string(run.join("journal.jsonl")).unwrap_or_default();
        text.matches("{\"done\"").count()
    };
    while done() < jobs {
        if child.try_wait().expect("a child").is_some() {
            return Err(said(&child.wait_with_output().expect("its end")));
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    child.kill().expect("it runs");
    child.wait().expect("it was killed");
    Ok(())
}

/// A machine that is busy elsewhere starved the line to the device.
fn starved(text: &str) -> bool {
    ["no measurement came from", "keeps this machine busy"].iter().any(|one| text.contains(one))
}

fn results(text: &[u8]) -> Value {
    serde_json::from_slice(text).expect("JSON")
}

/// What a run that went on once says of itself.
fn went_on(output: &Output, run: &Path) -> Value {
    assert_eq!(output.status.code(), Some(0), "{}", said(output));
    let found = results(&output.stdout);
    assert_eq!(found["status"], "complete");
    let sessions = found["sessions"].as_array().expect("sittings");
    assert_eq!(sessions.len(), 2, "{sessions:?}");
    assert_eq!(sessions[0]["jobs"], sessions[1]["first_job"]);
    assert_eq!(sessions[0]["bag"], "bag_before_resume_1");
    for bag in ["bag", "bag_before_resume_1"] {
        let output = tests::frictionlab()
            .args(["bag", "info"])
            .arg(run.join(bag))
            .output()
            .expect("it runs");
        assert!(output.status.success(), "{}", said(&output));
    }
    assert!(!run.join("journal.jsonl").exists());
    found
}

#[test]
fn a_run_that_was_killed_goes_on_and_finds_what_one_in_one_piece_finds() {
    let folder = tempfile::tempdir().expect("a folder");
    let whole = run(folder.path(), &["--protocol", "protocol.yaml", "--out=whole", "--json"]);
    let whole = { whole }.output().expect("it runs");
    assert!(whole.status.success(), "{}", said(&whole));
    let out = folder.path().join("out");
    let child =
        run(folder.path(), &["--protocol", "protocol.yaml", "--out=out", "--real-time"]).spawn();
    kill_after(child.expect("it starts"), &out, 3).expect("it goes on");

    // The folder and nothing else, from wherever.
    let elsewhere = tempfile::tempdir().expect("a folder");
    let found = went_on(&resume(&out, elsewhere.path()), &out);
    let whole = results(&whole.stdout);
    for figures in ["constant_velocity", "identification"] {
        assert_eq!(found[figures], whole[figures]);
    }
    let again = resume(&out, elsewhere.path());
    assert_eq!(again.status.code(), Some(2), "{}", said(&again));
    assert!(said(&again).contains("this run is complete"), "{}", said(&again));
}

#[test]
fn a_run_whose_protocol_was_edited_meanwhile_does_not_go_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let child =
        run(folder.path(), &["--protocol", "protocol.yaml", "--out=out", "--real-time"]).spawn();
    kill_after(child.expect("it starts"), &out, 1).expect("it goes on");
    let edited = SHORT_PROTOCOL.replace("1.7 s", "1.8 s");
    std::fs::write(folder.path().join("protocol.yaml"), edited).expect("a protocol");
    let output = resume(&out, folder.path());
    let text = said(&output);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains("constant_velocity.duration was 1.7, is 1.8"), "{text}");
}

#[test]
fn a_run_on_a_device_goes_on_after_a_kill() {
    let tried = || {
        let rig = EmulatedRig::start(&[]);
        let out = rig.folder().join("out");
        let arguments = ["--protocol", "protocol.yaml", "--out=out", &rig.choice()];
        let child = run(rig.folder(), &arguments).spawn();
        if let Err(text) = kill_after(child.expect("it starts"), &out, 3) {
            assert!(starved(&text), "it ended by itself: {text}");
            return None;
        }
        let output = resume(&out, rig.folder());
        let ended = output.status.success() || !starved(&said(&output));
        ended.then(|| (went_on(&output, &out), rig))
    };
    let Some((found, rig)) = tests::unstarved(tried) else { return };
    let points = found["constant_velocity"].as_array().expect("points");
    assert_eq!(points.len(), 8);
    for point in points {
        let number = |name: &str| point[name].as_f64().expect("a number");
        // A machine that is busy elsewhere answers late, and the shaft is slower then: a tenth was
        // seen.
        let reference = number("reference");
        assert!((number("velocity") - reference).abs() < 0.05 + 0.3 * reference.abs(), "{point}");
    }
    let summary = rig.finish();
    assert_eq!((&summary["state"], &summary["voltage"]), (&"inactive".into(), &0.into()));
    let driven = summary["books"]["driven"].as_u64().expect("a number");
    assert!(driven > 8 * 1600, "{summary}");
}
