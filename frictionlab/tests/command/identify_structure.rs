//! `frictionlab identify --structure`, as a person uses it.

use std::fmt::Write;
use std::process::Command;

/// 3 kg with 5 N of Coulomb friction and 2 N s/m, backward `backward`, whose force acts 2 ms late.
fn table(backward: f64) -> String {
    let mut text = String::from("t_s,position_m,force_N\n");
    for k in 0..8000 {
        let time = f64::from(k) * 1e-3;
        let t = time + 2e-3;
        let velocity = 0.4 * (2.0 * t).cos() + 0.27 * (9.0 * t).cos();
        let acceleration = -0.8 * (2.0 * t).sin() - 2.43 * (9.0 * t).sin();
        let position = 0.2 * (2.0 * time).sin() + 0.03 * (9.0 * time).sin();
        // A fixed pattern in place of noise.
        let noise = 0.05 * (f64::from(k * 7919 % 1009) / 504.0 - 1.0);
        let viscous = if velocity < 0.0 { backward } else { 2.0 };
        let force = 3.0 * acceleration + 5.0 * velocity.signum() + viscous * velocity + noise;
        let _ = writeln!(text, "{time},{position},{force}");
    }
    text
}

#[test]
fn the_structure_is_chosen_written_and_shown() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("axis.csv"), table(2.0)).unwrap();
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
    assert!(page.contains("Structures, the chosen one first"));

    for (args, said) in [
        (&["--structure", "symmetric+glue"][..], "`glue`"),
        (&["--structure", "auto", "--without-inertia"], "--without-inertia"),
    ] {
        let output = run(args);
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert!(String::from_utf8(output.stderr).unwrap().contains(said), "{args:?}");
    }
}

/// The chosen structure stands before the plain models, and first in each table; the others follow by
/// their error. What the page warns of in a plain model stands with that model.
#[test]
fn the_chosen_structure_stands_first_and_what_is_warned_of_is_marked() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("axis.csv"), table(12.0)).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_frictionlab"))
        .current_dir(folder.path())
        .args(["identify", "axis.csv", "--structure"])
        .arg("symmetric,asymmetric,asymmetric+delay,asymmetric+delay+stribeck")
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = folder.path().join("runs/identify-1/report.html");
    let page = std::fs::read_to_string(page).unwrap();
    // What is shown; behind it stands the page once more, as data.
    let shown = page.split("id=\"page-data\"").next().unwrap_or_default();
    let after = |text: &str| shown.rsplit_once(text).unwrap_or_else(|| panic!("no {text}")).1;
    let order = [
        "Structures, the chosen one first.",
        "Parameters of asymmetric+delay.",
        "WARNING: The symmetric model",
        "How well the models fit.",
        "One friction for both directions.",
    ];
    let left = order.map(|text| after(text).len());
    assert!(left.is_sorted_by(|a, b| a > b), "{order:?}: {left:?}");
    for title in ["Structures, the chosen one first.", "How well the models fit."] {
        let body = after(title).split_once("</tbody>").unwrap().0.split_once("<tbody>").unwrap().1;
        let rows: Vec<&str> = body.split("<tr").skip(1).collect();
        let row = |name: &str| rows.iter().position(|row| row.contains(&format!(">{name}<")));
        assert!(rows[0].contains(">asymmetric+delay"), "{title}: {rows:?}");
        assert!(rows[0].contains(">chosen<"), "{title}: {rows:?}");
        let symmetric = row("symmetric").unwrap();
        assert!(row("asymmetric").unwrap() < symmetric, "{title}: {rows:?}");
        assert!(rows[symmetric].contains(">warned of<"), "{title}: {rows:?}");
    }
}
