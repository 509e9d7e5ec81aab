//! The Python packages `friction_analysis` and `frictionlab`, tested by pytest: on a bag of the
//! built program, with the real rclpy, and with the extension module as it was built beside the
//! program.

use std::path::PathBuf;
use std::process::Command;

use tests::{network, python};

fn package() -> PathBuf {
    tests::checkout().join("python")
}

#[tests::needs(bag_tools)]
#[test]
fn bags_become_tables_curves_and_figures() {
    let python = python::interpreter("bag_tools");
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("run");
    let run = tests::frictionlab()
        .args([
            "run",
            "velocity-tracking",
            "--quick",
            "--repetitions",
            "1",
            "--model",
            "lugre",
            "--quiet",
        ])
        .arg("--out")
        .arg(&out)
        .output()
        .expect("frictionlab starts");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let mut command = Command::new("env");
    command.env("FRICTION_TEST_BAG", out.join("bag"));
    python::pytest(
        command,
        &python,
        &package(),
        &["--ignore=tests/test_ros.py", "--ignore=tests/laboratory"],
    );
}

#[tests::needs(rclpy, bag_tools, namespace)]
#[test]
fn live_plots_and_experiments_work_with_the_real_rclpy() {
    let python = python::interpreter("rclpy");
    let mut command = network::namespaced();
    let folder = tempfile::tempdir().expect("a folder");
    command
        .env("FRICTION_ROS_TESTS", "1")
        .env("FRICTIONLAB_BIN", tests::frictionlab().get_program())
        .env("ROS_DOMAIN_ID", "75")
        .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        .env("ROS_LOG_DIR", folder.path());
    python::pytest(command, &python, &package(), &["tests/test_ros.py"]);
}

#[tests::needs(bag_tools, python_tools)]
#[test]
fn the_laboratory_computes_in_python_what_the_command_computes() {
    let python = python::interpreter("python_tools");
    let folder = tempfile::tempdir().expect("a folder");
    let (root, out) = (folder.path().join("package"), folder.path().join("run"));
    python::assembled(&root);
    let run = tests::frictionlab()
        .args(["run", "velocity-tracking", "--quick", "--repetitions", "1", "--model", "lugre"])
        .args(["--quiet", "--out"])
        .arg(&out)
        .output()
        .expect("frictionlab starts");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let mut command = Command::new("env");
    command
        .env("FRICTIONLAB_BIN", tests::frictionlab().get_program())
        .env("FRICTION_TEST_BAG", out.join("bag"));
    if let Some(data) = machine::recordings() {
        command.env("FRICTION_DATA", data);
    }
    python::pytest(command, &python, &root, &["tests/laboratory"]);
}
