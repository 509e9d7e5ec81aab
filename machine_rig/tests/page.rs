//! The page about machines shows one that can be.

use std::path::Path;

use machine_rig::Machine;

#[test]
fn the_machine_of_the_page_is_read_and_moves() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/how-to/machines.md");
    let page = std::fs::read_to_string(page).unwrap();
    let (_, behind) = page.split_once("```yaml\n").unwrap();
    let (text, _) = behind.split_once("```").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pendulum.yaml");
    std::fs::write(&path, text).unwrap();
    let mut rig = Machine::read(&path).unwrap().rig().unwrap();
    for _ in 0..2000 {
        rig.measure();
        rig.apply(6.0).unwrap();
    }
    assert!(rig.measure().encoder_position > 1.0, "{:?}", rig.measure());

    for (from, to, said) in [
        ("stickier: 0.1", "stickier: 1.5", "stickier"),
        ("delay: 1", "delya: 1", "delya"),
        ("gravity: {torque: 0.05", "gravity: {torque: -1.0", "forces.gravity.torque"),
        ("inertia: 4.0e-3", "inertia: .nan", "inertia"),
        ("voltage: 8.0", "voltage: 80.0", "voltage"),
    ] {
        std::fs::write(&path, text.replace(from, to)).unwrap();
        let error = Machine::read(&path).unwrap_err().to_string();
        assert!(error.contains(said), "{to}: {error}");
    }
}

#[test]
fn a_machine_that_is_too_stiff_for_its_simulation_says_so() {
    let mut machine = machine_rig::random::machine(1);
    machine.friction = serde_json::from_str(
        r#"{"lugre": {"f_s": 0.14, "f_c": 0.1, "v_s": 0.1, "sigma0": 3e9, "sigma1": 0.5, "f_v": 0.0}}"#,
    )
    .unwrap();
    let mut rig = machine.rig().unwrap();
    let error = (0..1000).find_map(|_| rig.apply(5.0).err()).unwrap();
    assert!(error.to_string().contains("substeps"), "{error}");
}
