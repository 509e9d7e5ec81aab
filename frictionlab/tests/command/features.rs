//! `frictionlab features` as a person runs it.

use std::path::Path;
use std::process::{Command, Output};

fn features(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_frictionlab"))
        .arg("features")
        .args(arguments)
        .arg("--out")
        .arg(folder)
        .output()
        .expect("the program starts")
}

#[test]
fn two_models_become_a_report_and_their_figures() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().join("out");
    let output = features(&["--model", "stribeck,PROPOSED"], &folder);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.contains("closes") && said.contains("no pre-sliding"), "{said}");
    assert!(said.contains("A 0.05694 m") && said.contains("none"), "{said}");

    let json: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.join("features.json")).unwrap())
            .unwrap();
    let models = json["models"].as_array().unwrap();
    assert_eq!(models.len(), 2);
    let period = models[1]["features"]["stick_slip"]["period"].as_f64().unwrap();
    assert!((period / 7.92748 - 1.0).abs() < 5e-4, "{period}");
    let cycle = &json["limit_cycle"]["simulated"]["cycle"];
    assert!((cycle["period"].as_f64().unwrap() / 19.390 - 1.0).abs() < 2e-3, "{cycle}");

    let report = std::fs::read_to_string(folder.join("report.html")).unwrap();
    for heading in [
        "Stick-slip",
        "Drift and memory",
        "Breakaway",
        "Sensitivity",
        "Describing function and limit cycle",
    ] {
        assert!(report.contains(heading), "{heading}");
    }
    assert!(
        report.contains("Stribeck") && !report.contains("LuGre</"),
        "only the models asked for"
    );
}

#[test]
fn an_unknown_model_is_refused_with_the_known_ones() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().join("out");
    let output = features(&["--model", "lugri"], &folder);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("lugri") && said.contains("lugre, elasto_plastic"), "{said}");
    assert!(!folder.exists());
}
