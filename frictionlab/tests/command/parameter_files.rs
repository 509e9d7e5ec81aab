//! A parameter file means one thing: every file that is shipped, and every file that a command
//! writes, is read by every command and node that takes such a file, or refused with its reason.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use experiment_runner::models;
use experiment_runner::run::Given;
use experiment_runner::server::parameters::RunnerParameters;
use friction_observer::parameters::ObserverSettings;
use identification::drive::linear::KnownDrive;
use identification::drive::parameters::read_motor;
use parameters::file::Parameters;
use parameters::{Declaration, Declared, Values};
use rig_driver::parameters::RigParameters;
use rig_setup::{RigProfile, read_calibration};

fn frictionlab(arguments: &[&str], folder: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_frictionlab"));
    command.args(arguments).current_dir(folder).output().expect("the command is built")
}

fn shipped() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch_configs/config")
}

/// A recording of an axis of 3 kg with 5 N of Coulomb friction and 2 N s/m.
fn axis() -> String {
    let mut text = String::from("t_s,position_m,force_N\n");
    for k in 0..4000 {
        let t = f64::from(k) * 1e-3;
        let velocity = 0.4 * (2.0 * t).cos() + 0.27 * (9.0 * t).cos();
        let acceleration = -0.8 * (2.0 * t).sin() - 2.43 * (9.0 * t).sin();
        let position = 0.2 * (2.0 * t).sin() + 0.03 * (9.0 * t).sin();
        let force = 3.0 * acceleration + 5.0 * velocity.signum() + 2.0 * velocity;
        text += &format!("{t},{position},{force}\n");
    }
    text
}

/// Every command that writes parameters, a profile or a calibration. (`identify-servo`, `features`
/// and `monte-carlo` write JSON, CSV and pages only.)
const WRITERS: [&str; 10] = [
    "run drive-excitation --quick --quiet --out run",
    "run characterise --quick --repetitions 1 --quiet --out characterise",
    "run position-tracking --quick --repetitions 1 --quiet --out tracking",
    "identify characterise/steady_points.csv characterise/presliding.csv --model stribeck --out models",
    "identify axis.csv --out axis",
    "rig check --rig simulated --rig-file rig.yaml --quiet",
    "rig calibrate --rig simulated --quiet --out calibration",
    "identify-drive run/bag --gear-ratio 70 --out drive --rig-file rig.yaml",
    "design velocity --gains 1.5,16 --out velocity",
    "design position --gains 6,11,0.1 --out position",
];

/// Shipped files, and those that commands write, by name.
fn files(folder: &Path) -> Vec<(String, String)> {
    let succeeds = |arguments: &[&str]| {
        let done = frictionlab(arguments, folder);
        assert!(done.status.success(), "{arguments:?}: {done:?}");
        done.stdout
    };
    fs::write(folder.join("axis.csv"), axis()).expect("a folder of the test");
    for line in WRITERS {
        succeeds(&line.split(' ').collect::<Vec<_>>());
    }
    succeeds(&["rig", "calibrate", "--rig-file", "rig.yaml", "--quiet"]);
    let mut found = Vec::new();
    yaml_below(folder, &mut found);
    let written = found.len();
    assert!(written > WRITERS.len() - 2, "{written} files");
    let model = String::from_utf8(succeeds(&["models", "gms", "--yaml"])).expect("text");
    found.push(("models gms --yaml".to_owned(), model));
    for entry in fs::read_dir(shipped()).expect("the shipped files").flatten() {
        let name = entry.file_name().into_string().expect("a name");
        let text = fs::read_to_string(entry.path()).expect("a shipped file");
        found.push((name, text));
    }
    found
}

/// Every YAML file below, but for the descriptions of bags, which are rosbag2's.
fn yaml_below(folder: &Path, found: &mut Vec<(String, String)>) {
    for entry in fs::read_dir(folder).expect("a folder of the test").flatten() {
        let path = entry.path();
        if path.is_dir() {
            yaml_below(&path, found);
        } else if path.extension().is_some_and(|end| end == "yaml")
            && !path.ends_with("metadata.yaml")
        {
            found.push((path.display().to_string(), fs::read_to_string(&path).expect("text")));
        }
    }
}

/// What a node of that name does with the file.
fn node(file: &Parameters, name: &str, declared: &[Declaration]) -> Result<Values, String> {
    let given = file.of_node(&format!("/axis_1/{name}"));
    let given = if given.is_empty() { file.of_node(&format!("/{name}")) } else { given };
    for known in given.keys() {
        assert!(declared.iter().any(|one| one.name() == known), "{name} has no {known}");
    }
    Values::given(declared, &given).map_err(|error| error.to_string())
}

/// Nodes read every parameter file: what is not theirs is none of their business.
fn nodes_read(name: &str, file: &Parameters) {
    let of = |node: &str| file.of_node(&format!("/{node}"));
    let given: Vec<String> = of("friction_observer").into_keys().collect();
    let declared = friction_observer::parameters::declarations(&given);
    let values = node(file, "friction_observer", &declared).unwrap();
    ObserverSettings::read(&values).unwrap_or_else(|error| panic!("{name}: {error}"));
    let given: Vec<String> = of("controller").into_keys().collect();
    let declared = controller::node::declarations(&given);
    let values = node(file, "controller", &declared).unwrap();
    controller::ControllerParameters::default().with(&values).options().unwrap();
    let values = node(file, "rig_driver", &RigParameters::default().declarations()).unwrap();
    RigParameters::default().with(&values).setup().unwrap();
    node(file, "experiment_runner", &RunnerParameters::default().declarations()).unwrap();
}

/// What a file says: of the rig and its drive, of friction, of the controller.
#[derive(Default)]
struct Says {
    profile: bool,
    motor: bool,
    drive: bool,
    calibration: bool,
    model: bool,
    controller: bool,
}

impl Says {
    fn of(name: &str, text: &str) -> Self {
        if name == "live.yaml" {
            // Settings of a launch file, which are no parameters of a node.
            return Self::default();
        }
        if RigProfile::is_one(text) {
            let profile = RigProfile::read(text).unwrap_or_else(|error| panic!("{name}: {error}"));
            let drive = profile.drive;
            return Self {
                profile: true,
                motor: drive.is_some_and(|drive| drive.motor().is_some()),
                drive: drive.is_some(),
                calibration: profile.calibration.is_some(),
                ..Self::default()
            };
        }
        if !text.contains("ros__parameters") {
            return Self { model: true, ..Self::default() };
        }
        let file = Parameters::parse(text).unwrap_or_else(|error| panic!("{name}: {error}"));
        nodes_read(name, &file);
        let rig = file.of_node("/rig_driver");
        let has = |section: &str| rig.keys().any(|name| name.starts_with(section));
        let linear = file.nodes().iter().any(|node| node.values.contains_key("time_constant"));
        Self {
            profile: false,
            motor: has("drive."),
            drive: has("drive.") || linear,
            calibration: has("calibration."),
            model: !file.of_node("/friction_observer").is_empty(),
            controller: !file.of_node("/controller").is_empty(),
        }
    }
}

#[test]
fn every_file_is_read_by_everybody_who_takes_such_a_file() {
    let root = tempfile::tempdir().unwrap();
    for (name, text) in files(root.path()) {
        let says = Says::of(&name, &text);
        // Commands refuse what says nothing to them, with a sentence.
        let reads = |taken: bool, what: &str, read: Result<(), String>| match read {
            Ok(()) => assert!(taken, "{what} reads {name}, which says nothing to it"),
            Err(said) => {
                assert!(!taken, "{what} refuses {name}: {said}");
                let words = ["it ", "no ", "expected"];
                assert!(words.iter().any(|word| said.contains(word)), "{what}: {said}");
            }
        };
        let ros = text.contains("ros__parameters");
        let run = Given::default().take(&name, &text).map_err(|error| error.to_string());
        reads(ros && (says.model || says.controller), "--parameters", run);
        reads(
            says.motor,
            "run --drive",
            read_motor(&text).map(drop).map_err(|error| error.to_string()),
        );
        reads(
            says.drive,
            "design --drive",
            KnownDrive::read(&text).map(drop).map_err(|error| error.to_string()),
        );
        let calibration = read_calibration(&text).map(drop).map_err(|error| error.to_string());
        reads(says.calibration, "--calibration", calibration);
        let profile = RigProfile::read(&text).map(drop).map_err(|error| error.to_string());
        reads(says.profile, "--rig-file", profile);
        let model = models::file::read(&text, None).map(drop).map_err(|error| error.to_string());
        reads(says.model, "simulate --params", model);
    }
}

#[test]
fn the_shipped_parameters_of_the_controller_go_into_a_run() {
    let root = tempfile::tempdir().unwrap();
    let file = shipped().join("controller.yaml").display().to_string();
    let arguments =
        ["run", "velocity-tracking", "--quick", "--repetitions", "1", "--parameters", &file];
    let done = frictionlab(&arguments, root.path());
    assert!(done.status.success(), "{done:?}");

    fs::write(
        root.path().join("misspelt.yaml"),
        "/**/controller:\n  ros__parameters:\n    compensaton_scale: 0.5\n",
    )
    .unwrap();
    let done = frictionlab(&["run", "--parameters", "misspelt.yaml"], root.path());
    let said = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(2), "{said}");
    assert!(said.contains("misspelt.yaml") && said.contains("`compensation_scale`"), "{said}");
}
