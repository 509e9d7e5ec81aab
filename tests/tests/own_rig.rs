//! A rig of somebody else's is built against this workspace, opened through the registry and driven
//! under the safety layer.

use std::path::Path;
use std::process::Command;

#[test]
fn a_rig_from_outside_is_opened_and_driven() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["run", "--quiet", "--offline", "--locked", "--manifest-path"])
        .arg(root.join("examples/own_rig/Cargo.toml"))
        // Built once for all tests of the kind, apart from what another cargo may be building.
        .env("CARGO_TARGET_DIR", root.join("target/examples"))
        .output()
        .expect("cargo runs");
    let said = String::from_utf8_lossy(&output.stdout);
    let complaints = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}\n{complaints}");
    for expected in [
        "rigs: simulated, quanser[:CARD] or flywheel[:INERTIA]",
        "flywheel:0.002: flywheel of 0.002 kg m^2",
        "after 1 s it turns at 3.000 rad/s",
        "finite",
    ] {
        assert!(said.contains(expected), "{expected} is not in\n{said}");
    }
}
