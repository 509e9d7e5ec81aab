use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64Mcg;

use super::*;
use crate::ParameterId;
use crate::estimate::{Doubt, Verdict};

/// A path through `turns`, at constant speed.
pub(super) fn path(turns: &[f64], samples: usize) -> Vec<f64> {
    let corners: Vec<f64> = std::iter::once(0.0).chain(turns.iter().copied()).collect();
    let lengths: Vec<f64> = corners.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    let total: f64 = lengths.iter().sum();
    let (mut leg, mut done) = (0, 0.0);
    (0..samples)
        .map(|i| {
            let along = total * (i + 1) as f64 / samples as f64;
            while leg + 1 < lengths.len() && along > done + lengths[leg] {
                done += lengths[leg];
                leg += 1;
            }
            corners[leg]
                + (corners[leg + 1] - corners[leg]).signum() * (along - done).min(lengths[leg])
        })
        .collect()
}

/// The nested path: 15 turns of alternating sides, each a fifteenth of .0057 rad nearer to zero
/// than the last, 4000 samples at constant speed.
fn nested() -> Vec<f64> {
    let turn = |i: i32| 0.0057 * f64::from(if i % 2 == 0 { 15 - i } else { i - 15 }) / 15.0;
    path(&(0..15).map(turn).collect::<Vec<_>>(), 4000)
}

fn run(operator: Operator, level: f64, lengths: &[f64], x: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; x.len()];
    assert!(operator.run(lengths, x, &mut out));
    out.iter().map(|u| level * u).collect()
}

fn maxwell(stiffnesses: &[f64], widths: &[f64], x: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; x.len()];
    for (k, &w) in stiffnesses.iter().zip(widths) {
        let mut out = vec![0.0; x.len()];
        stops(w, x, &mut out);
        sum.iter_mut().zip(out).for_each(|(sum, z)| *sum += k * z);
    }
    sum
}

fn fit(x: &[f64], y: &[f64], model: PreSlidingModel) -> PreSlidingFit {
    fit_pre_sliding(&[PreSlidingPath { displacement: x, torque: y }], model).unwrap()
}

fn assert_values(
    fit: &PreSlidingFit,
    expected: &[(impl Into<ParameterId> + Copy, f64)],
    tolerance: f64,
) {
    for &(name, value) in expected {
        let name = name.into();
        let got = fit.estimates.get(name).unwrap_or_else(|| panic!("{name} is missing: {fit:?}"));
        assert!(
            (got.value / value - 1.0).abs() < tolerance,
            "{name}: {} instead of {value}",
            got.value
        );
        assert!(got.is_identified(), "{got:?}");
    }
}

#[test]
fn exact_paths_give_every_operator_back() {
    let x = nested();
    let y = run(Operator::Sine, 0.098, &[0.006], &x);
    assert_values(&fit(&x, &y, PreSlidingModel::Proposed), &[("f_s", 0.098), ("z_b", 0.006)], 1e-9);
    let y = run(Operator::Exponential, 0.11, &[0.11 / 25.656], &x);
    assert_values(&fit(&x, &y, PreSlidingModel::LuGre), &[("f_s", 0.11), ("sigma0", 25.656)], 1e-9);
    let y = run(Operator::Power { delta: 0.5 }, 0.0929, &[0.0929 / 16.469], &x);
    let dahl = PreSlidingModel::Dahl { delta: 0.5 };
    assert_values(&fit(&x, &y, dahl), &[("f_c", 0.0929), ("sigma0", 16.469)], 1e-9);
    let y = run(Operator::ElastoPlastic, 0.08, &[0.08 / 16.469, 0.002], &x);
    let expected = [("f_s", 0.08), ("sigma0", 16.469), ("z_ba", 0.002)];
    assert_values(&fit(&x, &y, PreSlidingModel::ElastoPlastic), &expected, 1e-9);
}

/// Stiffnesses of Table 4.6 with widths that all slip.
#[test]
fn exact_paths_give_four_elements_back() {
    let x = nested();
    let (k, w) = ([7.9605, 4.8757, 2.6039, 1.0290], [0.001, 0.0021, 0.0034, 0.0052]);
    let y = maxwell(&k, &w, &x);
    let f_s: f64 = k.iter().zip(w).map(|(k, w)| k * w).sum();
    let found = fit(&x, &y, PreSlidingModel::Xiong { elements: 4 });
    let mut expected = vec![(ParameterId::new("f_s"), f_s)];
    for i in 0..4 {
        expected.push((ParameterId::new("lambda").element(i), k[i] * w[i] / f_s));
        expected.push((ParameterId::new("k").element(i), k[i]));
    }
    assert_values(&found, &expected, 1e-9);
    let shares: f64 =
        (0..4).map(|i| found.estimates.value(ParameterId::new("lambda").element(i)).unwrap()).sum();
    assert!((shares - 1.0).abs() < 1e-12);
}

/// Mean squares on the sine's own torque. The springs' 2.27e-4 agrees with the reference path; with
/// slip, four elements reach an rms of at most 1.2e-3 N m.
#[test]
fn four_slipping_elements_fit_the_sine_loop_and_springs_do_not() {
    let x = nested();
    let y = run(Operator::Sine, 0.098, &[0.006], &x);
    let mse = |model| fit(&x, &y, model).mse;
    let gms = mse(PreSlidingModel::Gms { elements: 4 });
    assert!(gms.sqrt() < 1.2e-3, "{}", gms.sqrt());
    assert!((mse(PreSlidingModel::Springs { elements: 4 }) / 2.27e-4 - 1.0).abs() < 5e-3);
    let lugre = mse(PreSlidingModel::LuGre);
    assert!(lugre < 9.15e-5 && lugre > 20.0 * gms, "{lugre} {gms}");
    assert!(mse(PreSlidingModel::Proposed) < 1e-24);
    // More elements only help.
    let eight = mse(PreSlidingModel::Gms { elements: 8 });
    assert!(eight < 0.2 * gms, "{eight} {gms}");
}

#[test]
fn the_model_that_made_the_path_fits_it_best() {
    let x = nested();
    let six = maxwell(
        &[6.0, 5.0, 4.0, 3.0, 2.0, 1.5],
        &[0.0008, 0.0016, 0.0024, 0.0033, 0.0042, 0.005],
        &x,
    );
    let truths = [
        (PreSlidingModel::Proposed, run(Operator::Sine, 0.098, &[0.006], &x)),
        (PreSlidingModel::LuGre, run(Operator::Exponential, 0.11, &[0.11 / 25.656], &x)),
        (PreSlidingModel::Gms { elements: 6 }, six),
    ];
    for (own, y) in &truths {
        let best = fit(&x, y, *own).mse;
        assert!(best < 1e-16, "{own:?}: {best}");
        for (other, _) in truths.iter().filter(|(other, _)| other != own) {
            let mse = fit(&x, y, *other).mse;
            assert!(mse > 1e3 * best && mse > 1e-8, "{other:?} on {own:?}: {mse}");
        }
    }
}

/// Tables 4.6 and 4.7 print four stiffnesses each from a fit without slip; only their sum, LuGre's
/// stiffness, is in the data.
#[test]
fn without_slip_single_stiffnesses_are_not_identified() {
    let x = nested();
    let y = run(Operator::Sine, 0.098, &[0.006], &x);
    let found = fit(&x, &y, PreSlidingModel::Springs { elements: 4 });
    let whole = found.estimates.get("sigma0").unwrap();
    assert!(whole.is_identified());
    let mut sum = 0.0;
    for i in 0..4 {
        let each = found.estimates.get(ParameterId::new("sigma0").element(i)).unwrap();
        sum += each.value;
        let Verdict::NotIdentifiable { doubt: Doubt::Confounded { .. }, remedy } = &each.verdict
        else {
            panic!("{each:?}");
        };
        assert!(remedy.contains("slip"));
        assert_eq!((each.standard_error, each.interval), (None, None));
    }
    assert!((sum / whole.value - 1.0).abs() < 1e-12);
}

/// A path too short for the widest element: its level is unknown, and so are the static level and
/// the shares.
#[test]
fn an_element_that_never_slips_leaves_the_level_unknown() {
    let x = path(&[0.003, -0.003, 0.002, -0.002, 0.003], 2000);
    let y = maxwell(&[8.0, 3.0], &[0.001, 0.02], &x);
    let found = fit(&x, &y, PreSlidingModel::Gms { elements: 2 });
    assert!((found.estimates.value("sigma0[0]").unwrap() / 8.0 - 1.0).abs() < 1e-6, "{found:?}");
    assert!((found.estimates.value("sigma0[1]").unwrap() / 3.0 - 1.0).abs() < 1e-6);
    assert!(!found.estimates.get("f_s").unwrap().is_identified());
    assert!(!found.estimates.get("alpha[0]").unwrap().is_identified());
}

/// Noise of the printed mean square, .019 N m: the reference errors are 1.2 % of f_s and .9 % of
/// z_b, mean square 3.62e-4.
#[test]
fn noise_of_the_printed_size_gives_the_reference_errors() {
    let x = nested();
    let clean = run(Operator::Sine, 0.098, &[0.006], &x);
    let normal = Normal::new(0.0, 0.019).unwrap();
    let (mut squares, mut covered, mut mse) = ([0.0; 2], [0.0; 2], 0.0);
    let n = 100;
    for seed in 0..n {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let y: Vec<f64> = clean.iter().map(|y| y + normal.sample(&mut rng)).collect();
        let found = fit(&x, &y, PreSlidingModel::Proposed);
        mse += found.mse / n as f64;
        for (i, (name, truth)) in [("f_s", 0.098), ("z_b", 0.006)].into_iter().enumerate() {
            let estimate = found.estimates.get(name).unwrap();
            squares[i] += (estimate.value / truth - 1.0).powi(2) / n as f64;
            covered[i] +=
                f64::from(u8::from(estimate.interval.unwrap().contains(truth))) / n as f64;
        }
    }
    let errors = squares.map(f64::sqrt);
    println!("noise .019: errors {errors:?}, covered {covered:?}, mse {mse:.3e}");
    assert!((mse / 3.61e-4 - 1.0).abs() < 0.02, "{mse}");
    assert!(errors[0] < 0.013 && errors[1] < 0.013, "{errors:?}");
    assert!(
        covered.iter().all(|&share| share > 0.95 - 4.0 * (0.95 * 0.05 / n as f64).sqrt()),
        "{covered:?}"
    );
}

/// The operators are the models at slow speed.
#[test]
fn operators_agree_with_the_models() {
    use friction_model::{Dahl, ElastoPlastic, FrictionModel, Gms, Stepper, TimeStep};
    let x = path(&[0.004, -0.003, 0.005, -0.001], 8000);
    let dt = TimeStep::new(1e-3).unwrap();
    let dahl = *Dahl::test_bed().parameters();
    let expected = run(Operator::Exponential, dahl.f_c, &[dahl.f_c / dahl.sigma0], &x);
    let plastic = *ElastoPlastic::test_bed().parameters();
    let z_ss = plastic.f_s / plastic.sigma0;
    let elastic = run(Operator::ElastoPlastic, plastic.f_s, &[z_ss, plastic.z_ba], &x);
    let gms = *Gms::test_bed().parameters();
    let widths: Vec<f64> = (0..4).map(|i| gms.alpha[i] * gms.f_s / gms.sigma0[i]).collect();
    let slip = maxwell(&gms.sigma0, &widths, &x);
    let mut steppers = (
        Stepper::new(Dahl::test_bed(), dt),
        Stepper::new(ElastoPlastic::test_bed(), dt),
        Stepper::new(Gms::test_bed(), dt),
    );
    let mut before = 0.0;
    for (i, &x) in x.iter().enumerate() {
        // Slow enough for the Stribeck curve to stand at f_s.
        let v = (x - before) / 1e-3;
        before = x;
        assert!(v.abs() < 0.01);
        steppers.0.step(v);
        steppers.1.step(v);
        steppers.2.step(v);
        let z = (steppers.0.state().continuous[0], steppers.1.state().continuous[0]);
        assert!((dahl.sigma0 * z.0 - expected[i]).abs() < 1e-12, "{i}");
        assert!(
            (plastic.sigma0 * z.1 - elastic[i]).abs() < 2e-4,
            "{i}: {} {}",
            plastic.sigma0 * z.1,
            elastic[i]
        );
        let sum: f64 =
            gms.sigma0.iter().zip(&steppers.2.state().continuous).map(|(k, z)| k * z).sum();
        assert!((sum - slip[i]).abs() < 3e-4, "{i}: {sum} {}", slip[i]);
    }
}

/// A virgin curve of finitely many slopes is found whole.
#[test]
fn the_spectrum_is_not_negative_and_explains_the_sine() {
    let x = nested();
    let y = run(Operator::Sine, 0.098, &[0.006], &x);
    let found = stop_spectrum(&[PreSlidingPath { displacement: &x, torque: &y }]).unwrap();
    assert!(found.stiffnesses.iter().all(|&k| k >= 0.0));
    let sum = maxwell(&found.stiffnesses, &found.widths, &x);
    let mse = sum.iter().zip(&y).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / 4000.0;
    assert!(mse < 1e-8, "{mse}");
    // The slope at rest: the sum of all stiffnesses is F_s pi / (2 Z_b).
    let total: f64 = found.stiffnesses.iter().sum();
    assert!((total / (0.098 * std::f64::consts::PI / 0.012) - 1.0).abs() < 0.01, "{total}");
}

#[test]
fn bad_paths_are_refused() {
    let refuse = |x: &[f64], y: &[f64], model| {
        fit_pre_sliding(&[PreSlidingPath { displacement: x, torque: y }], model).unwrap_err()
    };
    let x = path(&[0.003, -0.003], 100);
    let y = vec![0.1; 100];
    let proposed = PreSlidingModel::Proposed;
    assert!(matches!(
        refuse(&x[..5], &y[..5], proposed),
        IdentError::TooFewSamples { found: 5, .. }
    ));
    assert!(matches!(refuse(&x, &y[..50], proposed), IdentError::UnequalLengths { .. }));
    assert_eq!(refuse(&x, &[0.0; 100], proposed), IdentError::ZeroForce);
    assert_eq!(refuse(&[0.0; 100], &y, proposed), IdentError::NoMotion);
    assert_eq!(refuse(&x, &y, PreSlidingModel::Dahl { delta: 0.0 }), IdentError::Exponent(0.0));
    assert_eq!(refuse(&x, &y, PreSlidingModel::Gms { elements: 17 }), IdentError::ElementCount(17));
    let wrong: Vec<f64> = x.iter().map(|x| -x).collect();
    for model in [proposed, PreSlidingModel::Gms { elements: 3 }] {
        assert!(matches!(refuse(&x, &wrong, model), IdentError::NoConvergence(_)), "{model:?}");
    }
    let mut broken = y.clone();
    broken[7] = f64::NAN;
    assert!(matches!(refuse(&x, &broken, proposed), IdentError::NotFinite { index: 7, .. }));
}
