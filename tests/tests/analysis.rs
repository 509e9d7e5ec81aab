//! The Python package `friction_analysis`, tested by pytest: on a bag of the built program, and with the real rclpy.

use std::io::Write;
use std::path::Path;
use std::process::Command;

use tests::{network, python};

/// Runs pytest on one part of the package's tests and passes on, as SKIPPED lines, what it could not test.
fn pytest(mut command: Command, python: &Path, arguments: &[&str]) {
    let package = tests::checkout().join("analysis");
    let output = command
        .arg(python)
        .args(["-B", "-m", "pytest", "-q", "-rs", "--tb=short"])
        .args(arguments)
        .current_dir(package)
        .env("MPLBACKEND", "Agg")
        .output()
        .expect("Python starts");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}\n{}", String::from_utf8_lossy(&output.stderr));
    for line in said.lines().filter(|line| line.starts_with("SKIPPED")) {
        // Past libtest's capture, as tests::skip does.
        let _ = writeln!(std::io::stderr(), "SKIPPED pytest: {}", line.trim_start_matches("SKIPPED").trim());
    }
}

/// `env` with nothing: pytest needs no network namespace.
fn plain() -> Command {
    Command::new("env")
}

#[test]
fn bags_become_tables_curves_and_figures() {
    let Some(python) = python::interpreter("bag_tools") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("run");
    let run = tests::frictionlab()
        .args(["run", "velocity-tracking", "--quick", "--repetitions", "1", "--model", "lugre", "--quiet"])
        .arg("--out")
        .arg(&out)
        .output()
        .expect("frictionlab starts");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let mut command = plain();
    command.arg(format!("FRICTION_TEST_BAG={}", out.join("bag").display()));
    pytest(command, &python, &["--ignore=tests/test_ros.py"]);
}

#[test]
fn live_plots_and_experiments_work_with_the_real_rclpy() {
    let Some(python) = python::interpreter("rclpy") else { return };
    if python::interpreter("bag_tools").is_none() {
        return;
    }
    let Some(mut command) = network::namespaced() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    command
        .env("FRICTION_ROS_TESTS", "1")
        .env("FRICTIONLAB_BIN", tests::frictionlab().get_program())
        .env("ROS_DOMAIN_ID", "75")
        .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        .env("ROS_LOG_DIR", folder.path());
    pytest(command, &python, &["tests/test_ros.py"]);
}
