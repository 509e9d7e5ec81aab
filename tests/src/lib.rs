//! Tests that cross crates: the built program, real rosbags, real rclpy, a real browser.
//!
//! The tests themselves are in `tests/tests/`; here is what they share.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

pub mod book;
pub mod browser;
pub mod emulated_rig;
pub mod filled;
pub mod network;
pub mod pictures;
pub mod python;
pub mod readers;
pub mod simulators;
pub mod tab;
pub mod viewed;
pub mod wire;

pub use needs::needs;

/// The built `frictionlab`, ready for arguments.
///
/// `$FRICTIONLAB_BIN` names it where it is set. Under cargo it is brought up to date first (in the
/// profile and target folder of the running test, so that nothing is built twice): cargo does not
/// build a program only because another package's tests run it, and an old one would be tested
/// unnoticed. Without cargo it is the one beside the test.
///
/// # Panics
/// When it can neither be found nor built; the message says what was tried.
pub fn frictionlab() -> Command {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    program(&PROGRAM, "FRICTIONLAB_BIN", "frictionlab", "frictionlab")
}

/// The built `rig_emulator`, found as [`frictionlab`] is; `$RIG_EMULATOR_BIN` names it.
///
/// # Panics
/// As [`frictionlab`].
pub fn rig_emulator() -> Command {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    program(&PROGRAM, "RIG_EMULATOR_BIN", "rig_emulator", "rig_emulator")
}

/// The built `xtask`, found as [`frictionlab`] is; `$XTASK_BIN` names it.
///
/// # Panics
/// As [`frictionlab`].
pub fn xtask() -> Command {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    program(&PROGRAM, "XTASK_BIN", "xtask", "xtask")
}

/// The folder with the built programs of the nodes, `rig_driver`, `friction_observer` and
/// `controller`; found as [`frictionlab`] is, or `$FRICTION_NODES` where that is set.
///
/// # Panics
/// As [`frictionlab`].
pub fn node_programs() -> PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    let nodes = ["rig_driver", "friction_observer", "controller"];
    let find = || {
        if let Some(named) = std::env::var_os("FRICTION_NODES") {
            return PathBuf::from(named);
        }
        let folder = profile_folder();
        if let Some(cargo) = std::env::var_os("CARGO") {
            build(Path::new(&cargo), &folder, &nodes);
        }
        folder
    };
    let folder = FOLDER.get_or_init(find);
    for node in nodes {
        assert!(
            folder.join(node).is_file(),
            "no {node} in {}: build it with `cargo build -p {node}`",
            folder.display()
        );
    }
    folder.clone()
}

/// The extension module of Python as it was built; found as [`frictionlab`] is, or
/// `$FRICTIONLAB_PYTHON_MODULE` where that is set.
///
/// # Panics
/// As [`frictionlab`].
pub fn python_module() -> PathBuf {
    if let Some(named) = std::env::var_os("FRICTIONLAB_PYTHON_MODULE") {
        return named.into();
    }
    let folder = profile_folder();
    if let Some(cargo) = std::env::var_os("CARGO") {
        build_part(Path::new(&cargo), &folder, "--lib", &["frictionlab_python"]);
    }
    let (before, after) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let module = folder.join(format!("{before}frictionlab_native{after}"));
    assert!(
        module.is_file(),
        "no {}: build it with `cargo build -p frictionlab_python`",
        module.display()
    );
    module
}

fn program(found: &OnceLock<PathBuf>, variable: &str, package: &str, name: &str) -> Command {
    Command::new(found.get_or_init(|| {
        if let Some(named) = std::env::var_os(variable) {
            let named = PathBuf::from(named);
            assert!(named.is_file(), "{variable} is {}, which is no file", named.display());
            return named;
        }
        let profile = profile_folder();
        let beside = profile.join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
        match std::env::var_os("CARGO") {
            Some(cargo) => build(Path::new(&cargo), &profile, &[package]),
            None => assert!(
                beside.is_file(),
                "no {}: build it with `cargo build`, or name it in {variable}",
                beside.display()
            ),
        }
        beside
    }))
}

/// The target folder that the running test was built in.
fn target_folder() -> PathBuf {
    profile_folder().parent().expect("a profile folder lies in the target folder").to_owned()
}

/// Folder of the profile that the running test was built in, such as `target/debug`.
fn profile_folder() -> PathBuf {
    let test = std::env::current_exe().expect("a running test knows its own file");
    // target/debug/deps/the_test-0123456789abcdef
    test.ancestors().nth(2).expect("a test lies in PROFILE/deps").to_owned()
}

/// Builds the programs of packages, together, so that they share what they stand on.
fn build(cargo: &Path, profile_folder: &Path, packages: &[&str]) {
    build_part(cargo, profile_folder, "--bins", packages);
}

fn build_part(cargo: &Path, profile_folder: &Path, part: &str, packages: &[&str]) {
    let profile = match profile_folder.file_name().and_then(|name| name.to_str()) {
        Some("debug") | None => "dev",
        Some(other) => other,
    };
    let status = Command::new(cargo)
        .args(["build", "--quiet", part, "--profile", profile])
        .args(packages.iter().flat_map(|package| ["--package", package]))
        .arg("--target-dir")
        .arg(profile_folder.parent().expect("a profile folder lies in the target folder"))
        .current_dir(checkout())
        .stdin(Stdio::null())
        .status()
        .expect("cargo starts");
    assert!(status.success(), "{packages:?} do not build");
}

/// The folder of the workspace.
pub fn checkout() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("this package lies in the workspace's folder")
}

/// The folder of recordings that are not part of the project: `$FRICTION_DATA`, or `../shared/data`
/// beside the checkout.
///
/// # Panics
/// Where there is none: the test says what it needs by [`needs`](macro@needs).
pub fn shared_data() -> PathBuf {
    machine::recordings().expect("a test of recordings says that it needs them")
}

/// Tries anew, up to ten times, what a machine that is busy elsewhere starved; where it starved all
/// of them, the rest of the test is left out.
pub fn unstarved<T>(once: impl FnMut() -> Option<T>) -> Option<T> {
    let found = std::iter::repeat_with(once).take(10).find_map(|tried| tried);
    if found.is_none() {
        leave_out("this machine is busy: the line was starved ten times");
    }
    found
}

/// Says on standard error, past libtest's capture, that the running test left a part out, and why:
/// the machine was too busy, or one command of many reads what is not here. `cargo xtask test`
/// counts the parts at its end.
///
/// Whoever calls this has asserted what load cannot change. What cannot run at all is not begun:
/// [`needs`](macro@needs).
pub fn leave_out(reason: &str) {
    let current = std::thread::current();
    let line = format!("LEFT OUT of {}: {reason}\n", current.name().unwrap_or("a test"));
    // Nothing is lost if nobody listens.
    let _ = std::io::stderr().write_all(line.as_bytes());
    if let Some(file) = std::env::var_os("FRICTION_LEFT_OUT") {
        let list = std::fs::OpenOptions::new().append(true).create(true).open(file);
        let _ = list.and_then(|mut list| list.write_all(line.as_bytes()));
    }
}
