//! `frictionlab design` as a person calls it.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn frictionlab(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_frictionlab"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

/// The thesis's specification gives its gains, and a run tracks with what was designed.
#[test]
fn a_design_is_reported_and_used_by_a_run() {
    let root = tempfile::tempdir().unwrap();
    let arguments =
        ["design", "velocity", "--steady-state-error", ".01", "--crossover", "110", "--out", "lag"];
    let done = frictionlab(&arguments, root.path());
    let said = String::from_utf8_lossy(&done.stdout);
    assert!(done.status.success(), "{done:?}");
    assert!(said.contains("1.50870 V s/rad") && said.contains("strictly positive real"), "{said}");
    let page = fs::read_to_string(root.path().join("lag/report.html")).unwrap();
    assert!(page.contains("Open loop") && page.contains("phase margin"));

    let arguments = ["design", "position", "--gains", "20,100,.3", "--out", "pid", "--quiet"];
    assert!(frictionlab(&arguments, root.path()).status.success());
    let mse = |out: &str, more: &[&str]| {
        let mut arguments = vec![
            "run",
            "position-tracking",
            "--quick",
            "--quiet",
            "--model",
            "proposed",
            "--out",
            out,
        ];
        arguments.extend(more);
        let done = frictionlab(&arguments, root.path());
        assert!(done.status.success(), "{done:?}");
        let text = fs::read_to_string(root.path().join(out).join("run.json")).unwrap();
        let json: serde_json::Value = serde_json::from_str(&text).unwrap();
        json["position_tracking"]["rows"][0]["mse"].as_f64().unwrap()
    };
    // Without compensation, stiffer gains follow better.
    let (before, designed) = (mse("a", &[]), mse("b", &["--parameters", "pid/controller.yaml"]));
    assert!(designed < 0.2 * before, "{designed} {before}");
    let written = fs::read_to_string(root.path().join("b/parameters.yaml")).unwrap();
    let gains = fs::read_to_string(root.path().join("pid/controller.yaml")).unwrap();
    let k_p = gains.lines().find(|line| line.trim_start().starts_with("k_p")).unwrap().trim();
    assert!(written.contains(k_p), "{k_p} is not in\n{written}");
}

/// A design that is worse than no design, or that asks for more than the rig has, is told with what
/// to do.
#[test]
fn a_design_is_held_against_the_rig_and_the_default_gains() {
    let root = tempfile::tempdir().unwrap();
    let said = |arguments: &[&str]| {
        let arguments = [&["design"], arguments].concat();
        let done = frictionlab(&arguments, root.path());
        assert!(done.status.success(), "{done:?}");
        String::from_utf8(done.stdout).unwrap()
    };
    let soft = said(&["position", "--overshoot", "15", "--rise", "0.2", "--settling", "1"]);
    assert!(
        soft.contains("Warning: on the rig's friction these gains follow a sine of position 3."),
        "{soft}"
    );
    assert!(soft.contains("frictionlab design position --retuned"), "{soft}");
    let stiff = said(&["position", "--gains", "200,100,2"]);
    assert!(
        stiff.contains("and the rig gives 6 V") && stiff.contains("stay within the limit"),
        "{stiff}"
    );
    let loud = said(&["velocity", "--gains", "40,100"]);
    assert!(loud.contains("Warning: the sensors' noise puts"), "{loud}");
    for what in ["position", "velocity"] {
        let honest = said(&[what, "--retuned", "--out", what]);
        assert!(honest.contains("times better (mean square) than the default ones"), "{honest}");
    }
    assert!(
        fs::read_to_string(root.path().join("position/controller.yaml")).unwrap().contains("k_d")
    );
}

#[test]
fn a_drive_of_gain_and_time_constant_alone_can_be_designed_for() {
    let root = tempfile::tempdir().unwrap();
    fs::write(
        root.path().join("drive.yaml"),
        "/drive_identification:\n  ros__parameters:\n    gain: 2.5\n    time_constant: 0.04\n",
    )
    .unwrap();
    let arguments = [
        "design",
        "velocity",
        "--crossover",
        "50",
        "--phase-margin",
        "70",
        "--drive",
        "drive.yaml",
    ];
    let done = frictionlab(&arguments, root.path());
    let said = String::from_utf8_lossy(&done.stdout);
    assert!(done.status.success() && said.contains("K = 2.5 rad/s per V, T = 0.04 s"), "{done:?}");
}

#[test]
fn what_cannot_be_designed_is_refused_with_a_sentence() {
    let root = tempfile::tempdir().unwrap();
    for (arguments, said) in [
        (&["design", "velocity", "--crossover", "50"][..], "expected one of"),
        (
            &["design", "velocity", "--crossover", "50", "--phase-margin", "20"],
            "between 39.9 and 129.9 degrees",
        ),
        (&["design", "position", "--gains", "1,2"], "three numbers"),
        (
            &["design", "position", "--overshoot", "1", "--rise", ".001", "--settling", ".002"],
            "the nearest has overshoot",
        ),
        (
            &["design", "velocity", "--gains", "1,20", "--gain", "-1"],
            "--gain [rad/s per V] must be",
        ),
        (
            &["design", "position", "--overshoot", "-3", "--rise", ".2", "--settling", "1"],
            "overshoot",
        ),
        (&["design", "velocity", "--gains", "1,20", "--drive", "nowhere.yaml"], "nowhere.yaml"),
    ] {
        let done = frictionlab(arguments, root.path());
        let text = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(2), "{arguments:?}: {text}");
        assert!(text.contains(said), "{arguments:?}: {text}");
    }
    assert!(fs::read_dir(root.path()).unwrap().next().is_none(), "something was written");
}
