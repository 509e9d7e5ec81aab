//! Setting a rig up as a person does: list, jog, check, calibrate, and the profile that carries
//! what was found from one command to the next.

use std::path::Path;
use std::process::{Command, Output, Stdio};

use tests::emulated_rig::{EmulatedRig, SHORT_PROTOCOL, said};

/// `frictionlab` in a folder.
fn frictionlab(folder: &Path, arguments: &[&str]) -> Output {
    let mut command: Command = tests::frictionlab();
    command.args(arguments).current_dir(folder).env("XDG_RUNTIME_DIR", folder).stdin(Stdio::null());
    command.output().expect("it runs")
}

fn succeeds(folder: &Path, arguments: &[&str]) -> String {
    let output = frictionlab(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", said(&output));
    said(&output)
}

/// The same on the emulated device. The emulator is a program that has to keep time: on a machine
/// that is too busy for it, it falls silent, and what is repeated takes long. None then, and the
/// test says that it was skipped.
fn succeeds_in_real_time(folder: &Path, arguments: &[&str]) -> Option<String> {
    for _ in 0..2 {
        // Twice the time that the longest step takes on a quiet machine; `timeout` then ends with
        // 124.
        let mut command = Command::new("timeout");
        command
            .args(["--signal=INT", "--kill-after=20", "100"])
            .arg(tests::frictionlab().get_program());
        command
            .args(arguments)
            .current_dir(folder)
            .env("XDG_RUNTIME_DIR", folder)
            .stdin(Stdio::null());
        let output = command.output().expect("it runs");
        if output.status.code() == Some(124) {
            break;
        }
        let text = said(&output);
        if output.status.success() {
            return Some(text);
        }
        let busy = [
            "no measurement came",
            "host went silent",
            "cycle lost",
            "commands refused",
            "another host",
        ];
        assert!(busy.iter().any(|why| text.contains(why)), "{arguments:?}: {text}");
    }
    tests::leave_out("the machine is too busy for a device in real time");
    None
}

fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = frictionlab(folder, arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", said(&output));
    said(&output)
}

#[test]
fn a_jog_says_what_happened_and_that_nothing_did() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = succeeds(folder.path(), &["rig", "jog", "--volts", "0.8", "--seconds", "1"]);
    assert!(text.contains("applied        +0.80 V") && text.contains("travel         +"), "{text}");
    assert!(text.contains("rad/s by the encoder"), "{text}");
    // A line now and then, where the output is no terminal: the last of them shows a shaft that
    // moves.
    let shown: Vec<&str> =
        text.lines().filter(|line| line.contains("encoder") && line.contains(" s  ")).collect();
    assert!(!shown.is_empty() && shown.iter().all(|line| !line.contains("+0 = ")), "{text}");
    let text = succeeds(folder.path(), &["rig", "jog", "--volts", "-0.2", "--seconds", "0.5"]);
    assert!(text.contains("none: the encoder stayed") && text.contains("-0.20 V"), "{text}");
}

#[test]
fn an_emulator_that_runs_is_listed_and_one_that_is_gone_is_not() {
    let rig = EmulatedRig::start(&[]);
    let runtime = tempfile::tempdir().expect("a folder");
    let list = |folder: &Path| succeeds(folder, &["rig", "list"]);
    let text = list(rig.folder());
    assert!(text.contains(&rig.name()) && !text.contains("no serial port"), "{text}");
    assert!(!list(runtime.path()).contains(&rig.name()));
    // What a killed emulator leaves.
    let left = runtime.path().join("frictionlab/rigs");
    std::fs::create_dir_all(&left).expect("a folder");
    std::fs::write(left.join("1"), rig.folder().join("port").display().to_string())
        .expect("a file");
    assert!(!list(runtime.path()).contains(&rig.name()));
}

#[test]
fn a_calibration_that_cannot_be_written_moves_nothing() {
    let rig = EmulatedRig::start(&[]);
    let folder = rig.folder();
    std::fs::write(folder.join("file"), "").expect("a file");
    std::fs::write(folder.join("calibration.yaml"), "mine").expect("a file");
    let choice = rig.choice();
    refused(folder, &["rig", "calibrate", &choice, "--out", "file/deep"]);
    let text = refused(folder, &["rig", "calibrate", &choice]);
    assert!(text.contains("calibration.yaml") && text.contains("--force"), "{text}");
    refused(folder, &["rig", "calibrate", &choice, "--rig-file", "nowhere/rig.yaml"]);
    refused(folder, &["rig", "check", &choice, "--rig-file", "file/rig.yaml"]);
    assert_eq!(std::fs::read_to_string(folder.join("calibration.yaml")).expect("a file"), "mine");
    assert_eq!(rig.finish()["books"]["driven"], 0);
}

#[test]
fn the_voltage_range_is_the_rigs_own_and_nobody_goes_beyond_it() {
    let rig = EmulatedRig::start(&["--voltage-range", "24"]);
    let (folder, choice) = (rig.folder(), rig.choice());
    let jog = |more: &[&'static str]| -> Vec<&str> {
        let common = ["rig", "jog", &choice, "--volts", "0", "--seconds", "0.1"];
        common.into_iter().chain(more.iter().copied()).collect()
    };
    // The usual limit stays, whatever the board could do.
    assert!(refused(folder, &jog(&["--max-volts", "8"])).contains("voltage limit"));
    if succeeds_in_real_time(folder, &jog(&["--max-volts", "8", "--voltage-limit", "12"])).is_none()
    {
        return;
    }
    let text = refused(folder, &jog(&["--voltage-limit", "30"]));
    assert!(text.contains("voltage range") && text.contains("30 V"), "{text}");
    let run = ["run", "position-tracking", "--quick", &choice, "--voltage-limit", "30"];
    let text = refused(folder, &run);
    assert!(text.contains("voltage range"), "{text}");
    assert_eq!(rig.finish()["books"]["driven"], 0);
}

#[test]
fn a_profile_that_lies_in_the_folder_drives_nothing_by_itself() {
    let rig = EmulatedRig::start(&[]);
    let folder = rig.folder();
    std::fs::write(folder.join("rig.yaml"), format!("rig: {}\n", rig.name())).expect("a profile");
    let text = succeeds(folder, &["run", "velocity-tracking", "--quick", "--model", "lugre"]);
    assert!(text.contains("simulated") && text.contains("--rig-file rig.yaml"), "{text}");
    succeeds(folder, &["rig", "jog", "--volts", "1", "--seconds", "0.1"]);
    std::fs::write(
        folder.join("rig.yaml"),
        format!("rig: {}\nlimits: {{volts: 9.0}}\n", rig.name()),
    )
    .expect("a profile");
    for arguments in [
        vec!["run", "velocity-tracking", "--quick", "--rig-file", "rig.yaml"],
        vec!["rig", "jog", "--volts", "1", "--rig-file", "rig.yaml"],
        vec!["live", "--duration", "1", "--rig-file", "rig.yaml"],
    ] {
        let text = refused(folder, &arguments);
        assert!(text.contains("volts") && text.contains("rig.yaml"), "{text}");
    }
    let choice = rig.choice();
    assert!(refused(folder, &["rig", "jog", "--volts", "1", &choice]).contains("volts"));
    assert_eq!(rig.finish()["books"]["driven"], 0);
}

#[test]
fn one_profile_goes_from_the_check_to_the_experiment() {
    let rig = EmulatedRig::start(&["--plant", "lugre"]);
    let folder = rig.folder();
    let profile = || std::fs::read_to_string(folder.join("rig.yaml")).expect("a profile");
    let with = ["--rig-file", "rig.yaml"];
    assert!(refused(folder, &["rig", "check", "--rig-file", "rig.yaml"]).contains("--rig serial:"));
    let choice = rig.choice();
    let Some(text) = succeeds_in_real_time(
        folder,
        &["rig", "check", &choice, "--rig-file", "rig.yaml", "--quiet"],
    ) else {
        return;
    };
    assert!(text.contains("Rig profile  rig.yaml"), "{text}");
    assert!(
        profile().contains("voltage_range: 5.99") && !profile().contains("\ncalibration:"),
        "{}",
        profile()
    );

    if succeeds_in_real_time(folder, &[&["rig", "calibrate", "--quiet"][..], &with].concat())
        .is_none()
    {
        return;
    }
    assert!(profile().contains("tachometer_gain: "), "{}", profile());
    assert!(!folder.join("calibration.yaml").exists());

    let run = ["run", "drive-excitation", "--out", "excitation", "--force"];
    let Some(text) = succeeds_in_real_time(folder, &[&run[..], &with].concat()) else { return };
    assert!(text.contains("rig profile rig.yaml: ") && text.contains("calibration"), "{text}");
    let bag = "excitation/bag";
    let Some(text) = succeeds_in_real_time(folder, &[&["identify-drive", bag][..], &with].concat())
    else {
        return;
    };
    assert!(text.contains("drive written, with the motor's constants"), "{text}");
    let number = |key: &str| -> f64 {
        let text = profile();
        let line = text.lines().find(|line| line.trim_start().starts_with(key)).expect("the key");
        line.rsplit(' ').next().expect("a number").parse().expect("a number")
    };
    assert!((number("gain:") / 1.8625 - 1.0).abs() < 0.03, "{}", profile());
    assert!((number("inertia:") / 2.6476e-3 - 1.0).abs() < 0.05, "{}", profile());

    std::fs::write(folder.join("protocol.yaml"), SHORT_PROTOCOL).expect("a protocol");
    let run = ["run", "--protocol", "protocol.yaml", "--out", "steady", "--force"];
    let Some(text) = succeeds_in_real_time(folder, &[&run[..], &with].concat()) else { return };
    assert!(text.contains("calibration, drive"), "{text}");
    let results = std::fs::read_to_string(folder.join("steady/run.json")).expect("run.json");
    assert!(results.contains("\"rig_profile\""), "{results}");
    assert_eq!(rig.finish()["voltage"], 0);
}
