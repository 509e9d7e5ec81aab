//! The Python environment that `cargo xtask python-env` makes.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// A distribution of ROS 2 whose real rclpy the tests can have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Distribution {
    /// The one that the laboratory is made for; the environment of `cargo xtask python-env`.
    Kilted,
    /// The one before, which is supported for longer; the environment of
    /// `cargo xtask python-env --distribution jazzy`.
    Jazzy,
}

impl Distribution {
    /// As ROS 2 writes it, as in `ROS_DISTRO`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Kilted => "kilted",
            Self::Jazzy => "jazzy",
        }
    }
}

/// The interpreter with a distribution's rclpy; otherwise says so and the test should end.
/// `$FRICTION_PYTHON_ENV` and `$FRICTION_PYTHON_ENV_JAZZY` name environments elsewhere.
pub fn interpreter_of(distribution: Distribution) -> Option<PathBuf> {
    match distribution {
        Distribution::Kilted => interpreter("rclpy"),
        Distribution::Jazzy => {
            let made_by = "cargo xtask python-env --distribution jazzy";
            interpreter_in("FRICTION_PYTHON_ENV_JAZZY", "python-jazzy", "rclpy", made_by)
        }
    }
}

/// The environment's interpreter, where the part of that name (`bag_tools`, `rclpy`, `colcon`) is
/// ready; otherwise says so and the test should end. `$FRICTION_PYTHON_ENV` names an environment
/// elsewhere.
pub fn interpreter(half: &str) -> Option<PathBuf> {
    interpreter_in("FRICTION_PYTHON_ENV", "python", half, "cargo xtask python-env")
}

fn interpreter_in(variable: &str, beside: &str, half: &str, made_by: &str) -> Option<PathBuf> {
    let folder = match std::env::var_os(variable) {
        Some(named) => PathBuf::from(named),
        None => crate::profile_folder().parent()?.join(beside),
    };
    let python = folder.join("bin/python");
    if python.is_file() && folder.join(format!("{half}.stamp")).is_file() {
        return Some(python);
    }
    crate::skip(&format!("no Python with {half} in {}; `{made_by}` makes it", folder.display()));
    None
}

/// The interpreter of an environment of its own with a peer, as `cyclone`, where it is ready;
/// otherwise says so and the test should end. `$FRICTION_PYTHON_ENV` names the main environment; a
/// peer's stands beside it.
pub fn peer(name: &str) -> Option<PathBuf> {
    let main = match std::env::var_os("FRICTION_PYTHON_ENV") {
        Some(named) => PathBuf::from(named),
        None => crate::profile_folder().parent()?.join("python"),
    };
    let folder = main.with_file_name(format!("python-{name}"));
    let python = folder.join("bin/python");
    if python.is_file() && folder.join(format!("{name}.stamp")).is_file() {
        return Some(python);
    }
    crate::skip(&format!(
        "no Python with {name} in {}; `cargo xtask python-env` makes it",
        folder.display()
    ));
    None
}

/// A script of `tests/python/`.
pub fn script(name: &str) -> PathBuf {
    crate::checkout().join("tests/python").join(name)
}

/// Runs a script and reads the JSON it prints.
///
/// # Panics
/// When the script fails or prints something else; the message carries what it said.
pub fn json(python: &Path, name: &str, arguments: &[&str]) -> Value {
    let output =
        Command::new(python).arg(script(name)).args(arguments).output().expect("Python starts");
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("the script prints JSON")
}

/// Runs pytest in a folder, behind `command` (`env`, or what makes a network namespace), and passes
/// on what it skipped as lines that begin with SKIPPED.
///
/// # Panics
/// When a test fails; the message carries what pytest said.
pub fn pytest(mut command: Command, python: &Path, folder: &Path, arguments: &[&str]) {
    let output = command
        .arg(python)
        .args(["-B", "-m", "pytest", "-q", "-rs", "--tb=short"])
        .args(arguments)
        .current_dir(folder)
        .env("MPLBACKEND", "Agg")
        .output()
        .expect("Python starts");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}\n{}", String::from_utf8_lossy(&output.stderr));
    for line in said.lines().filter(|line| line.starts_with("SKIPPED")) {
        // Past libtest's capture, as `skip` does; nothing is lost if nobody listens.
        let _ = writeln!(
            std::io::stderr(),
            "SKIPPED pytest: {}",
            line.trim_start_matches("SKIPPED").trim()
        );
    }
}
