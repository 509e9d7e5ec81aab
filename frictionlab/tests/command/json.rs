//! `--json`: one document on standard output and nothing else, with the keys that
//! docs/reference/json.md
//! explains.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;

fn documented() -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/reference/json.md"))
        .unwrap()
}

/// The row of the table for a command.
fn row(documentation: &str, command: &str) -> String {
    let start = format!("| `{command}`");
    documentation.lines().filter(|line| line.starts_with(&start)).collect()
}

fn run(folder: &Path, args: &[&str]) -> Value {
    let output = Command::new(env!("CARGO_BIN_EXE_frictionlab"))
        .current_dir(folder)
        .args(args)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| {
        panic!("{args:?}: {error}: {}", String::from_utf8_lossy(&output.stdout))
    })
}

#[test]
fn every_key_is_explained_and_the_file_is_what_is_printed() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path();
    let mut points = String::from("velocity_rad_s,torque_Nm\n");
    for k in 1..=40 {
        let v = 0.05 * f64::from(k);
        for sign in [1.0, -1.0] {
            points +=
                &format!("{},{}\n", sign * v, sign * (0.09 + 0.01 * (-v * v).exp() + 0.004 * v));
        }
    }
    fs::write(folder.join("points.csv"), points).unwrap();
    let documentation = documented();
    let quick =
        ["run", "velocity-tracking", "--quick", "--model", "lugre", "--json", "--out", "run"];
    for (command, args, file) in [
        ("run", &quick[..], Some("run/run.json")),
        (
            "design",
            &["design", "position", "--retuned", "--json", "--out", "design"],
            Some("design/design.json"),
        ),
        (
            "identify`",
            &["identify", "points.csv", "--model", "stribeck", "--json", "--out", "found"],
            Some("found/identification.json"),
        ),
        (
            "monte-carlo",
            &[
                "monte-carlo",
                "--draws",
                "1",
                "--task",
                "position-tracking",
                "--means",
                "feedback",
                "--json",
                "--out",
                "mc",
            ],
            Some("mc/monte-carlo.json"),
        ),
        (
            "truth-matrix",
            &["truth-matrix", "--model", "stribeck,lugre", "--seeds", "1", "--json", "--out", "tm"],
            Some("tm/truth-matrix.json"),
        ),
        (
            "features",
            &["features", "--model", "lugre", "--json", "--out", "features"],
            Some("features/features.json"),
        ),
        ("bag info", &["bag", "info", "--json", "run/bag"], None),
        ("models", &["models", "lugre", "--json"], None),
        ("protocols", &["protocols", "--json"], None),
    ] {
        let document = run(folder, args);
        let explained = row(&documentation, command.trim_end_matches('`'));
        assert!(!explained.is_empty(), "{command} is not in docs/reference/json.md");
        for key in document.as_object().unwrap().keys() {
            assert!(
                explained.contains(&format!("`{key}`")),
                "{command}: {key} is not explained in {explained}"
            );
        }
        if let Some(format) = document.get("format").and_then(Value::as_str) {
            assert!(explained.contains(format), "{command}: {format}");
        }
        if let Some(file) = file {
            let written: Value =
                serde_json::from_slice(&fs::read(folder.join(file)).unwrap()).unwrap();
            assert_eq!(written, document, "{command}");
        }
    }
}
