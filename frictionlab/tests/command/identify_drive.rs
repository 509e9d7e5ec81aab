//! A simulated rig is driven by a chirp, steps and a slow triangle; what identify-drive says about
//! it is held against what it was made of.

use std::path::PathBuf;
use std::process::Command;

use friction_ident::Uncertain;
use friction_ident::drive::Calibration;
use friction_model::{AnyModel, ModelName};
use identification::drive::parameters::{motor_of, read_motor, render};
use identification::drive::{Identified, identify};
use recording::driven::DrivenRecording;
use recording::{AxisKind, Irregularities, RecordedStretch};
use rig_driver::SimulationOptions;

const GAIN: f64 = 1.862_54;
const TIME_CONSTANT: f64 = 0.023_88;
const VOLTS_PER_TORQUE: f64 = 4.842_6;
const INERTIA: f64 = 2.647_57e-3;

/// Volts at a time: a chirp from .5 to 8 Hz, steps both ways, three slow triangles.
fn excitation(t: f64) -> f64 {
    if t < 8.0 {
        return 4.0 * (std::f64::consts::TAU * (0.5 * t + 7.5 / 16.0 * t * t)).sin();
    }
    if t < 14.0 {
        let levels = [2.0, -2.0, 4.0, -4.0, 3.0, -1.5, 5.0, -3.0, 1.5, -5.0, 2.5, 0.0];
        return levels[((t - 8.0) / 0.5) as usize % levels.len()];
    }
    let phase = ((t - 14.0) / 6.0).fract();
    1.2 * if phase < 0.25 {
        4.0 * phase
    } else if phase < 0.75 {
        2.0 - 4.0 * phase
    } else {
        4.0 * phase - 4.0
    }
}

fn record(model: AnyModel, seed: u64) -> DrivenRecording {
    let options = SimulationOptions { seed, ..SimulationOptions::default() };
    let mut rig = options.build(model).unwrap();
    let (mut voltage, mut velocity, mut friction) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..32_000 {
        let seen = rig.measure();
        if k > 0 {
            voltage.push(seen.voltage_applied);
        }
        velocity.push(seen.tachometer_velocity);
        friction.push(seen.torque);
        rig.apply(excitation(f64::from(k) * 1e-3)).unwrap();
    }
    velocity.pop();
    friction.pop();
    DrivenRecording {
        path: PathBuf::from("rig.csv"),
        time_step: 1e-3,
        voltage,
        position: None,
        velocity: Some(velocity),
        friction: Some(friction),
        axis: Some(AxisKind::Rotary),
        stretches: RecordedStretch::whole(31_999),
        irregularities: Irregularities::default(),
        one_cycle_in: 1,
    }
}

fn motor() -> Calibration {
    Calibration::Motor {
        torque_constant: Uncertain::exact(70.0 * 0.007_67),
        resistance: Uncertain::exact(2.6),
    }
}

fn contains(found: &Identified, name: &'static str, truth: f64) {
    let id = name.into();
    let estimate = found.estimates.iter().find(|estimate| estimate.id == id).unwrap();
    assert!(estimate.is_identified(), "{estimate:?}");
    assert!(estimate.interval.unwrap().contains(truth), "{truth}: {estimate:?}");
    assert!((estimate.value / truth - 1.0).abs() < 0.05, "{truth}: {estimate:?}");
}

#[test]
fn with_a_torque_sensor_gain_time_constant_and_inertia_lie_in_their_intervals() {
    let recording = record(AnyModel::test_bed(ModelName::LuGre), 3);
    let found = identify(&[recording], AxisKind::Rotary, None, Some(70.0)).unwrap();
    contains(&found, "gain", GAIN);
    contains(&found, "time_constant", TIME_CONSTANT);
    contains(&found, "volts_per_torque", VOLTS_PER_TORQUE);
    contains(&found, "inertia", INERTIA);
    // The rig has no delay of its own: half a sample is the hold.
    let delay = found.value("delay").unwrap();
    assert!((delay - 0.5e-3).abs() < 0.03e-3, "{delay}");

    let motor = motor_of(&found).unwrap();
    assert_eq!(read_motor(&render(&found)).unwrap(), motor);
    assert!(
        (motor.gain() / GAIN - 1.0).abs() < 0.01
            && (motor.time_constant() / TIME_CONSTANT - 1.0).abs() < 0.02
    );
    assert!((motor.armature_resistance / 2.6 - 1.0).abs() < 0.02);
}

#[test]
fn without_a_torque_sensor_the_gain_is_that_of_the_drive_with_its_bearings() {
    let model = AnyModel::test_bed(ModelName::LuGre);
    let f_v = model.parameter("f_v").unwrap();
    let f_s = model.parameter("f_s").unwrap();
    let recording = DrivenRecording { friction: None, ..record(model, 4) };
    let found = identify(&[recording], AxisKind::Rotary, Some(motor()), Some(70.0)).unwrap();
    // 1 / K = A K_m + f_v R_a / (A K_m).
    contains(&found, "gain", 1.0 / (1.0 / GAIN + VOLTS_PER_TORQUE * f_v));
    contains(&found, "viscous", f_v);
    contains(&found, "inertia", INERTIA);
    for name in ["deadband.forward", "deadband.backward"] {
        let deadband = found.value(name).unwrap();
        assert!((deadband / (VOLTS_PER_TORQUE * f_s) - 1.0).abs() < 0.1, "{name}: {deadband}");
    }
}

#[test]
fn nothing_known_of_the_motor_leaves_the_inertia_unknown() {
    let recording =
        DrivenRecording { friction: None, ..record(AnyModel::test_bed(ModelName::Coulomb), 5) };
    let found = identify(&[recording], AxisKind::Rotary, None, None).unwrap();
    assert_eq!(found.value("inertia"), None);
    assert!(found.value("gain").is_some());
    assert!(
        found.notes().iter().any(|note| note.contains("ratio to the torque per volt")),
        "{:?}",
        found.notes()
    );
    assert!(motor_of(&found).is_none() && !render(&found).contains("motor_constant:"));
}

#[test]
fn the_command_writes_its_files_and_refuses_bad_input() {
    let folder = tempfile::tempdir().unwrap();
    let recording = record(AnyModel::test_bed(ModelName::LuGre), 6);
    let mut text = String::from("t_s,voltage_V,velocity_rad_s,friction_Nm\n");
    let velocity = recording.velocity.unwrap();
    let friction = recording.friction.unwrap();
    for (k, u) in recording.voltage.iter().enumerate() {
        text.push_str(&format!("{},{u},{},{}\n", k as f64 * 1e-3, velocity[k], friction[k]));
    }
    std::fs::write(folder.path().join("rig.csv"), text).unwrap();
    let run = |args: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_frictionlab"));
        command.current_dir(folder.path()).arg("identify-drive").args(args).output().unwrap()
    };
    let output = run(&["rig.csv", "--gear-ratio", "70"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let shown = String::from_utf8(output.stdout).unwrap();
    assert!(shown.contains("time_constant") && shown.contains("identified"), "{shown}");
    let made = folder.path().join("runs/identify-drive-1");
    let drive = std::fs::read_to_string(made.join("drive.yaml")).unwrap();
    assert!((read_motor(&drive).unwrap().inertia / INERTIA - 1.0).abs() < 0.03);
    assert!(made.join("report.html").is_file() && made.join("identification-drive.json").is_file());

    for (args, said) in [
        (&["none.csv"][..], "none.csv"),
        (&["rig.csv", "--gear-ratio", "-1"], "--gear-ratio"),
        (&["rig.csv", "--motor-constant", "0.00767"], "--resistance"),
        (&["rig.csv", "--voltage", "nothing"], "nothing"),
    ] {
        let output = run(args);
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(message.contains(said), "{args:?}: {message}");
    }
}
