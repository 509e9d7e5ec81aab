//! What somebody else writes against this workspace: each crate is built on its own, with nothing
//! changed here, and runs; the largest one in the long tier, in the short one it compiles.

use std::path::Path;
use std::process::Command;

/// Runs a crate of `examples`; what it says on standard output.
fn run(name: &str) -> String {
    run_with(name, &[])
}

/// The same with these arguments.
fn run_with(name: &str, arguments: &[&str]) -> String {
    cargo(name, "run", &[&["--"], arguments].concat())
}

/// What cargo does with a crate of `examples`.
fn cargo(name: &str, what: &str, arguments: &[&str]) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    // Without a network there are the versions that the workspace itself was built with, and no
    // others: cargo would ask for the newest that it has heard of.
    let lock = root.join("examples").join(name).join("Cargo.lock");
    std::fs::copy(root.join("Cargo.lock"), lock).expect("the versions of the workspace");
    let output = Command::new(cargo)
        .args([what, "--quiet", "--offline", "--manifest-path"])
        .arg(root.join("examples").join(name).join("Cargo.toml"))
        .args(arguments)
        // Built once for all of them, apart from what another cargo may be building.
        .env("CARGO_TARGET_DIR", root.join("target/examples"))
        .output()
        .expect("cargo runs");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let complaints = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{name}: {said}\n{complaints}");
    said
}

#[test]
fn a_rig_is_opened_through_the_registry_and_driven_under_the_safety_layer() {
    let said = run("own_rig");
    for expected in [
        "rigs: simulated, quanser[:CARD] or flywheel[:INERTIA]",
        "flywheel:0.002: flywheel of 0.002 kg m^2",
        "after 1 s it turns at 3.000 rad/s",
        "finite",
    ] {
        assert!(said.contains(expected), "{expected} is not in\n{said}");
    }
}

#[test]
fn a_friction_model_is_simulated_and_identified() {
    assert!(!run("own_model").is_empty());
}

/// It stands on most of the workspace, which is built once more for it: that takes twice as long as
/// to see that it compiles.
#[test]
fn an_experiment_from_outside_compiles() {
    cargo("own_experiment", "check", &[]);
}

/// The plant is symmetric, and its Coulomb friction is 0.0925 N m (table 4.6 of the thesis).
#[tests::needs(long_tier)]
#[test]
fn an_experiment_drives_the_simulated_rig_and_leaves_its_figures() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("both-ways");
    let said = run_with("own_experiment", &[out.to_str().expect("text")]);
    let found: serde_json::Value =
        serde_json::from_str(said.lines().next().expect("its figures")).expect("JSON");
    let of = |way: &str| found[way].as_f64().expect("a torque");
    assert!((of("forward") + of("backward")).abs() < 0.01, "{found}");
    assert!((0.08..0.15).contains(&of("forward")), "{found}");
    for name in ["bag/metadata.yaml", "run.json"] {
        assert!(out.join(name).is_file(), "{name}");
    }
    let record = std::fs::read_to_string(out.join("run.json")).expect("its record");
    assert!(record.contains("\"both_ways\""));
    let report = std::fs::read_to_string(out.join("report.html")).expect("its report");
    assert!(report.contains("Friction at 0.5 rad/s"));
}
