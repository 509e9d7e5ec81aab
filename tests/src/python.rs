//! The Python environment that `cargo xtask python-env` makes.

use std::fs;
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

/// The interpreter with a distribution's rclpy. `$FRICTION_PYTHON_ENV` and
/// `$FRICTION_PYTHON_ENV_JAZZY` name environments elsewhere.
///
/// # Panics
/// As [`interpreter`].
pub fn interpreter_of(distribution: Distribution) -> PathBuf {
    match distribution {
        Distribution::Kilted => interpreter("rclpy"),
        Distribution::Jazzy => interpreter_in("FRICTION_PYTHON_ENV_JAZZY", "python-jazzy", "rclpy"),
    }
}

/// The environment's interpreter with the part of that name: `bag_tools`, `rclpy` or `colcon`.
/// `$FRICTION_PYTHON_ENV` names an environment elsewhere.
///
/// # Panics
/// Where it is not ready: the test says what it needs by [`needs`](macro@crate::needs).
pub fn interpreter(part: &str) -> PathBuf {
    interpreter_in("FRICTION_PYTHON_ENV", "python", part)
}

fn interpreter_in(variable: &str, beside: &str, part: &str) -> PathBuf {
    let folder = machine::environment(&crate::target_folder(), variable, beside);
    let (python, stamp) = (folder.join("bin/python"), folder.join(format!("{part}.stamp")));
    assert!(python.is_file() && stamp.is_file(), "no Python with {part} in {}", folder.display());
    python
}

/// The program `rerun` of an environment of its own. `$FRICTION_PYTHON_ENV_RERUN` names one
/// elsewhere. It is the program itself: the script of its name in `bin` starts it as a child, which
/// goes on when the script is killed.
///
/// # Panics
/// As [`interpreter`].
pub fn rerun() -> PathBuf {
    let python = interpreter_in("FRICTION_PYTHON_ENV_RERUN", "python-rerun", "rerun");
    let libraries = python.ancestors().nth(2).expect("a folder of its own").join("lib");
    let versions = std::fs::read_dir(libraries).expect("libraries").flatten();
    let program = |version: std::fs::DirEntry| version.path().join("site-packages/rerun_cli/rerun");
    versions.map(program).find(|program| program.is_file()).expect("the program of the viewer")
}

/// The interpreter of an environment of its own with a peer on Cyclone DDS.
/// `$FRICTION_PYTHON_ENV_CYCLONE` names one elsewhere.
///
/// # Panics
/// As [`interpreter`].
pub fn cyclone() -> PathBuf {
    interpreter_in("FRICTION_PYTHON_ENV_CYCLONE", "python-cyclone", "cyclone")
}

/// A MuJoCo that the tests can have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MuJoCo {
    /// The newest that the exports know.
    Newest,
    /// One from before its `dcmotor` could do without an input.
    Older,
}

/// The interpreter of an environment of its own with that MuJoCo. `$FRICTION_PYTHON_ENV_MUJOCO` and
/// `$FRICTION_PYTHON_ENV_MUJOCO_3` name environments elsewhere.
///
/// # Panics
/// As [`interpreter`].
pub fn mujoco(which: MuJoCo) -> PathBuf {
    match which {
        MuJoCo::Newest => interpreter_in("FRICTION_PYTHON_ENV_MUJOCO", "python-mujoco", "mujoco"),
        MuJoCo::Older => {
            interpreter_in("FRICTION_PYTHON_ENV_MUJOCO_3", "python-mujoco-3", "mujoco")
        }
    }
}

/// The interpreter of an environment of its own with Ray and a server of an object store.
/// `$FRICTION_PYTHON_ENV_RAY` names one elsewhere.
///
/// # Panics
/// As [`interpreter`].
pub fn ray() -> PathBuf {
    interpreter_in("FRICTION_PYTHON_ENV_RAY", "python-ray", "ray")
}

/// A script of `tests/python/`.
pub fn script(name: &str) -> PathBuf {
    crate::checkout().join("tests/python").join(name)
}

/// The packages as the wheel holds them, with the extension module that was built, in a folder.
///
/// # Panics
/// Where the folder cannot be written.
pub fn assembled(into: &Path) {
    let package = crate::checkout().join("python");
    for part in ["frictionlab", "friction_analysis", "tests", "notebooks", "pyproject.toml"] {
        copied(&package.join(part), &into.join(part));
    }
    fs::copy(crate::python_module(), into.join("frictionlab/_native.abi3.so")).expect("a module");
}

fn copied(from: &Path, to: &Path) {
    if from.is_file() {
        fs::copy(from, to).expect("a copy");
        return;
    }
    fs::create_dir_all(to).expect("a folder");
    for entry in from.read_dir().expect("a folder").map(|entry| entry.expect("an entry").path()) {
        let name = entry.file_name().expect("a name");
        // Modules that were built by hand are none of the checkout.
        if name != "__pycache__" && entry.extension().is_none_or(|ending| ending != "so") {
            copied(&entry, &to.join(name));
        }
    }
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

/// Runs pytest in a folder, behind `command` (`env`, or what makes a network namespace), and tells
/// what it left out.
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
        crate::leave_out(&format!("pytest: {}", line.trim_start_matches("SKIPPED").trim()));
    }
}
