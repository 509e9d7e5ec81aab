//! Constant-velocity stage: efficiency against the Cramér-Rao bound, and how often the reported
//! intervals cover the truth.
//!
//! `FRICTION_COVERAGE` sets the number of seeded repetitions, 200 if unset;
//! `cargo xtask test --full` sets 2000.

use friction_ident::{
    SteadyPoint, StribeckFit, StribeckOptions, StribeckValues, Verdict, fit_stribeck,
};
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64Mcg;

/// Table 4.13 of the thesis.
const TRUTH: StribeckValues =
    StribeckValues { f_s: 0.0994, f_c: 0.0925, v_s: 0.1407, f_v: 0.0403, delta: 2.0 };
const NAMES: [&str; 4] = ["f_s", "f_c", "v_s", "f_v"];
const VALUES: [f64; 4] = [TRUTH.f_s, TRUTH.f_c, TRUTH.v_s, TRUTH.f_v];

/// Relative Cramér-Rao bounds for noise of .001 N m, from an independent implementation.
const BOUND: [f64; 4] = [0.0065, 0.0027, 0.109, 0.0027];

fn repetitions() -> u64 {
    std::env::var("FRICTION_COVERAGE").ok().and_then(|text| text.parse().ok()).unwrap_or(200)
}

/// The 80 speeds of the constant-velocity experiment: 30 in .03-.5 and 50 in .55-4 rad/s.
fn measured(noise: f64, seed: u64) -> StribeckFit {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let normal = Normal::new(0.0, noise).unwrap();
    let slow = (0..30).map(|i| 0.03 + 0.47 * f64::from(i) / 29.0);
    let points: Vec<_> = slow
        .chain((0..50).map(|i| 0.55 + 3.45 * f64::from(i) / 49.0))
        .map(|v| SteadyPoint::new(v, TRUTH.torque(v) + normal.sample(&mut rng)))
        .collect();
    fit_stribeck(&points, &StribeckOptions::default()).unwrap()
}

/// How far from `share` the share of `n` independent cases may lie by chance: four standard
/// deviations, which happens once in 16 000.
fn chance(share: f64, n: f64) -> f64 {
    4.0 * (share * (1.0 - share) / n).sqrt()
}

#[test]
fn intervals_cover_the_truth_as_often_as_they_say_and_errors_reach_the_bound() {
    let n = repetitions() as f64;
    for (noise, first) in [(1e-3, 0), (1e-4, 1_000_000)] {
        let mut squares = [0.0; 4];
        let mut covered = [0.0; 4];
        let mut mse = 0.0;
        for seed in first..first + repetitions() {
            let fit = measured(noise, seed);
            mse += fit.mse / n;
            let estimates = fit.to_estimates();
            for (i, name) in NAMES.iter().enumerate() {
                let estimate = estimates.get(*name).unwrap();
                assert_eq!(
                    estimate.verdict,
                    Verdict::Identified,
                    "{name} at noise {noise}, seed {seed}"
                );
                squares[i] += (estimate.value / VALUES[i] - 1.0).powi(2) / n;
                covered[i] +=
                    f64::from(u8::from(estimate.interval.unwrap().contains(VALUES[i]))) / n;
            }
        }
        println!(
            "noise {noise}: rms errors {:?}, covered {covered:?}, mse {mse:.4e}",
            squares.map(f64::sqrt)
        );
        for i in 0..4 {
            let ratio = squares[i].sqrt() / (BOUND[i] * noise / 1e-3);
            // No unbiased estimator lies below 1; an rms of n draws scatters by 1 / sqrt(2 n).
            assert!(
                (0.8..1.35).contains(&ratio),
                "{} at noise {noise}: {ratio} times the bound",
                NAMES[i]
            );
            let off = covered[i] - 0.95;
            assert!(
                off.abs() < chance(0.95, n),
                "{} at noise {noise}: covered in {}",
                NAMES[i],
                covered[i]
            );
        }
        let expected = noise * noise * (1.0 - 4.0 / 80.0);
        assert!((mse / expected - 1.0).abs() < 0.1, "{mse}, not {expected}");
    }
}

/// At the thesis's own noise (mse 3.73e-5) the dip is as large as the noise. The intervals open
/// instead of missing; that of `v_s` covers a little less often than it says (.928 of 2000),
/// because without a dip its likelihood has no regular limit.
#[test]
fn at_the_printed_noise_the_intervals_open_and_still_cover() {
    let n = repetitions() as f64;
    let mut covered = [0.0; 4];
    let (mut open, mut refused) = (0.0, 0.0);
    for seed in 0..repetitions() {
        let fit = measured(0.0061, 2_000_000 + seed);
        let estimates = fit.to_estimates();
        for (i, name) in NAMES.iter().enumerate() {
            let interval = estimates.get(*name).unwrap().interval.unwrap();
            covered[i] += f64::from(u8::from(interval.contains(VALUES[i]))) / n;
        }
        let v_s = estimates.get("v_s").unwrap();
        let interval = v_s.interval.unwrap();
        let is_open = interval.low == 0.0 || interval.high == f64::INFINITY;
        open += f64::from(u8::from(is_open)) / n;
        refused += f64::from(u8::from(!v_s.is_identified())) / n;
        assert!(!(is_open && v_s.is_identified()), "seed {seed}: {v_s:?}");
    }
    println!("noise .0061: covered {covered:?}, v_s open in {open}, refused in {refused}");
    for i in 0..4 {
        assert!(covered[i] > 0.925 - chance(0.925, n), "{}: covered in {}", NAMES[i], covered[i]);
    }
    assert!(refused > 0.8, "{refused}");
}
