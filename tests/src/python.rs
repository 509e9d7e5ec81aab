//! The Python environment that `cargo xtask python-env` makes.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// The environment's interpreter, where the half of that name (`bag_tools`, `rclpy`) is ready; otherwise says so and the
/// test should end. `$FRICTION_PYTHON_ENV` names an environment elsewhere.
pub fn interpreter(half: &str) -> Option<PathBuf> {
    let folder = match std::env::var_os("FRICTION_PYTHON_ENV") {
        Some(named) => PathBuf::from(named),
        None => crate::profile_folder().parent()?.join("python"),
    };
    let python = folder.join("bin/python");
    if python.is_file() && folder.join(format!("{half}.stamp")).is_file() {
        return Some(python);
    }
    crate::skip(&format!("no Python with {half} in {}; `cargo xtask python-env` makes it", folder.display()));
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
    let output = Command::new(python).arg(script(name)).args(arguments).output().expect("Python starts");
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("the script prints JSON")
}

/// Runs pytest in a folder, behind `command` (`env`, or what makes a network namespace), and passes on what it skipped as lines that
/// begin with SKIPPED.
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
        let _ = writeln!(std::io::stderr(), "SKIPPED pytest: {}", line.trim_start_matches("SKIPPED").trim());
    }
}
