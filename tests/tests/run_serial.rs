//! `frictionlab run` against the emulated rig on a pseudo-terminal: experiments on a real rig, in
//! real time.

use std::path::Path;
use std::process::{Child, Command, Output, Stdio};

use serde_json::Value;
use tests::emulated_rig::{EmulatedRig, SHORT_PROTOCOL, said};
use tests::unstarved;

fn run(rig: &str, folder: &Path, arguments: &[&str]) -> Command {
    let protocol = folder.join("protocol.yaml");
    std::fs::write(&protocol, SHORT_PROTOCOL).expect("a protocol");
    let mut command = tests::frictionlab();
    command.arg("run").arg("--protocol").arg(protocol).args(arguments).stdin(Stdio::null());
    if !rig.is_empty() {
        command.arg(rig);
    }
    command
}

/// Whether a busy machine starved the line until the run gave up: another disturbance than the
/// test's.
fn starved(output: &Output) -> bool {
    let text = said(output);
    let failed = text.split_once("The line to the rig failed ").map(|(_, behind)| behind);
    let times = failed.and_then(|text| text.split(' ').next()?.parse::<u32>().ok());
    times.is_some_and(|times| times >= 20)
}

/// A run of the rig once its motor had volts in `least` cycles; none where its line was starved.
fn underway(rig: &mut EmulatedRig, out: &Path, least: u64) -> Option<Child> {
    let mut child = run(&rig.choice(), rig.folder(), &[&format!("--out={}", out.display())])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    if rig.driven_by(&mut child, least) {
        return Some(child);
    }
    let output = child.wait_with_output().expect("its end");
    assert!(starved(&output), "{}", said(&output));
    None
}

/// The points that were measured: velocity and torque.
fn points(folder: &Path) -> Vec<(f64, f64)> {
    let text = std::fs::read_to_string(folder.join("run.json")).expect("run.json");
    let results: Value = serde_json::from_str(&text).expect("JSON");
    let number = |point: &Value, name: &str| point[name].as_f64().expect("a number");
    let points = results["constant_velocity"].as_array().expect("points");
    points.iter().map(|point| (number(point, "velocity"), number(point, "torque"))).collect()
}

/// Whether two means of 0.6 s are alike; the encoder's slope is good to a count over that time.
fn alike((real, offline): (&(f64, f64), &(f64, f64))) -> bool {
    (real.0 - offline.0).abs() < 5e-3 && (real.1 - offline.1).abs() < 1e-3
}

/// A command that comes late on a busy machine gets zero volts for a cycle, as it must, and the
/// mean of that point is another. So each point must agree in one of some measurements; on a quiet
/// machine the first has them all.
#[test]
fn an_experiment_on_the_device_measures_what_it_measures_offline() {
    let rig = EmulatedRig::start(&[]);
    let measure = |choice: &str, name: &str| {
        let out = unstarved(|| {
            let out = tempfile::tempdir_in(rig.folder()).expect("a folder").keep().join(name);
            let output = run(choice, rig.folder(), &[&format!("--out={}", out.display())])
                .output()
                .expect("it runs");
            assert!(output.status.success() || starved(&output), "{}", said(&output));
            output.status.success().then_some(out)
        })?;
        let found = points(&out);
        assert_eq!(found.len(), 8);
        Some((out, found))
    };
    let (_, offline) = measure("", "offline").expect("no line to starve");
    let mut agreed = [false; 8];
    let mut measured = Vec::new();
    for attempt in 1..=5 {
        let Some((real, found)) = measure(&rig.choice(), &format!("real-{attempt}")) else {
            return;
        };
        for (agreed, pair) in agreed.iter_mut().zip(found.iter().zip(&offline)) {
            *agreed |= alike(pair);
        }
        assert!(real.join("bag/metadata.yaml").is_file());
        let report = std::fs::read_to_string(real.join("report.html")).expect("a report");
        assert!(report.contains("rig serial:") && !report.contains("the rig is simulated"));
        measured.push(found);
        if agreed == [true; 8] {
            break;
        }
    }
    println!("{} measurements were needed", measured.len());
    assert_eq!(agreed, [true; 8], "{measured:?}, offline {offline:?}");
    let summary = rig.finish();
    assert_eq!((&summary["state"], &summary["voltage"]), (&"inactive".into(), &0.into()));
    assert!(summary["books"]["driven"].as_u64().expect("a number") > 8 * 1600, "{summary}");
}

#[test]
fn a_cable_pulled_in_the_middle_ends_the_run_with_a_sentence_and_keeps_what_was_measured() {
    unstarved(|| {
        let mut rig = EmulatedRig::start(&[]);
        let out = rig.folder().join("real");
        // In the third point.
        let child = underway(&mut rig, &out, 2 * 1700 + 500)?;
        rig.order("unplug 100000");
        let output = child.wait_with_output().expect("it ends");
        if starved(&output) {
            return None;
        }
        let text = said(&output);
        assert_eq!(output.status.code(), Some(1), "{text}");
        assert!(text.contains("the run ended early") && text.contains("is gone"), "{text}");
        assert!(text.contains("did not come back within 30 s"), "{text}");
        assert!(!points(&out).is_empty() && points(&out).len() < 8, "{:?}", points(&out));
        assert!(out.join("bag/metadata.yaml").is_file());
        assert_eq!(rig.finish()["voltage"], 0);
        Some(())
    });
}

/// A run in which `order` is given to the device in the middle of the third point; what it printed,
/// its exit code and its results.
fn disturbed(order: &str) -> Option<(String, Option<i32>, Value, Value)> {
    unstarved(|| {
        let mut rig = EmulatedRig::start(&[]);
        let out = rig.folder().join("real");
        let child = underway(&mut rig, &out, 2 * 1700 + 500)?;
        rig.order(order);
        let output = child.wait_with_output().expect("it ends");
        if starved(&output) {
            return None;
        }
        let text = std::fs::read_to_string(out.join("run.json")).expect("run.json");
        let results = serde_json::from_str(&text).expect("JSON");
        assert!(out.join("bag/metadata.yaml").is_file());
        Some((said(&output), output.status.code(), results, rig.finish()))
    })
}

#[test]
fn a_line_that_fails_and_comes_back_costs_the_run_at_hand_and_no_more() {
    // Silent with the port open, the cable out and in, the device started anew.
    for order in ["hang 600", "unplug 1500", "reboot 500"] {
        let Some((text, code, results, summary)) = disturbed(order) else { continue };
        assert_eq!(code, Some(0), "{order}: {text}");
        assert_eq!(results["status"], "complete", "{order}");
        assert_eq!(results["constant_velocity"].as_array().map(Vec::len), Some(8), "{order}");
        let reconnections = results["reconnections"].as_array().expect("told");
        // A busy machine may add silences of its own.
        assert!(!reconnections.is_empty(), "{order}: {results}");
        assert!(text.contains("was repeated"), "{order}: {text}");
        assert_eq!((&summary["state"], &summary["voltage"]), (&"inactive".into(), &0.into()));
    }
}

#[test]
fn what_the_device_stopped_the_motor_for_is_never_repeated() {
    for order in ["fault", "stop"] {
        let Some((text, code, results, summary)) = disturbed(order) else { continue };
        assert_eq!(code, Some(1), "{order}: {text}");
        assert!(text.contains("the run ended early"), "{order}: {text}");
        assert_eq!(results["status"], "interrupted", "{order}");
        assert!(results["constant_velocity"].as_array().expect("points").len() < 8);
        assert_eq!(summary["voltage"], 0);
    }
}

#[test]
fn ctrl_c_puts_the_motor_at_zero_volts_in_the_middle_of_a_run() {
    unstarved(|| {
        let mut rig = EmulatedRig::start(&[]);
        let out = rig.folder().join("real");
        // In the second point.
        let child = underway(&mut rig, &out, 1700 + 500)?;
        let killed =
            Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
        assert!(killed.success());
        let output = child.wait_with_output().expect("it ends");
        if starved(&output) {
            return None;
        }
        assert_eq!(output.status.code(), Some(130), "{}", said(&output));
        assert!(points(&out).len() < 4);
        let summary = rig.finish();
        assert_eq!((&summary["state"], &summary["voltage"]), (&"inactive".into(), &0.into()));
        Some(())
    });
}

#[test]
fn points_that_no_curve_fits_are_kept_all_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("few");
    let mut command = run("", folder.path(), &[&format!("--out={}", out.display())]);
    std::fs::write(
        folder.path().join("protocol.yaml"),
        SHORT_PROTOCOL.replace("points: 8", "points: 4"),
    )
    .expect("a protocol");
    let output = command.output().expect("it runs");
    let text = said(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert_eq!(text.matches("at least 8 samples").count(), 1, "{text}");
    assert_eq!(points(&out).len(), 4);
    assert!(out.join("bag/metadata.yaml").is_file() && out.join("report.html").is_file());
}

#[test]
fn what_a_device_cannot_measure_is_told_before_anything_moves() {
    let rig = EmulatedRig::start(&["--without", "torque", "--without", "current"]);
    for (source, mend) in
        [("sensor", "--torque-source voltage"), ("current", "--torque-source voltage")]
    {
        let out = rig.folder().join(source);
        let output = run(
            &rig.choice(),
            rig.folder(),
            &[&format!("--out={}", out.display()), "--torque-source", source],
        )
        .output()
        .expect("it runs");
        let text = said(&output);
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.contains(mend), "{text}");
        assert!(!out.exists());
    }
    let summary = rig.finish();
    assert_eq!(summary["books"]["driven"], 0, "{summary}");
}
