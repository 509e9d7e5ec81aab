//! `frictionlab identify --torque-source`: a rig without a torque sensor, from the tables of
//! `run characterise` on, as a person does it.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

/// The test bed's constants, each off by one of the standard errors that `--drive-errors 1,2,2`
/// states.
const OFF: [&str; 6] =
    ["--motor-constant", "0.0077467", "--resistance", "2.548", "--inertia", "0.00270052"];

fn frictionlab(folder: &Path, args: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_frictionlab");
    Command::new(program).current_dir(folder).args(args).output().unwrap()
}

fn tables() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let run = ["run", "characterise", "--quick", "--repetitions", "2", "--quiet", "--out", "run"];
    let output = frictionlab(folder.path(), &run);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder
}

/// Identifies the proposed model and returns the document and what was printed.
fn identify(folder: &Path, out: &str, options: &[&str]) -> (Value, String) {
    let files = ["run/steady_points.csv", "run/lag_chirp.csv", "run/presliding.csv"];
    let args =
        [&["identify"][..], &files, &["--model", "proposed", "--force", "--out", out], options]
            .concat();
    let output = frictionlab(folder, &args);
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    let text = fs::read_to_string(folder.join(out).join("identification.json")).unwrap();
    (serde_json::from_str(&text).unwrap(), String::from_utf8(output.stdout).unwrap())
}

fn parameter<'a>(document: &'a Value, name: &str) -> &'a Value {
    &document["models"]["proposed"]["parameters"][name]
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn voltage_and_current_agree_with_the_sensor_within_the_stated_uncertainty() {
    let folder = tables();
    let (sensor, _) = identify(folder.path(), "sensor", &[]);
    assert!(parameter(&sensor, "f_s")["from_drive"].is_null());
    for source in ["voltage", "current"] {
        let options = [&["--torque-source", source][..], &OFF].concat();
        let (other, printed) = identify(folder.path(), source, &options);
        let page = fs::read_to_string(folder.path().join(source).join("report.html")).unwrap();
        assert!(printed.contains("from the drive ±") && page.contains("from the drive"));
        let mut beyond_noise = 0;
        for name in ["f_s", "f_c", "f_v"] {
            let (a, b) = (parameter(&sensor, name), parameter(&other, name));
            let value = number(&b["value"]);
            let difference = value - number(&a["value"]);
            let noise = 5.0 * number(&a["standard_error"]).hypot(number(&b["standard_error"]));
            let drive = number(&b["from_drive"]["standard_error"]);
            // Three errors of one standard error each add up to at most sqrt(3) of their root sum
            // of squares.
            assert!(
                difference.abs() < 1.75 * drive + noise,
                "{source} {name}: {difference} {drive} {noise}"
            );
            // A few per cent at most: the stated uncertainty is no blank cheque.
            assert!(drive < 0.05 * value, "{source} {name}: {drive}");
            beyond_noise += u32::from(difference.abs() > noise);
            // What the residuals say stays apart from it.
            assert!(number(&b["standard_error"]) < 0.5 * drive, "{source} {name}: {b}");
        }
        assert!(beyond_noise > 0, "{source}: the noise alone would have explained everything");
        // Constants that are off by what is stated move the result as far as is stated, the joint
        // refinement included.
        let (constant, share, further) = if source == "voltage" {
            ("armature_resistance", -0.02, ["--resistance", "2.59896"])
        } else {
            ("torque_constant", 0.01, ["--motor-constant", "0.007824167"])
        };
        let by_constant = |document: &Value, name: &str| {
            number(&parameter(document, name)["from_drive"]["by_constant"][constant])
        };
        let rest: Vec<&str> =
            OFF.chunks(2).filter(|pair| pair[0] != further[0]).flatten().copied().collect();
        let further = [&["--torque-source", source][..], &rest, &further].concat();
        let (further, _) = identify(folder.path(), "further", &further);
        // At constant speed friction is in proportion to 1/R with the voltage and to k with the
        // current.
        let stages = [&options[..], &["--no-joint"]].concat();
        let (stages, _) = identify(folder.path(), "stages", &stages);
        for name in ["f_s", "f_c", "f_v"] {
            let said = by_constant(&other, name);
            let moved = number(&parameter(&further, name)["value"])
                - number(&parameter(&other, name)["value"]);
            assert!((moved / said - 1.0).abs() < 0.1, "{source} {name}: {moved}, said {said}");
            let share_of = by_constant(&stages, name) / number(&parameter(&stages, name)["value"]);
            assert!((share_of / share - 1.0).abs() < 0.05, "{source} {name}: {share_of}");
        }
        // Neither the shape of the curve over the velocity nor a displacement depends on the scale
        // of the torque.
        assert!(
            number(&parameter(&other, "z_b")["from_drive"]["standard_error"]) < 1e-5,
            "{source}"
        );
    }
}

#[test]
fn the_constants_may_come_from_a_drive_file_and_must_come_from_somewhere() {
    let folder = tables();
    fs::write(
        folder.path().join("drive.yaml"),
        "/rig_driver:\n  ros__parameters:\n    drive:\n      motor_constant: 0.0077467\n      gear_ratio: 70.0\n      \
         armature_resistance: 2.548\n      inertia: 0.00270052\n",
    )
    .unwrap();
    let source = ["--torque-source", "voltage"];
    let (by_options, _) = identify(folder.path(), "options", &[&source[..], &OFF].concat());
    let (by_file, _) =
        identify(folder.path(), "file", &[&source[..], &["--drive", "drive.yaml"]].concat());
    assert_eq!(by_options["models"], by_file["models"]);
    assert_eq!(by_file["settings"]["drive_constants"]["inertia"]["value"], 0.00270052);

    for (options, said) in [
        (&["--torque-source", "voltage"][..], "--drive"),
        (&["--torque-source", "driving"], "inertia"),
        (
            &["--torque-source", "voltage", "--inertia", "0.0026", "--drive-errors", "1,200,2"],
            "200",
        ),
    ] {
        let args =
            [&["identify", "run/lag_chirp.csv", "--model", "stribeck"][..], options].concat();
        let output = frictionlab(folder.path(), &args);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(said) && !message.contains("panicked"), "{message}");
    }
}
