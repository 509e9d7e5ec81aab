//! What somebody else writes against this workspace: each crate is built on its own, with nothing
//! changed here, and runs.

use std::path::Path;
use std::process::Command;

/// Runs a crate of `examples`; what it says on standard output.
fn run(name: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["run", "--quiet", "--offline", "--manifest-path"])
        .arg(root.join("examples").join(name).join("Cargo.toml"))
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
