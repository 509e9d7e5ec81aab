//! The laboratory in a colcon workspace: what colcon finds, where the programs are installed, and
//! that the nodes run from there.

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;
use tests::{checkout, network::namespaced, node_programs, python};

const PACKAGES: [&str; 4] =
    ["friction_bringup", "friction_compensation_controller", "friction_msgs", "friction_nodes"];
const PROGRAMS: [&str; 5] =
    ["controller", "experiment_runner", "friction_observer", "frictionlab", "rig_driver"];

/// What makes a colcon that knows nothing of cargo, as most have it.
const WITHOUT_CARGO: &str = "colcon_core.package_identification.cargo:colcon_core.package_identification.cargo_workspace:\
colcon_core.package_identification.ament_cargo:colcon_core.package_discovery.cargo_workspace";

/// A workspace in a new folder, and the environment with colcon and the wheels of ROS, which stand
/// for /opt/ros.
struct Workspace {
    folder: TempDir,
    ros: PathBuf,
}

impl Workspace {
    /// With `linked` as its only source.
    fn with(linked: &Path) -> Self {
        let python = python::interpreter("colcon");
        python::interpreter("rclpy");
        let ros = python.ancestors().nth(2).expect("it lies in bin").to_owned();
        let folder = tempfile::tempdir().expect("a folder");
        fs::create_dir(folder.path().join("src")).expect("a folder");
        symlink(linked, folder.path().join("src/friction")).expect("a link");
        Self { folder, ros }
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }

    /// A command as in a shell that ROS was sourced in.
    fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        let path = std::env::var_os("PATH").unwrap_or_default();
        let path = std::env::join_paths(
            std::iter::once(self.ros.join("bin")).chain(std::env::split_paths(&path)),
        );
        command
            .current_dir(self.path())
            .env("PATH", path.expect("a path"))
            .env("AMENT_PREFIX_PATH", &self.ros)
            .env("CMAKE_PREFIX_PATH", &self.ros)
            .env_remove("MAKEFLAGS")
            .env_remove("CARGO_MAKEFLAGS");
        command
    }

    fn colcon(&self, arguments: &[&str], blocked: &str) -> String {
        said(
            self.command("colcon").args(arguments).env("COLCON_EXTENSION_BLOCKLIST", blocked),
            &format!("colcon {arguments:?}"),
        )
    }

    /// Runs a line of bash in the workspace, after `source install/setup.bash`.
    fn sourced(&self, line: &str) -> String {
        let line = format!("source install/setup.bash && {line}");
        said(self.command("bash").args(["-c", &line]), &line)
    }
}

/// Standard output of a command that must end well.
fn said(command: &mut Command, what: &str) -> String {
    let Output { status, stdout, stderr } =
        command.output().unwrap_or_else(|error| panic!("{what}: {error}"));
    let text = String::from_utf8_lossy(&stdout).into_owned();
    assert!(status.success(), "{what}: {status}\n{text}\n{}", String::from_utf8_lossy(&stderr));
    text
}

#[test]
fn colcon_finds_four_packages_whether_or_not_it_knows_cargo() {
    // The folder is linked, or the whole checkout lies in the workspace.
    for linked in [checkout().join("ros"), checkout().to_owned()] {
        let workspace = Workspace::with(&linked);
        for blocked in ["", WITHOUT_CARGO] {
            let listed =
                workspace.colcon(&["--log-base", "/dev/null", "list", "--names-only"], blocked);
            assert_eq!(
                listed.split_whitespace().collect::<Vec<_>>(),
                PACKAGES,
                "{} {blocked}",
                linked.display()
            );
        }
    }
}

/// In place of cargo: notes what it was called with, and links the programs that this test run has
/// built.
const CARGO: &str = r#"#!/usr/bin/env bash
set -eu
printf '%s\n' "$PWD" "$@" > "$FRICTION_NOTES"
while [ $# -gt 0 ]; do case $1 in --target-dir) target=$2 ;; --profile) profile=$2 ;; esac; shift; done
mkdir -p "$target/$profile"
for program in "$FRICTION_BUILT"/{controller,experiment_runner,friction_observer,frictionlab,rig_driver}; do
  ln -sf "$program" "$target/$profile/"
done
"#;

#[test]
fn each_program_is_installed_where_ros_looks_for_it() {
    let workspace = Workspace::with(&checkout().join("ros"));
    let (built, notes) = (node_programs(), workspace.path().join("notes"));
    // With the command its node is built.
    let _ = tests::frictionlab();
    let cargo = workspace.path().join("cargo");
    fs::write(&cargo, CARGO).expect("a file");
    fs::set_permissions(&cargo, fs::Permissions::from_mode(0o755)).expect("it is ours");
    let cargo = format!("-DCARGO={}", cargo.display());
    let build = ["build", "--packages-ignore", "friction_msgs", "--cmake-args", &cargo];
    said(
        workspace
            .command("colcon")
            .args(build)
            .env("FRICTION_NOTES", &notes)
            .env("FRICTION_BUILT", &built),
        "colcon build",
    );
    let noted = fs::read_to_string(&notes).expect("cargo was called");
    let noted: Vec<&str> = noted.lines().collect();
    assert_eq!(noted[0], "/", "no `.cargo/config.toml` of a workspace is heard");
    for words in [
        ["--profile", "release"],
        ["--manifest-path", &checkout().join("Cargo.toml").display().to_string()],
    ] {
        assert!(noted.windows(2).any(|pair| pair == words), "{words:?} is not in {noted:?}");
    }
    assert!(noted.contains(&"--locked"), "{noted:?}");
    assert_eq!(executables(&workspace), PROGRAMS);
    for node in PROGRAMS.iter().filter(|name| **name != "frictionlab") {
        let help = workspace.sourced(&format!("{} --help", ros2_run(&workspace, node)));
        assert!(help.contains(&format!("Usage: {node} [--ros-args")), "{help}");
    }
    assert!(workspace.sourced("frictionlab --help").contains("Usage: frictionlab"));
    let share = workspace.path().join("install/friction_bringup/share/friction_bringup");
    for file in [
        "launch/friction.launch.py",
        "launch/two_axes.launch.py",
        "launch/live.launch.py",
        "config/rig_driver.yaml",
    ] {
        assert!(share.join(file).is_file(), "{file}");
    }
}

/// What `ros2 pkg executables friction_nodes` lists: the files of `lib/PACKAGE` that may be
/// executed, of a package in the index.
fn executables(workspace: &Workspace) -> Vec<String> {
    let list = "import os; from ament_index_python import get_package_prefix; \
        folder = os.path.join(get_package_prefix('friction_nodes'), 'lib', 'friction_nodes'); \
        print(*sorted(name for name in os.listdir(folder) if os.access(os.path.join(folder, name), os.X_OK)), sep='\\n')";
    let ours: Vec<String> =
        workspace.sourced(&format!("python3 -c \"{list}\"")).lines().map(str::to_owned).collect();
    if has_ros2() {
        let theirs = workspace.sourced("ros2 pkg executables friction_nodes");
        let theirs: Vec<&str> =
            theirs.lines().filter_map(|line| line.strip_prefix("friction_nodes ")).collect();
        assert_eq!(theirs, ours, "`ros2 pkg executables`");
    }
    ours
}

/// `ros2 run`, or the file that it would start where there is none.
fn ros2_run(workspace: &Workspace, program: &str) -> String {
    if has_ros2() {
        return format!("ros2 run friction_nodes {program}");
    }
    let file = workspace.path().join("install/friction_nodes/lib/friction_nodes").join(program);
    file.to_str().expect("a plain path").to_owned()
}

fn has_ros2() -> bool {
    Command::new("ros2").arg("--help").output().is_ok_and(|said| said.status.success())
}

/// A program that finds the installed C library in each way that its README names.
const FINDS: &str = r#"
cmake_minimum_required(VERSION 3.20)
project(finds C)
find_package(friction 0.1 REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(found REQUIRED IMPORTED_TARGET friction)
foreach(way friction::friction friction::friction_static PkgConfig::found)
  string(REGEX REPLACE ".*::" "" name ${way})
  add_executable(by_${name} "${SOURCE}")
  target_link_libraries(by_${name} PRIVATE ${way} m)
endforeach()
"#;

#[tests::needs(rclpy, colcon, long_tier)]
#[test]
fn the_c_library_is_installed_and_found() {
    let workspace = Workspace::with(&checkout().join("ros"));
    let at = |name: &str| workspace.path().join(name).display().to_string();
    let cmake = |arguments: &[&str]| {
        let mut command = workspace.command("cmake");
        command.args(arguments).env("PKG_CONFIG_PATH", at("installed/lib/pkgconfig"));
        said(&mut command, &format!("cmake {arguments:?}"))
    };
    let library = checkout().join("friction_c");
    let source = format!("-DSOURCE={}", library.join("examples/step.c").display());
    // What cargo built is kept for the next time.
    let kept = format!("-DFRICTION_CARGO_TARGET={}", checkout().join("target/colcon").display());
    let installed = format!("-DCMAKE_INSTALL_PREFIX={}", at("installed"));
    let library = library.display().to_string();
    let options = [&kept, &installed, "-DCMAKE_INSTALL_LIBDIR=lib"];
    cmake(&[&["-S", &library, "-B", "library"], &options[..]].concat());
    cmake(&["--build", "library"]);
    cmake(&["--install", "library"]);
    fs::create_dir(workspace.path().join("finds")).expect("a folder");
    fs::write(workspace.path().join("finds/CMakeLists.txt"), FINDS).expect("a file");
    let found = format!("-DCMAKE_PREFIX_PATH={}", at("installed"));
    cmake(&["-S", "finds", "-B", "built", &found, &source]);
    cmake(&["--build", "built"]);
    let said_by = |name: &str| {
        let mut program = workspace.command(&at(&format!("built/by_{name}")));
        said(program.env("LD_LIBRARY_PATH", at("installed/lib")), name)
    };
    let expected = said_by("friction");
    assert!(expected.starts_with("0.0 s"), "{expected}");
    assert_eq!(said_by("friction_static"), expected);
    assert_eq!(said_by("found"), expected);
}

/// The way of docs/tutorials/ros-workspace.md, from an empty folder, with the real cargo.
#[tests::needs(rclpy, colcon, namespace, long_tier)]
#[test]
fn the_whole_way_from_an_empty_folder_to_nodes_that_run() {
    let workspace = Workspace::with(&checkout().join("ros"));
    // What cargo built is kept for the next time; everything else is new.
    let kept = checkout().join("target/colcon");
    let kept = format!("-DFRICTION_CARGO_TARGET={}", kept.display());
    workspace.colcon(&["build", "--packages-up-to", "friction_bringup", "--cmake-args", &kept], "");
    assert_eq!(executables(&workspace), PROGRAMS);
    let namespaced = namespaced();
    let words: Vec<String> = std::iter::once(namespaced.get_program())
        .chain(namespaced.get_args())
        .map(|word| format!("'{}'", word.to_str().expect("text")))
        .collect();
    let logs = workspace.path().join("log").display().to_string();
    let report = workspace.sourced(&format!(
        "ROS_DOMAIN_ID=77 ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST ROS_LOG_DIR='{logs}' {} python3 '{}'",
        words.join(" "),
        python::script("colcon_session.py").display(),
    ));
    let report: Value =
        serde_json::from_str(report.lines().last().unwrap_or_default()).expect("JSON");
    let installed = workspace.path().join("install/friction_nodes/lib/friction_nodes");
    let installed = installed.canonicalize().expect("a folder");
    for program in report["programs"].as_array().expect("programs") {
        assert!(Path::new(program.as_str().expect("text")).starts_with(&installed), "{report}");
    }
    assert_eq!(report["programs"].as_array().map(Vec::len), Some(4), "{report}");
    let types = report["types"].as_str().unwrap_or_default();
    assert!(types.contains("/install/friction_msgs/"), "the workspace's types: {report}");
    let state = |node: &str| report["states"][node].as_str().unwrap_or_default().to_owned();
    assert_eq!(
        (state("friction_observer"), state("controller")),
        ("active".into(), "active".into()),
        "{report}"
    );
    // On a busy machine commands may come too late; then the driver holds the motor.
    assert!(["active", "inactive"].contains(&state("rig_driver").as_str()), "{report}");
    assert!(report["estimates"].as_u64().is_some_and(|count| count > 100), "{report}");
    assert_eq!(report["left"], serde_json::json!([]), "{report}");
}
