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
use rig_setup::read_calibration;

fn frictionlab(arguments: &[&str], folder: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_frictionlab"));
    command.args(arguments).current_dir(folder).output().expect("the command is built")
}

fn shipped() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch_configs/config")
}

/// Shipped files, and those that commands write, by name.
fn files(folder: &Path) -> Vec<(String, String)> {
    let succeeds = |arguments: &[&str]| {
        let done = frictionlab(arguments, folder);
        assert!(done.status.success(), "{arguments:?}: {done:?}");
    };
    succeeds(&["run", "drive-excitation", "--quick", "--quiet", "--out", "run"]);
    succeeds(&["identify-drive", "run/bag", "--gear-ratio", "70", "--out", "drive"]);
    succeeds(&["design", "velocity", "--gains", "1.5,16", "--out", "velocity"]);
    succeeds(&["design", "position", "--gains", "6,11,0.1", "--out", "position"]);
    let mut found = Vec::new();
    for name in [
        "run/parameters.yaml",
        "drive/drive.yaml",
        "velocity/controller.yaml",
        "position/controller.yaml",
    ] {
        found.push((name.to_owned(), fs::read_to_string(folder.join(name)).expect(name)));
    }
    for entry in fs::read_dir(shipped()).expect("the shipped files").flatten() {
        let name = entry.file_name().into_string().expect("a name");
        let text = fs::read_to_string(entry.path()).expect("a shipped file");
        // Settings of a launch file, which are no parameters of a node.
        if name != "live.yaml" {
            found.push((name, text));
        }
    }
    found.push((
        "calibration.yaml".to_owned(),
        "/**/rig_driver:\n  ros__parameters:\n    calibration: {encoder_sign: 1, tachometer_gain: 1.0, tachometer_zero: 0.0, torque_sign: 1, torque_zero: 0.0, deadband_forward: 0.0, deadband_backward: 0.0}\n"
            .to_owned(),
    ));
    found
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

#[test]
fn every_file_is_read_by_everybody_who_takes_such_a_file() {
    let root = tempfile::tempdir().unwrap();
    for (name, text) in files(root.path()) {
        let file = Parameters::parse(&text).unwrap_or_else(|error| panic!("{name}: {error}"));
        let of = |node: &str| file.of_node(&format!("/{node}"));
        let (observer, rig) = (of("friction_observer"), of("rig_driver"));
        let has = |section: &str| rig.keys().any(|name| name.starts_with(section));
        let linear = file.nodes().iter().any(|node| node.values.contains_key("time_constant"));

        // Nodes read every file: what is not theirs is none of their business.
        let given: Vec<String> = observer.keys().cloned().collect();
        let declared = friction_observer::parameters::declarations(&given);
        let values = node(&file, "friction_observer", &declared).unwrap();
        ObserverSettings::read(&values).unwrap_or_else(|error| panic!("{name}: {error}"));
        let given: Vec<String> = of("controller").into_keys().collect();
        let declared = controller::node::declarations(&given);
        let values = node(&file, "controller", &declared).unwrap();
        controller::ControllerParameters::default().with(&values).options().unwrap();
        node(&file, "rig_driver", &rig_driver::node::declarations("simulated")).unwrap();
        node(&file, "experiment_runner", &RunnerParameters::default().declarations()).unwrap();

        // Commands refuse what says nothing to them, with a sentence.
        let reads = |taken: bool, what: &str, read: Result<(), String>| match read {
            Ok(()) => assert!(taken, "{what} reads {name}, which says nothing to it"),
            Err(said) => {
                assert!(!taken, "{what} refuses {name}: {said}");
                let words = ["it ", "no ", "expected"];
                assert!(words.iter().any(|word| said.contains(word)), "{what}: {said}");
            }
        };
        let run = Given::default().take(&name, &text).map_err(|error| error.to_string());
        reads(!observer.is_empty() || !of("controller").is_empty(), "run", run);
        reads(
            has("drive."),
            "run --drive",
            read_motor(&text).map(drop).map_err(|error| error.to_string()),
        );
        reads(
            has("drive.") || linear,
            "design --drive",
            KnownDrive::read(&text).map(drop).map_err(|error| error.to_string()),
        );
        let calibration = read_calibration(&text).map(drop).map_err(|error| error.to_string());
        reads(has("calibration."), "run --calibration", calibration);
        let model = models::file::read(&text, None).map(drop).map_err(|error| error.to_string());
        reads(!observer.is_empty(), "simulate --params", model);
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
