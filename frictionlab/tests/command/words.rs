//! What a person is told who mistyped, asked for too much, or ran out of disk; and the exit code.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn run(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_frictionlab"));
    command.current_dir(folder).args(args).stdin(Stdio::null()).output().unwrap()
}

#[test]
fn a_refusal_names_the_option_the_value_and_what_was_meant() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path();
    let specification = ["design", "position", "--rise", "0.2", "--settling", "1", "--overshoot"];
    for (args, expected, never) in [
        (vec!["rnu"], &["rnu", "run"][..], "panicked"),
        (vec!["run", "position-traking"], &["position-tracking"], "panicked"),
        (
            vec!["models", "lugree"],
            &["there is no friction model `lugree`", "did you mean `lugre`?"],
            "panicked",
        ),
        (vec!["protocols", "pre-slidng"], &["did you mean `pre-sliding`?"], "panicked"),
        (vec!["run", "--means", "feedbck"], &["feedback"], "panicked"),
        (vec!["run", "--voltage-limit", "240"], &["--voltage-limit", "240"], "rig's parameters"),
        (
            [&specification[..], &["-5"]].concat(),
            &["--overshoot", "is -5 %"],
            "controller's parameters",
        ),
        (
            vec!["design", "velocity", "--gains", "-1,2"],
            &["k_p of --gains", "-1"],
            "controller's parameters",
        ),
    ] {
        let output = run(folder, &args);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {said}");
        for part in expected {
            assert!(said.contains(part), "{args:?}: {said}");
        }
        assert!(!said.contains(never), "{args:?}: {said}");
    }
    assert!(fs::read_dir(folder).unwrap().next().is_none(), "something was written");
}

#[cfg(feature = "ros")]
#[test]
fn a_reference_faster_than_the_loop_is_refused_with_the_fastest() {
    let root = tempfile::tempdir().unwrap();
    let output = run(root.path(), &["live", "--duration", "1", "--frequency", "9999999"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(
        said.contains("--frequency") && said.contains("3142 rad/s") && said.contains("9999999"),
        "{said}"
    );
}

/// Every signal that ends a program gives its own code, and what there was is written.
#[cfg(target_os = "linux")]
#[test]
fn each_signal_has_its_exit_code() {
    for (signal, number, code) in [("INT", 2, 130), ("TERM", 15, 143), ("HUP", 1, 129)] {
        let root = tempfile::tempdir().unwrap();
        let mut child = Command::new(env!("CARGO_BIN_EXE_frictionlab"))
            .args(["run", "--repetitions", "1000", "--quiet", "--out", "out"])
            .current_dir(root.path())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        while !catches(child.id(), number) || !root.path().join("out/bag").is_dir() {
            assert!(child.try_wait().unwrap().is_none(), "ended before the signal");
            std::thread::yield_now();
        }
        let pid = child.id().to_string();
        assert!(
            Command::new("kill").args([&format!("-{signal}"), &pid]).status().unwrap().success()
        );
        let output = child.wait_with_output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "SIG{signal}: {said}");
        assert!(said.contains("stopped before the end"), "{said}");
        assert!(root.path().join("out/report.html").is_file());
    }
}

/// Whether the process has a handler for the signal: a bit of the signals caught (proc(5)).
#[cfg(target_os = "linux")]
fn catches(process: u32, signal: u32) -> bool {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
    caught
        .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
        .is_some_and(|mask| mask & (1 << (signal - 1)) != 0)
}
