use std::fmt::Write;

use friction_ident::stretch::Before;
use friction_ident::{AxisTerm, FrictionData, StretchKind, choose_position_load};
use msgs::sensor_msgs::JointState;
use msgs::std_msgs::Header;

use super::*;
use crate::bag::{BagOptions, BagWriter};

fn parsed(text: &str) -> Result<FrictionRecording, RecordingError> {
    parse(Path::new("x.csv"), text.as_bytes(), &Columns::default(), &Preparation::default())
}

/// One run as rows: from rest to a velocity that is then held but for `swing`.
fn run(start: f64, speed: f64, swing: f64) -> String {
    let mut text = String::new();
    for k in 0..3000 {
        let t = f64::from(k) * 1e-3;
        let v = speed * (1.0 - (-t / 0.05).exp()) * (1.0 + swing * (9.0 * t).sin());
        writeln!(text, "{:.4},{v:.9},{:.9}", start + t, 0.09 * v.signum() + 0.04 * v).unwrap();
    }
    text
}

#[test]
fn runs_with_pauses_between_them_become_points_and_stretches() {
    let header = "t_s,velocity_rad_s,torque_Nm\n";
    let text = [header, &run(0.0, 0.5, 0.0), &run(4.0, -0.7, 0.0), &run(9.0, 1.0, 0.5)].concat();
    let found = parsed(&text).unwrap();
    assert_eq!((found.points.len(), found.stretches.len(), found.samples), (2, 1, 9000));
    for (point, speed) in found.points.iter().zip([0.5, -0.7]) {
        assert!((point.velocity / speed - 1.0).abs() < 1e-4, "{point:?}");
        assert!((point.torque - (0.09 * speed.signum() + 0.04 * speed)).abs() < 1e-5, "{point:?}");
    }
    assert_eq!(found.stretches[0].kind(None), StretchKind::Lag);
    assert_eq!(found.stretches[0].before, Before::Rested, "it started from rest");
    assert!((found.stretches[0].time_step - 1e-3).abs() < 1e-9);
    assert_eq!(found.axis, Some(AxisKind::Rotary));
}

#[test]
fn a_lost_sample_is_filled_in_and_lost_ones_cut_the_run() {
    let header = "t_s,velocity_rad_s,torque_Nm\n";
    let whole: Vec<String> = run(0.0, 1.0, 0.5).lines().map(str::to_owned).collect();
    let without = |lost: std::ops::Range<usize>| {
        let mut lines = whole.clone();
        lines.drain(lost);
        parsed(&[header, &lines.join("\n")].concat()).unwrap()
    };
    let found = without(1000..1001);
    assert_eq!((found.stretches.len(), found.irregularities.filled), (1, 1));
    assert_eq!(found.stretches[0].len(), 3000);
    let found = without(1000..1010);
    assert_eq!(found.stretches.iter().map(Stretch::len).collect::<Vec<_>>(), [1000, 1990]);
    assert_eq!((found.irregularities.gaps, found.irregularities.missing), (1, 10));
    assert_eq!(
        found.stretches.iter().map(|s| s.before).collect::<Vec<_>>(),
        [Before::Rested, Before::Slid]
    );
}

/// The velocity jumps where samples are lost; a filter that ran across would bend it on both sides.
#[test]
fn no_filter_reaches_across_a_gap() {
    let mut text = "t_s,velocity_rad_s,torque_Nm\n".to_owned();
    for k in 0..2000 {
        let t = f64::from(k) * 1e-3 + if k < 1000 { 0.0 } else { 0.05 };
        let v = if k < 1000 { 1.0 + 0.5 * (9.0 * t).sin() } else { -2.0 + 0.5 * (9.0 * t).sin() };
        writeln!(text, "{t:.4},{v:.9},{:.9}", 0.1 * v.signum()).unwrap();
    }
    let found = parsed(&text).unwrap();
    let [before, after] = &found.stretches[..] else { panic!("{}", found.stretches.len()) };
    assert!(before.velocity.iter().all(|v| (0.49..1.51).contains(v)));
    assert!(after.velocity.iter().all(|v| (-2.51..-1.49).contains(v)));
}

#[test]
fn steady_points_need_no_time() {
    let found =
        parsed("velocity_rad_s,torque_Nm,torque_deviation_Nm\n0.1,0.1,0.001\n-0.2,-0.11,0.002\n")
            .unwrap();
    assert_eq!(
        found.points[1],
        SteadyPoint { velocity: -0.2, torque: -0.11, deviation: Some(0.002), place: None }
    );
    assert!(found.stretches.is_empty());
    assert_eq!(parsed("velocity_m_s,force_N\n0.1,0.1\n").unwrap().points[0].deviation, None);
    for (text, said) in [
        ("velocity_rad_s,torque_Nm\n", "no samples"),
        ("velocity_rad_s,torque_Nm\n0.1,nan\n", "no value"),
        ("velocity_rad_s,torque_Nm\n0.1,inf\n", "line 2"),
        ("position_rad,torque_Nm\n0.1,0.1\n", "recognised as the time"),
    ] {
        let message = parsed(text).unwrap_err().to_string();
        assert!(message.contains(said), "{message}");
    }
}

/// Only an encoder: at .2 rad/s and 1 kHz its differences are 0 or 1.5 rad/s.
#[test]
fn an_encoder_alone_gives_a_velocity_without_spikes() {
    let step = std::f64::consts::TAU / 4096.0;
    let mut text = "t_s,position_rad,torque_Nm\n".to_owned();
    let position = |t: f64| 0.2 * t + 0.05 * (1.0 - (2.0 * t).cos());
    for k in 0..4000 {
        let t = f64::from(k) * 1e-3;
        writeln!(text, "{t:.4},{:.9},0.1", (position(t) / step).round() * step).unwrap();
    }
    let found = parsed(&text).unwrap();
    let stretch = &found.stretches[0];
    for (k, v) in stretch.velocity.iter().enumerate().skip(50).take(3900) {
        let truth = 0.2 + 0.1 * (2.0 * k as f64 * 1e-3).sin();
        assert!((v - truth).abs() < 0.05, "{k}: {v} instead of {truth}");
    }
}

/// An encoder beside a velocity: its position was thrown away, and a joint under gravity had only an
/// offset beside its friction.
#[test]
fn counts_beside_a_velocity_tell_the_place() {
    let step = std::f64::consts::TAU / 4096.0;
    let mut text = "t_s,position_rad,velocity_rad_s,torque_Nm\n".to_owned();
    for k in 0..26_000 {
        let t = f64::from(k) * 1e-3;
        let (q, v) = (1.2 * (1.0 - (0.5 * t).cos()), 0.6 * (0.5 * t).sin());
        let noise = 1e-3 * (1e3 * t * t).sin();
        let force = 0.2 * v.signum() + 0.05 * v + 0.3 * q.sin() + 0.2 * q.cos() + noise;
        writeln!(text, "{t:.4},{:.9},{:.9},{force:.9}", (q / step).floor() * step, v + noise)
            .unwrap();
    }
    let found = parsed(&text).unwrap();
    let stretch = &found.stretches[0];
    let off =
        |k: usize| stretch.place(k).unwrap().position - 1.2 * (1.0 - (0.5e-3 * k as f64).cos());
    assert!((50..25_950).all(|k| off(k).abs() < 2.0 * step));
    let data = FrictionData::sort(found.points, found.stretches, None);
    let load = choose_position_load(&data, true, false).chosen;
    assert!(load.terms().contains(&AxisTerm::GravitySin), "{load:?}");
}

/// Every edge that was passed took its place in memory, and beyond ten thousand a sample the
/// recording was refused.
#[test]
fn counts_far_finer_than_the_motion_need_no_path_between_them() {
    const STEP: f64 = 1e-6;
    for beside in [false, true] {
        let mut text = "t_s,position_rad,velocity_rad_s,torque_Nm\n".to_owned();
        if !beside {
            text = text.replace("velocity_rad_s,", "");
        }
        let mut q = 0.0;
        for k in 0..4000 {
            let t = f64::from(k) * 1e-3;
            // A third of the time at rest, then slow, then 30 000 counts a sample.
            let v: f64 =
                [0.0, 1e-3, 30.0][usize::from(k % 1500 >= 500) + usize::from(k % 1500 >= 600)];
            q += 1e-3 * v;
            let counted = (q / STEP).round() * STEP;
            let velocity = if beside { format!("{v:.9},") } else { String::new() };
            writeln!(text, "{t:.4},{counted:.6},{velocity}{:.9}", 0.1 * v.signum()).unwrap();
        }
        let found = parsed(&text).unwrap();
        assert!(!found.stretches.is_empty(), "{beside}");
    }
}

#[test]
fn replaced_outliers_are_listed() {
    let mut text = "t_s,velocity_rad_s,torque_Nm\n".to_owned();
    for k in 0..2000 {
        let t = f64::from(k) * 1e-3;
        let torque = if k == 700 { 5.0 } else { 0.1 + 0.001 * (1e5 * t).sin() };
        writeln!(text, "{t:.4},{:.9},{torque:.9}", 1.0 + 0.5 * (9.0 * t).sin()).unwrap();
    }
    let how = Preparation { outliers: Some(Hampel::default()), ..Preparation::default() };
    let found = parse(Path::new("x.csv"), text.as_bytes(), &Columns::default(), &how).unwrap();
    assert_eq!(found.outliers.len(), 1);
    let outlier = &found.outliers[0];
    assert_eq!((outlier.channel, outlier.measured), ("force", 5.0));
    assert!((outlier.time - 0.7).abs() < 1e-9 && (outlier.by - 0.1).abs() < 2e-3);
    assert!(found.stretches[0].friction.iter().all(|f| *f < 0.2));
}

/// Friction from the voltage of a motor: `u` such that the inertia is accelerated and the friction
/// overcome.
#[test]
fn friction_is_found_from_the_voltage() {
    let (constant, resistance) = (0.5369, 2.6);
    let inertia = Uncertain { value: 0.0026, standard_error: 2.6e-5 };
    let drive = DriveConstants {
        torque_constant: Uncertain::exact(constant),
        armature_resistance: Uncertain::exact(resistance),
        inertia,
    };
    let mut text = "t_s,velocity_rad_s,voltage_V\n".to_owned();
    for k in 0..2000 {
        let t = f64::from(k) * 1e-3;
        let motion = |t: f64| (1.0 + 0.5 * (9.0 * t).sin(), 4.5 * (9.0 * t).cos());
        // The mean over the period that ends here is the value in its middle, but for 2e-7 of it.
        let (v, a) = motion(t - 5e-4);
        let torque = 0.09 + 0.04 * v + inertia.value * a;
        let voltage = torque * resistance / constant + constant * v;
        writeln!(text, "{t:.4},{:.12},{voltage:.12}", motion(t).0).unwrap();
    }
    let columns = Columns { force: Some("voltage_V".parse().unwrap()), ..Columns::default() };
    let how =
        Preparation { torque: TorqueSource::Voltage, drive: Some(drive), ..Preparation::default() };
    let found = parse(Path::new("x.csv"), text.as_bytes(), &columns, &how).unwrap();
    let stretch = &found.stretches[0];
    for (f, v) in stretch.friction.iter().zip(&stretch.velocity).skip(30).take(1900) {
        assert!((f - 0.09 - 0.04 * v).abs() < 2e-5, "{f} at {v}");
    }
    let errors = &found.drive_errors;
    assert_eq!(
        errors.iter().map(|e| e.constant).collect::<Vec<_>>(),
        DriveConstant::entering(TorqueSource::Voltage)
    );
    let largest =
        errors[2].stretches[0][30..1900].iter().fold(0.0f64, |largest, e| largest.max(e.abs()));
    assert!((largest / (2.6e-5 * 4.5) - 1.0).abs() < 0.01, "{largest}");
    // Without constants nothing is worked out.
    let how = Preparation { drive: None, ..how };
    let message =
        parse(Path::new("x.csv"), text.as_bytes(), &columns, &how).unwrap_err().to_string();
    assert!(message.contains("inertia"), "{message}");
}

/// At constant speed `F = (k/R)(u - k w)`; the error of R is a fraction of it, that of k less so
/// (the back-EMF).
#[test]
fn steady_points_from_the_voltage_carry_the_errors_of_the_constants() {
    let drive = DriveConstants {
        torque_constant: Uncertain::relative(0.5, 0.01),
        armature_resistance: Uncertain::relative(2.5, 0.02),
        inertia: Uncertain::relative(0.0026, 0.02),
    };
    let columns = Columns { force: Some("voltage_V".parse().unwrap()), ..Columns::default() };
    let how =
        Preparation { torque: TorqueSource::Voltage, drive: Some(drive), ..Preparation::default() };
    let text = "velocity_rad_s,voltage_V\n1.0,1.0\n-1.0,-1.0\n";
    let found = parse(Path::new("x.csv"), text.as_bytes(), &columns, &how).unwrap();
    for (point, sign) in found.points.iter().zip([1.0, -1.0]) {
        assert!((point.torque - 0.1 * sign).abs() < 1e-12, "{point:?}");
    }
    let [k, r, j] = &found.drive_errors[..] else { panic!("three constants") };
    // .005 (u - 2 k w) / R and -.02 F.
    for (error, expected) in [(k, 0.0), (r, -0.002), (j, 0.0)] {
        assert!((error.points[0] - expected).abs() < 1e-12, "{error:?}");
        assert!((error.points[1] + expected).abs() < 1e-12, "{error:?}");
    }
}

#[test]
fn a_bag_of_many_runs_is_cut_at_the_pauses() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("bag");
    let mut bag = BagWriter::create(&dir, BagOptions::default()).unwrap();
    for (run, speed) in [0.2, 0.4, -0.4].into_iter().enumerate() {
        for i in 0..1000u64 {
            let stamp = 1_600_000_000_000_000_000 + run as u64 * 5_000_000_000 + i * 2_000_000;
            let state = JointState {
                header: Header::at(stamp),
                name: vec!["load_shaft".into()],
                position: vec![0.0],
                velocity: vec![speed],
                effort: vec![0.1 * speed.signum()],
            };
            bag.write("/joint_states", stamp, &state).unwrap();
        }
    }
    bag.finish().unwrap();
    let found = read(&dir, &Columns::default(), &Preparation::default()).unwrap();
    assert_eq!(found.points.len(), 3);
    for (point, speed) in found.points.iter().zip([0.2, 0.4, -0.4]) {
        assert!((point.velocity - speed).abs() < 1e-9, "{point:?}");
    }
    assert!(found.stretches.is_empty());
}
