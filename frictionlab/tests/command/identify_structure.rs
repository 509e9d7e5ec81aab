//! `frictionlab identify --structure`, as a person uses it.

use std::fmt::Write;
use std::process::Command;

/// 3 kg with 5 N of Coulomb friction and 2 N s/m, whose force acts 2 ms late.
fn table() -> String {
    let mut text = String::from("t_s,position_m,force_N\n");
    for k in 0..8000 {
        let time = f64::from(k) * 1e-3;
        let t = time + 2e-3;
        let velocity = 0.4 * (2.0 * t).cos() + 0.27 * (9.0 * t).cos();
        let acceleration = -0.8 * (2.0 * t).sin() - 2.43 * (9.0 * t).sin();
        let position = 0.2 * (2.0 * time).sin() + 0.03 * (9.0 * time).sin();
        // A fixed pattern in place of noise.
        let noise = 0.05 * (f64::from(k * 7919 % 1009) / 504.0 - 1.0);
        let force = 3.0 * acceleration + 5.0 * velocity.signum() + 2.0 * velocity + noise;
        let _ = writeln!(text, "{time},{position},{force}");
    }
    text
}

#[test]
fn the_structure_is_chosen_written_and_shown() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("axis.csv"), table()).unwrap();
    let run = |args: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_frictionlab"));
        command
            .current_dir(folder.path())
            .args(["identify", "axis.csv"])
            .args(args)
            .output()
            .unwrap()
    };
    let output = run(&[
        "--structure",
        "symmetric,symmetric+delay,asymmetric+delay",
        "--validate",
        "axis.csv",
    ]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let shown = String::from_utf8(output.stdout).unwrap();
    assert!(shown.contains("> symmetric+delay "), "{shown}");
    let made = folder.path().join("runs/identify-1");
    let text = std::fs::read_to_string(made.join("identification.json")).unwrap();
    let document: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(document["structure"]["chosen"], "symmetric+delay");
    let parameters = document["structure"]["parameters"]["parameters"].as_array().unwrap();
    let value = |name: &str| {
        let found = parameters.iter().find(|estimate| estimate["name"] == name).unwrap();
        found["value"].as_f64().unwrap()
    };
    assert!((value("delay") - 2e-3).abs() < 0.1e-3, "{parameters:?}");
    assert!((value("inertia") / 3.0 - 1.0).abs() < 0.01, "{parameters:?}");
    let page = std::fs::read_to_string(made.join("report.html")).unwrap();
    assert!(page.contains("Structures, the best prediction first"));

    for (args, said) in [
        (&["--structure", "symmetric+glue"][..], "`glue`"),
        (&["--structure", "auto", "--without-inertia"], "--without-inertia"),
    ] {
        let output = run(args);
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert!(String::from_utf8(output.stderr).unwrap().contains(said), "{args:?}");
    }
}
