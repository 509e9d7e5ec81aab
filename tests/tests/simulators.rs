//! Exported friction in the real MuJoCo, of the newest version and of an older one: the file is
//! loaded and run beside our own model along a torque that nothing was fitted to; and a recording
//! that MuJoCo made is identified, exported and run again.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use friction_model::{AnyModel, ModelName};
use simulator_export::{Target, Version};
use tests::python;
use tests::simulators::{
    Apart, INERTIA, JOINT, Motion, STEP, exported, frictions, in_mujoco, of_model, torque,
};

/// The largest difference of the motion where the simulator holds all of the friction \[%\].
const HELD: f64 = 0.5;
/// The same with a soft constraint in the place of friction that holds \[%\].
const SOFT: f64 = 6.0;

/// The versions that the machine has, each with its interpreter.
fn versions() -> [(Version, std::path::PathBuf); 2] {
    [
        (Version::new(4, 0), python::mujoco(python::MuJoCo::Newest)),
        (Version::new(3, 8), python::mujoco(python::MuJoCo::Older)),
    ]
}

fn level(model: &AnyModel) -> f64 {
    model.parameter("f_s").or_else(|| model.parameter("f_c")).expect("a level")
}

#[tests::needs(mujoco)]
#[test]
fn an_exported_friction_moves_as_our_own_does() {
    for (version, interpreter) in versions() {
        for (name, model) in frictions() {
            let held = match model.name() {
                ModelName::LuGre | ModelName::Dahl => HELD,
                ModelName::CoulombViscous => SOFT,
                // What MuJoCo does not hold is in the table of `cargo xtask simulators`.
                _ => continue,
            };
            let armature = (name == "lugre").then_some(0.001);
            let torque = torque(level(&model), 0);
            let file = exported(model, Target::Mjcf, version, armature);
            let theirs = in_mujoco(&interpreter, &file.text, &torque);
            let ours = of_model(model, INERTIA + armature.unwrap_or(0.0), &torque);
            assert!(theirs.version.starts_with(&version.to_string()), "{}", theirs.version);
            let apart = Apart::of(&ours, &theirs);
            assert!(apart.motion > 0.05, "{name}: nothing moves: {apart:?}");
            let percent = apart.percent();
            assert!(percent < held, "{name} in MuJoCo {version}: {percent:.3} %, {apart:?}");
        }
    }
}

/// A recording as `identify` reads it, every millisecond.
fn recording(motion: &Motion, torque: &[f64]) -> String {
    let mut text = String::from("t_s,position_rad,velocity_rad_s,torque_Nm\n");
    for (k, (position, velocity)) in motion.position.iter().zip(&motion.velocity).enumerate() {
        let time = 10.0 * STEP * k as f64;
        writeln!(text, "{time:.4},{position:.9},{velocity:.9},{:.9}", torque[10 * k])
            .expect("text");
    }
    text
}

fn run(folder: &Path, arguments: &[&str]) {
    let output =
        tests::frictionlab().current_dir(folder).args(arguments).output().expect("it runs");
    assert!(
        output.status.success(),
        "{arguments:?}: {}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
}

#[tests::needs(mujoco)]
#[test]
fn what_mujoco_recorded_is_identified_exported_and_run_again() {
    let (_, interpreter) = &versions()[0];
    let folder = tempfile::tempdir().expect("a folder");
    let theirs = format!(
        "<mujocoinclude><actuator><dcmotor joint=\"{JOINT}\" input=\"none\" motorconst=\"0\" resistance=\"1\" lugre=\"25 0.3 0.08 0.12 0.2\" damping=\"0.03\"/></actuator></mujocoinclude>"
    );
    let along = torque(0.12, 0);
    let recorded = in_mujoco(interpreter, &theirs, &along);
    fs::write(folder.path().join("recorded.csv"), recording(&recorded, &along)).expect("a file");
    let inertia = format!("{INERTIA}:0.00001");
    run(
        folder.path(),
        &[
            "identify",
            "recorded.csv",
            "--model",
            "lugre",
            "--torque-source",
            "driving",
            "--inertia",
            &inertia,
            "--quiet",
            "--out",
            "found",
        ],
    );
    run(
        folder.path(),
        &[
            "export",
            "found/parameters.yaml",
            "--to",
            "mjcf",
            "--joint",
            JOINT,
            "--accept-unidentified",
            "--out",
            "friction.xml",
        ],
    );
    let again = fs::read_to_string(folder.path().join("friction.xml")).expect("the file");
    assert!(again.contains("Range: "), "{again}");
    assert!(again.contains("the speeds of the recordings"), "{again}");
    // Along another torque than the one that was recorded.
    let other = torque(0.12, 1);
    let apart = Apart::of(
        &in_mujoco(interpreter, &theirs, &other),
        &in_mujoco(interpreter, &again, &other),
    );
    assert!(apart.percent() < 3.0, "{:.3} %, {apart:?}\n{again}", apart.percent());
}
