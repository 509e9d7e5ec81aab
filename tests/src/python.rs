//! The Python environment that `cargo xtask python-env` makes.

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
