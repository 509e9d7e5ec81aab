use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64Mcg;

use super::*;
use crate::SavitzkyGolay;
use crate::pre_sliding::{Operator, PreSlidingModel, PreSlidingPath, fit_pre_sliding};

/// One count of 4096 a turn \[rad\].
const COUNT: f64 = std::f64::consts::TAU / 4096.0;
const F_S: f64 = 0.098;
const Z_B: f64 = 0.006;

/// The nested path of the pre-sliding stage: 15 turns at constant speed, each nearer to zero, or
/// the same turns on half sines.
fn nested(turn: Turn) -> Vec<f64> {
    let corners: Vec<f64> = std::iter::once(0.0)
        .chain((0..15).map(|i| 0.0057 * f64::from(if i % 2 == 0 { 15 - i } else { i - 15 }) / 15.0))
        .collect();
    let mut path = Vec::new();
    for pair in corners.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let samples = ((to - from).abs() / 2.2e-5).round() as usize;
        for i in 1..=samples {
            let s = i as f64 / samples as f64;
            let s =
                if turn == Turn::Sharp { s } else { 0.5 - 0.5 * (std::f64::consts::PI * s).cos() };
            path.push(from + (to - from) * s);
        }
    }
    path
}

/// Errors of z_b, naive and corrected, over seeds: torque in steps of .01123 N m with .004 of
/// dither, and the encoder at any place within its first count.
fn errors(turn: Turn, seeds: u64) -> [Vec<f64>; 2] {
    let x = nested(turn);
    let mut unit = vec![0.0; x.len()];
    assert!(Operator::Sine.run(&[Z_B], &x, &mut unit));
    let normal = Normal::new(0.0, 0.004).unwrap();
    let mut both = [Vec::new(), Vec::new()];
    for seed in 0..seeds {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let phase: f64 = rng.random();
        let step = 0.01123;
        let torque: Vec<f64> = unit
            .iter()
            .map(|u| step * ((F_S * u + normal.sample(&mut rng)) / step).round())
            .collect();
        let read: Vec<f64> = x.iter().map(|x| COUNT * (x / COUNT + phase).floor()).collect();
        let naive: Vec<f64> = read.iter().map(|x| x - read[0]).collect();
        let between = between_counts(&read, COUNT, turn).unwrap();
        for (errors, displacement) in both.iter_mut().zip([&naive, &between]) {
            let path = PreSlidingPath { displacement, torque: &torque };
            let fit = fit_pre_sliding(&[path], PreSlidingModel::Proposed).unwrap();
            errors.push(fit.estimates.value("z_b").unwrap() / Z_B - 1.0);
        }
    }
    both
}

fn median_and_rms(errors: &[f64]) -> (f64, f64) {
    let mut sorted = errors.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    (sorted[errors.len() / 2], rms)
}

#[test]
fn the_error_of_the_breakaway_displacement_is_halved_or_better() {
    for turn in [Turn::Sharp, Turn::Round] {
        let [naive, between] = errors(turn, 60);
        let (before, after) = (median_and_rms(&naive), median_and_rms(&between));
        println!(
            "{turn:?}: naive median {:+.4} rms {:.4}, between counts median {:+.4} rms {:.4}",
            before.0, before.1, after.0, after.1
        );
        assert!(after.1 < 0.4 * before.1, "{before:?} {after:?}");
        assert!(
            after.0.abs() < 0.005 && after.0.abs() < 0.2 * before.0.abs(),
            "{before:?} {after:?}"
        );
    }
}

#[test]
fn what_is_no_reading_is_refused() {
    let read: Vec<f64> = (0..100).map(|i| COUNT * f64::from(i / 20)).collect();
    assert_eq!(between_counts(&read, 0.0, Turn::Sharp), Err(IdentError::Resolution(0.0)));
    assert!(matches!(
        between_counts(&[0.0; 50], COUNT, Turn::Sharp),
        Err(IdentError::TooFewSamples { found: 0, .. })
    ));
    let jump = [vec![0.0; 50], vec![1e9 * COUNT; 50]].concat();
    assert_eq!(between_counts(&jump, COUNT, Turn::Sharp), Err(IdentError::Resolution(COUNT)));
    let mut broken = read.clone();
    broken[9] = f64::NAN;
    assert!(matches!(
        between_counts(&broken, COUNT, Turn::Sharp),
        Err(IdentError::NotFinite { index: 9, .. })
    ));
}

/// Every position lies within the count that was read.
#[test]
fn the_path_stays_within_its_counts() {
    for turn in [Turn::Sharp, Turn::Round] {
        let x = nested(turn);
        let read: Vec<f64> = x.iter().map(|x| COUNT * (x / COUNT + 0.37).floor()).collect();
        let path = between_counts(&read, COUNT, turn).unwrap();
        // The first sample stands where the path begins within its count.
        let offsets: Vec<f64> =
            read.iter().zip(&path).map(|(at, x)| (x - (at - read[0])) / COUNT).collect();
        let (low, high) = offsets
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &x| (a.min(x), b.max(x)));
        assert!(high - low < 1.0 + 0.03, "{turn:?}: {low} {high}");
    }
}

/// Readings of an encoder at 1 kHz, rounded to the nearest count.
fn encoder(position: impl Fn(f64) -> f64, samples: usize) -> (Vec<f64>, Vec<f64>) {
    let truth: Vec<f64> = (0..samples).map(|k| position(k as f64 * 1e-3)).collect();
    let read = truth.iter().map(|p| (p / COUNT).round() * COUNT).collect();
    (truth, read)
}

#[test]
fn the_step_is_seen_where_the_axis_is_slow() {
    let (smooth, slow) = encoder(|t| 0.3 * (0.5 * t).sin(), 8000);
    assert!((step_of(&slow).unwrap() / COUNT - 1.0).abs() < 1e-9);
    assert_eq!(step_of(&smooth), None);
    assert_eq!(step_of(&[0.0; 100]), None);
    assert_eq!(step_of(&[]), None);
}

/// Uneven motion with turns of both kinds: never further than a count from the truth, but for one
/// constant.
#[test]
fn the_path_of_an_uneven_motion_stays_within_a_count_of_the_truth() {
    let (truth, read) = encoder(|t| 0.02 * (0.5 * t).sin() + 0.004 * (3.0 * t).sin(), 20_000);
    let path = between_counts(&read, COUNT, Turn::Sharp).unwrap();
    for (x, truth) in path.iter().zip(&truth) {
        assert!((x - truth).abs() <= COUNT, "{x} beside {truth}");
    }
}

/// At .03 rad/s the differences of what is read are 0 or 1.5 rad/s; between the counts and smoothed
/// they stay near .03.
#[test]
fn steps_do_not_become_velocity_spikes() {
    let (_, read) = encoder(|t| 0.03 * t + 2e-4, 5000);
    let filter = SavitzkyGolay::thesis().unwrap();
    let path = between_counts(&read, COUNT, Turn::Sharp).unwrap();
    for v in &filter.derivative(&path, 1e-3).unwrap()[100..4900] {
        assert!((v - 0.03).abs() < 0.002, "{v}");
    }
    let straight = filter.derivative(&read, 1e-3).unwrap();
    assert!(
        straight[100..4900].iter().any(|v| (v - 0.03).abs() > 0.02),
        "or the path is not needed"
    );
}
