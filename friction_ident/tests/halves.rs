//! Two halves of one recording tell the same parameters, within what they say of themselves.
//!
//! The recordings are not part of the project: where they are not at hand, the tests say that they
//! were skipped.

use std::path::PathBuf;

use friction_ident::{
    AxisModel, Conditioned, Conditioning, Load, Signals, choose_load, condition, fit_axis,
};

/// The folder of recordings, if it is there.
fn folder(name: &str) -> Option<PathBuf> {
    let beside = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let folder = std::env::var_os("FRICTION_DATA").map_or_else(beside, PathBuf::from).join(name);
    if !folder.is_dir() {
        eprintln!("skipped: no recordings in {}", folder.display());
        return None;
    }
    Some(folder)
}

/// Columns of a table of numbers.
fn columns(file: PathBuf) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(file).unwrap();
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.trim().parse().unwrap()).collect())
        .collect();
    (0..rows[0].len()).map(|j| rows.iter().map(|row| row[j]).collect()).collect()
}

fn conditioned(dt: f64, place: &[f64], force: &[f64]) -> Conditioned {
    let signals =
        Signals { time_step: dt, position: Some(place), readings: None, velocity: None, force };
    condition(&signals, &Conditioning::for_time_step(dt)).unwrap()
}

/// Pairs of intervals of both halves, and how many of them agree: the difference lies within its
/// own 95 % interval, or one of the two is not to be trusted and says so.
fn agreeing(name: &str, dt: f64, place: &[f64], force: &[f64], loads: &[Load]) -> (usize, usize) {
    let whole = conditioned(dt, place, force);
    let load = choose_load(&whole, AxisModel::ASYMMETRIC, loads).map_or(Load::None, |c| c.chosen);
    let half = place.len() / 2;
    let (mut agree, mut all) = (0, 0);
    for base in [AxisModel::SYMMETRIC, AxisModel::ASYMMETRIC] {
        let model = AxisModel { load, ..base };
        let of = |range: std::ops::Range<usize>| {
            fit_axis(&conditioned(dt, &place[range.clone()], &force[range]), model)
        };
        let (Ok(first), Ok(second)) = (of(0..half), of(half..place.len())) else { continue };
        for (a, b) in first.terms.iter().zip(&second.terms) {
            let trusted = a.doubt.is_none() && b.doubt.is_none();
            let apart = (a.value - b.value).abs() / a.half_width.hypot(b.half_width);
            println!(
                "{name} {load:?} {}: {:.4} +- {:.4} (white {:.4}), {:.4} +- {:.4} (white {:.4}): {apart:.2}{}",
                a.term,
                a.value,
                a.half_width,
                2.0 * a.white_error,
                b.value,
                b.half_width,
                2.0 * b.white_error,
                if trusted { "" } else { " not trusted" }
            );
            all += 1;
            agree += usize::from(apart <= 1.0 || !trusted);
        }
    }
    (agree, all)
}

#[test]
fn halves_of_emps_agree() {
    let Some(folder) = folder("emps") else { return };
    let (mut agree, mut all) = (0, 0);
    for name in ["estimation.csv", "validation.csv"] {
        let found = columns(folder.join(name));
        let force: Vec<f64> = found[3].iter().map(|v| 35.150_651_882_485_47 * v).collect();
        let (a, n) = agreeing(name, 1e-3, &found[2], &force, &[Load::Spring]);
        (agree, all) = (agree + a, all + n);
    }
    assert!(agree as f64 >= 0.9 * all as f64, "{agree} of {all}");
}

#[test]
fn halves_of_the_arm_agree() {
    let Some(folder) = folder("tx40") else { return };
    let place = columns(folder.join("motor_position_rad.csv"));
    let torque = columns(folder.join("motor_torque_Nm.csv"));
    let (mut agree, mut all) = (0, 0);
    for (joint, ratio) in [32.0, 32.0, 45.0, -48.0, 45.0].into_iter().enumerate() {
        let q: Vec<f64> = place[joint].iter().map(|q| q / ratio).collect();
        let force: Vec<f64> = torque[joint].iter().map(|tau| tau * ratio).collect();
        let loads = [Load::Spring, Load::Gravity];
        let (a, n) = agreeing(&format!("joint {}", joint + 1), 2e-4, &q, &force, &loads);
        (agree, all) = (agree + a, all + n);
    }
    assert!(agree as f64 >= 0.9 * all as f64, "{agree} of {all}");
}
