//! `frictionlab export`, as a person uses it: a parameter file in, a file or a sentence out.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const FILE: &str = "\
# Friction models fitted by frictionlab 0.1.0 to rig.csv.
# Speeds of the recordings: 0.05 to 3.0 rad/s
/friction_observer:
  ros__parameters:
    model: lugre  # the model chosen
    lugre:
      f_s: 0.0994  # identified, +- 1e-5
      f_c: 0.0925  # identified, +- 1e-5
      v_s: 0.1407  # identified, +- 1e-4
      delta: 2.0  # not estimated: no recording shows it: the value it started with
      sigma0: 17.3  # identified, +- 0.1
      sigma1: 0.2  # not estimated: computed from the inertia and the damping ratio
      f_v: 0.0403  # identified, +- 1e-5
";

fn run(folder: &Path, arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_frictionlab");
    Command::new(program).current_dir(folder).arg("export").args(arguments).output().unwrap()
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("parameters.yaml"), FILE).unwrap();
    folder
}

#[test]
fn a_parameter_file_goes_to_a_file_and_to_standard_output() {
    let folder = folder();
    let here = folder.path();
    let to_file = ["parameters.yaml", "--to", "mjcf", "--joint", "elbow", "--out", "elbow.xml"];
    let output = run(here, &to_file);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("elbow.xml") && said.contains("rms error 0.00 %"), "{said}");
    let text = fs::read_to_string(here.join("elbow.xml")).unwrap();
    for part in [
        "rig.csv",
        "MuJoCo (MJCF) 4.0",
        "lugre=\"17.3 0.2 0.0925 0.0994 0.1407\"",
        "sigma1 was not estimated",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let output = run(here, &["parameters.yaml", "--to", "urdf", "--quiet"]);
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(output.stderr.is_empty() && printed.contains("<dynamics"), "{printed}");
    // What exists is replaced only if it may be, and never the file that is read.
    assert_eq!(run(here, &to_file).status.code(), Some(2));
    assert!(run(here, &[&to_file[..], &["--force"]].concat()).status.success());
    let onto_itself = ["parameters.yaml", "--to", "urdf", "--out", "parameters.yaml", "--force"];
    assert_eq!(run(here, &onto_itself).status.code(), Some(2));
    assert_eq!(fs::read_to_string(here.join("parameters.yaml")).unwrap(), FILE);
}

#[test]
fn what_cannot_be_exported_ends_with_2_and_leaves_nothing() {
    let folder = folder();
    let here = folder.path();
    fs::write(here.join("empty.yaml"), "").unwrap();
    fs::write(here.join("servo.json"), "{\"kt\": 1.2, \"friction_base\": 0.05}").unwrap();
    fs::write(
        here.join("guess.yaml"),
        "lugre: {f_s: 0.1, f_c: 0.09, v_s: 0.1, sigma0: 9.0, sigma1: 0.1, f_v: 0.0}",
    )
    .unwrap();
    fs::write(here.join("volts.yaml"), format!("# Friction is told in volts: so.\n{FILE}"))
        .unwrap();
    let before = fs::read_dir(here).unwrap().count();
    for (arguments, part) in [
        (&["parameters.yaml", "--to", "mujoko"][..], "expected one of mjcf"),
        (&["parameters.yaml", "--to", "mjcf", "--target-version", "5.0"], "2.0 to 4.0"),
        (&["parameters.yaml", "--to", "isaac_lab", "--target-version", "2.0"], "coefficient"),
        (&["parameters.yaml"], "--to"),
        (&["--to", "mjcf"], "PARAMETERS"),
        (&["nowhere.yaml", "--to", "mjcf"], "nowhere.yaml"),
        (&["empty.yaml", "--to", "mjcf"], "expected parameters"),
        (&["servo.json", "--to", "mjcf"], "of a servo"),
        (&["guess.yaml", "--to", "mjcf"], "never identified"),
        (&["volts.yaml", "--to", "mjcf"], "in volts"),
        (&["parameters.yaml", "--to", "urdf", "--speeds", "0:0.02"], "pre-sliding"),
    ] {
        let arguments = [arguments, &["--out", "out"]].concat();
        let output = run(here, &arguments);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(part), "{arguments:?}: {said}");
        assert!(output.stdout.is_empty(), "{arguments:?} printed something");
        assert_eq!(fs::read_dir(here).unwrap().count(), before, "{arguments:?} left something");
    }
    let nowhere = run(here, &["parameters.yaml", "--to", "urdf", "--out", "no/such/folder/a"]);
    let made = here.join("no/such/folder/a").exists();
    assert_eq!(nowhere.status.success(), made, "{}", String::from_utf8_lossy(&nowhere.stderr));
}
