use proptest::prelude::*;

use super::*;
use crate::{Conditioning, Signals, condition};

const DT: f64 = 1e-3;
const HOW: Conditioning = Conditioning {
    cutoff: 100.0,
    acceleration_cutoff: 100.0,
    order: 4,
    differences: crate::Differences::SecondOrder,
    trim: 50,
    decimate: 10,
    low_pass_force: false,
};

/// A motion of two sines (several speeds, both directions) and its derivatives.
fn motion(samples: usize) -> Vec<(f64, f64, f64)> {
    let sine = |t: f64, amplitude: f64, w: f64| {
        let (sin, cos) = (w * t).sin_cos();
        (amplitude * sin, amplitude * w * cos, -amplitude * w * w * sin)
    };
    (0..samples)
        .map(|i| i as f64 * DT)
        .map(|t| (sine(t, 0.1, 3.0), sine(t, 0.02, 11.0)))
        .map(|(a, b)| (a.0 + b.0, a.1 + b.1, a.2 + b.2))
        .collect()
}

fn record(motion: &[(f64, f64, f64)], force: impl Fn(f64, f64) -> f64) -> Conditioned {
    let position: Vec<_> = motion.iter().map(|m| m.0).collect();
    let force: Vec<_> = motion.iter().map(|&(_, v, a)| force(v, a)).collect();
    condition(
        &Signals {
            time_step: DT,
            position: Some(&position),
            readings: None,
            velocity: None,
            force: &force,
        },
        &HOW,
    )
    .unwrap()
}

fn symmetric(mass: f64, viscous: f64, coulomb: f64, offset: f64) -> impl Fn(f64, f64) -> f64 {
    move |v, a| mass * a + viscous * v + coulomb * v.signum() + offset
}

#[test]
fn recovers_the_symmetric_axis() {
    let recording = record(&motion(8000), symmetric(95.0, 200.0, 20.0, -3.0));
    let fit = fit_axis(&recording, AxisModel::SYMMETRIC).unwrap();
    let expected = [
        (AxisTerm::Inertia, 95.0),
        (AxisTerm::Viscous, 200.0),
        (AxisTerm::Coulomb, 20.0),
        (AxisTerm::Offset, -3.0),
    ];
    for (term, value) in expected {
        // What is left is the error of the central differences, (11 dt)^2 / 6, and of the low-pass.
        assert!((fit.value(term) / value - 1.0).abs() < 1e-3, "{term}: {}", fit.value(term));
        assert!(fit.term(term).unwrap().is_identifiable());
    }
    assert!(fit.relative_error < 1.0);
    assert_eq!(fit.samples, 790);
}

#[test]
fn recovers_the_asymmetric_axis() {
    let recording = record(&motion(8000), |v, a| {
        if v > 0.0 { 95.0 * a + 160.0 * v + 18.0 } else { 95.0 * a + 240.0 * v - 22.0 }
    });
    let fit = fit_axis(&recording, AxisModel::ASYMMETRIC).unwrap();
    for (term, value) in [
        (AxisTerm::Inertia, 95.0),
        (AxisTerm::ViscousPositive, 160.0),
        (AxisTerm::ViscousNegative, 240.0),
        (AxisTerm::CoulombPositive, 18.0),
        (AxisTerm::CoulombNegative, 22.0),
    ] {
        assert!((fit.value(term) / value - 1.0).abs() < 2e-3, "{term}: {}", fit.value(term));
    }
    let coarse = fit_axis(&recording, AxisModel::SYMMETRIC).unwrap();
    assert!(coarse.relative_error > 3.0 * fit.relative_error);
}

#[test]
fn standard_errors_match_the_scatter() {
    use rand::SeedableRng;
    use rand_distr::Distribution;
    let normal = rand_distr::Normal::new(0.0, 5.0).unwrap();
    let clean = record(&motion(3000), symmetric(95.0, 200.0, 20.0, -3.0));
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(7);
    let fits: Vec<_> = (0..200)
        .map(|_| {
            let mut noisy = clean.clone();
            // White after decimation: one draw for each kept sample would be filtered, so decimate
            // nothing.
            noisy.decimate = 1;
            noisy.force.iter_mut().for_each(|force| *force += normal.sample(&mut rng));
            fit_axis(&noisy, AxisModel::SYMMETRIC).unwrap()
        })
        .collect();
    for term in AxisModel::SYMMETRIC.terms() {
        let values: Vec<_> = fits.iter().map(|fit| fit.value(term)).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let scatter = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>()
            / (values.len() - 1) as f64)
            .sqrt();
        let square = |fit: &AxisFit| fit.term(term).unwrap().standard_error.powi(2);
        let reported = (fits.iter().map(square).sum::<f64>() / fits.len() as f64).sqrt();
        // The widest of several intervals counts: a little wider than one that is known to be right.
        let wider = reported / scatter;
        assert!((0.85..1.35).contains(&wider), "{term}: {reported} against {scatter}");
    }
}

#[test]
fn the_cross_test_predicts_another_motion() {
    let axis = symmetric(95.0, 200.0, 20.0, -3.0);
    let fit = fit_axis(&record(&motion(8000), &axis), AxisModel::SYMMETRIC).unwrap();
    let other: Vec<_> =
        motion(8000).into_iter().map(|(x, v, a)| (-0.5 * x, -0.5 * v, -0.5 * a)).collect();
    let prediction = fit.predict(&record(&other, &axis)).unwrap();
    assert!(prediction.relative_error < 1.0);
    assert_eq!(prediction.time.len(), prediction.measured.len());
    assert!((prediction.time[0] - 0.05).abs() < 1e-12 && (prediction.time[1] - 0.06).abs() < 1e-12);
    // Without the inertia what is left is friction: of one size in each direction, give or take the
    // offset.
    let fastest = prediction
        .velocity
        .iter()
        .zip(&prediction.friction)
        .max_by(|a, b| a.0.total_cmp(b.0))
        .unwrap();
    assert!((fastest.1 - (200.0 * fastest.0 + 20.0 - 3.0)).abs() < 0.2, "{fastest:?}");
    let residual = prediction.residual();
    assert!((residual[10] - (prediction.measured[10] - prediction.predicted[10])).abs() < 1e-15);
}

#[test]
fn friction_alone_needs_no_inertia() {
    let recording = record(&motion(4000), symmetric(0.0, 2.0, 0.5, 0.0));
    let model = AxisModel { inertia: false, ..AxisModel::SYMMETRIC };
    let fit = fit_axis(&recording, model).unwrap();
    assert!(fit.term(AxisTerm::Inertia).is_none());
    assert!((fit.value(AxisTerm::Coulomb) / 0.5 - 1.0).abs() < 1e-3);
}

#[test]
fn what_is_not_excited_is_named() {
    let axis = symmetric(95.0, 200.0, 20.0, -3.0);
    let constant: Vec<_> = (0..3000).map(|i| (0.3 * i as f64 * DT, 0.3, 0.0)).collect();
    let fit =
        |motion: &[(f64, f64, f64)], model| fit_axis(&record(motion, &axis), model).unwrap_err();
    assert_eq!(
        fit(&constant, AxisModel::SYMMETRIC),
        IdentError::NotExcited { terms: vec![AxisTerm::Inertia] }
    );
    let no_inertia = AxisModel { inertia: false, ..AxisModel::SYMMETRIC };
    assert_eq!(
        fit(&constant, no_inertia),
        IdentError::NotExcited { terms: vec![AxisTerm::Coulomb, AxisTerm::Offset] }
    );
    // Speeds up and slows down, but never reverses.
    let forwards: Vec<_> = motion(3000)
        .into_iter()
        .zip(0..)
        .map(|((x, v, a), i)| (x + 2.0 * f64::from(i) * DT, v + 2.0, a))
        .collect();
    assert_eq!(
        fit(&forwards, AxisModel::SYMMETRIC),
        IdentError::NotExcited { terms: vec![AxisTerm::Coulomb, AxisTerm::Offset] }
    );
    let error = fit(&forwards, AxisModel::ASYMMETRIC);
    assert_eq!(
        error,
        IdentError::NotExcited {
            terms: vec![AxisTerm::ViscousNegative, AxisTerm::CoulombNegative]
        }
    );
    assert!(error.to_string().contains("both directions"), "{error}");
    let still = vec![(0.0, 0.0, 0.0); 3000];
    assert!(matches!(fit(&still, AxisModel::SYMMETRIC), IdentError::NotExcited { .. }));
}

#[test]
fn impossible_outcomes_are_refused() {
    let turned = record(&motion(4000), symmetric(-95.0, 200.0, 20.0, 0.0));
    assert!(matches!(
        fit_axis(&turned, AxisModel::SYMMETRIC),
        Err(IdentError::NegativeInertia { value, .. }) if value < -90.0
    ));
    let idle = record(&motion(4000), |_, _| 0.0);
    assert_eq!(fit_axis(&idle, AxisModel::SYMMETRIC), Err(IdentError::ZeroForce));
    // A stranger's file whose torque column never changes.
    let constant = record(&motion(4000), |_, _| 0.7);
    assert_eq!(fit_axis(&constant, AxisModel::SYMMETRIC), Err(IdentError::ConstantForce(0.7)));
    let short = record(&motion(230), symmetric(95.0, 200.0, 20.0, 0.0));
    assert!(matches!(
        fit_axis(&short, AxisModel::SYMMETRIC),
        Err(IdentError::TooFewSamples { .. })
    ));
}

proptest! {
    #[test]
    fn the_unit_of_force_does_not_matter(scale in 1e-6..1e6f64) {
        let recording = record(&motion(2000), symmetric(95.0, 200.0, 20.0, -3.0));
        let scaled = record(&motion(2000), |v, a| scale * symmetric(95.0, 200.0, 20.0, -3.0)(v, a));
        let (one, other) =
            (fit_axis(&recording, AxisModel::SYMMETRIC).unwrap(), fit_axis(&scaled, AxisModel::SYMMETRIC).unwrap());
        for (a, b) in one.terms.iter().zip(&other.terms) {
            prop_assert!((b.value / a.value / scale - 1.0).abs() < 1e-9);
            prop_assert!((b.standard_error / a.standard_error / scale - 1.0).abs() < 1e-6);
        }
        prop_assert!((one.relative_error - other.relative_error).abs() < 1e-9);
    }
}
