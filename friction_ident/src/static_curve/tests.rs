use proptest::prelude::*;
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64Mcg;

use super::*;

/// Table 4.13 of the thesis.
const TRUTH: StribeckValues =
    StribeckValues { f_s: 0.0994, f_c: 0.0925, v_s: 0.1407, f_v: 0.0403, delta: 2.0 };

/// The 80 speeds of the constant-velocity experiment: 30 in .03-.5 and 50 in .55-4 rad/s.
fn protocol_speeds() -> Vec<f64> {
    let slow = (0..30).map(|i| 0.03 + 0.47 * f64::from(i) / 29.0);
    slow.chain((0..50).map(|i| 0.55 + 3.45 * f64::from(i) / 49.0)).collect()
}

fn exact(truth: &StribeckValues) -> Vec<SteadyPoint> {
    protocol_speeds().into_iter().map(|v| SteadyPoint::new(v, truth.torque(v))).collect()
}

fn noisy(noise: f64, seed: u64) -> Vec<SteadyPoint> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let normal = Normal::new(0.0, noise).unwrap();
    let mut points = exact(&TRUTH);
    for point in &mut points {
        point.torque += normal.sample(&mut rng);
    }
    points
}

fn fit(points: &[SteadyPoint]) -> StribeckFit {
    fit_stribeck(points, &StribeckOptions::default()).unwrap()
}

fn values(values: &StribeckValues) -> [f64; 4] {
    [values.f_s, values.f_c, values.v_s, values.f_v]
}

fn assert_recovers(fit: &StribeckFit, truth: &StribeckValues, tolerance: f64) {
    for (got, want) in values(&fit.parameters).iter().zip(values(truth)) {
        assert!((got / want - 1.0).abs() < tolerance, "{:?} instead of {truth:?}", fit.parameters);
    }
}

#[test]
fn exact_data_give_the_truth_back() {
    let fit = fit(&exact(&TRUTH));
    assert_recovers(&fit, &TRUTH, 1e-6);
    assert!(fit.mse < 1e-18);
    assert_eq!(fit.unidentifiable, [None; 4]);
}

/// Five speeds each way, of which only the slowest is in the dip: such points were refused, with the
/// advice to look for outliers.
#[test]
fn a_dip_at_the_slowest_speed_alone_is_no_error() {
    let forward = [
        (0.14590061, 0.083359726),
        (0.83892853, 0.0727317),
        (1.5319564, 0.084991556),
        (2.2249844, 0.097342648),
        (2.9180123, 0.10935955),
    ];
    let backward = [-0.072461062, -0.06196862, -0.074175588, -0.086778445, -0.098936015];
    let both = forward
        .iter()
        .zip(backward)
        .flat_map(|(&(v, ahead), back)| [SteadyPoint::new(v, ahead), SteadyPoint::new(-v, back)]);
    let fit = fit(&both.collect::<Vec<_>>());
    assert!(fit.unidentifiable[0].is_some() && fit.unidentifiable[2].is_some());
    // Without the dip it is the straight line through the means of both directions.
    let StribeckValues { f_c, f_v, .. } = fit.parameters;
    assert!((f_c - 0.067_147).abs() < 1e-5 && (f_v - 0.011_138).abs() < 1e-5, "{f_c} {f_v}");
}

/// Real axes have friction that grows ever more slowly with speed (EMPS, a TX40's first joint). What
/// fits it best is a dip as wide as all speeds over a negative `f_c`, which no friction has: it must
/// not draw the intervals away from the estimates.
#[test]
fn friction_that_levels_off_has_its_estimates_within_their_intervals() {
    for noise in [0.0005, 0.002, 0.008] {
        let mut rng = Pcg64Mcg::seed_from_u64(11);
        let normal = Normal::new(0.0, noise).unwrap();
        let torque = |v: f64| 0.05 + 0.08 * (1.0 - (-v).exp()) + 0.005 * v;
        let points: Vec<SteadyPoint> = protocol_speeds()
            .into_iter()
            .map(|v| SteadyPoint::new(v, torque(v) + normal.sample(&mut rng)))
            .collect();
        for estimate in fit(&points).estimates() {
            let (low, high) = estimate.interval.unwrap_or((0.0, f64::INFINITY));
            assert!((low..=high).contains(&estimate.value), "{noise}: {estimate:?}");
        }
    }
}

#[test]
fn both_directions_and_points_at_rest() {
    let mut points = exact(&TRUTH);
    for point in points.iter_mut().step_by(2) {
        *point = SteadyPoint::new(-point.velocity, -point.torque);
    }
    points.push(SteadyPoint::new(0.0, 0.05));
    let fit = fit(&points);
    assert_recovers(&fit, &TRUTH, 1e-6);
    assert_eq!(fit.points, 80);
    assert_eq!(fit.torque(-1.0), -fit.torque(1.0));
    assert_eq!(fit.torque(0.0), 0.0);
}

#[test]
fn other_exponents() {
    for delta in [0.5, 1.0, 3.0] {
        let truth = StribeckValues { delta, f_s: 0.14, ..TRUTH };
        let fit = fit_stribeck(&exact(&truth), &StribeckOptions { delta }).unwrap();
        assert_recovers(&fit, &truth, 1e-6);
    }
}

#[test]
fn the_band_covers_the_curve_as_often_as_it_says() {
    let repeats = 300;
    let inside = (1000..1000 + repeats)
        .map(|seed| fit(&noisy(1e-3, seed)))
        .filter(|fit| {
            let (low, high) = fit.band(0.1);
            (low..=high).contains(&TRUTH.torque(0.1))
        })
        .count();
    let share = inside as f64 / repeats as f64;
    assert!((0.91..=0.985).contains(&share), "{share}");
}

#[test]
fn at_the_printed_noise_the_dip_is_declared_unidentifiable() {
    // mse 3.73e-5, as the thesis prints it: f_s - f_c = .0069 is no larger than the noise.
    let fits: Vec<_> = (0..40).map(|seed| fit(&noisy(0.0061, seed))).collect();
    let refused = fits
        .iter()
        .filter(|fit| fit.estimate(StribeckParameter::StribeckVelocity).unidentifiable.is_some());
    assert!(refused.count() >= 32);
    for fit in &fits {
        assert_eq!(fit.estimate(StribeckParameter::CoulombFriction).unidentifiable, None);
        assert_eq!(fit.estimate(StribeckParameter::Viscous).unidentifiable, None);
        let StribeckValues { f_s, f_c, v_s, f_v, .. } = fit.parameters;
        assert!(f_c > 0.0 && f_s >= f_c && v_s > 0.0 && f_v >= 0.0);
        // Nothing measured lies above this; a compensator fed with more would push.
        assert!(f_s < 0.12, "{f_s}");
    }
}

/// The sum of squares of an independent linear fit at both ends of the interval of `v_s` is at the
/// limit.
#[test]
fn the_profile_of_the_stribeck_velocity_ends_at_the_limit() {
    let points = noisy(1e-3, 3);
    let fit = fit(&points);
    let least = fit.mse * 80.0;
    let limit = crate::profile::sum_limit(least, 80, 4, 1.0);
    let interval = fit.intervals[2].unwrap();
    for v_s in [interval.low, interval.high] {
        let column = |v: f64| [(-(v / v_s).powi(2)).exp(), 1.0, v];
        let a = nalgebra::DMatrix::from_fn(80, 3, |i, j| column(points[i].velocity)[j]);
        let y = nalgebra::DVector::from_iterator(80, points.iter().map(|point| point.torque));
        let sum = crate::least_squares::solve(&a, &y).ok().unwrap().residual.norm_squared();
        assert!((sum / limit - 1.0).abs() < 1e-3, "{sum}, not {limit}");
    }
}

#[test]
fn no_dip_no_stribeck_velocity() {
    let flat = StribeckValues { f_s: 0.0925, ..TRUTH };
    let fit = fit(&exact(&flat));
    assert!((fit.parameters.f_c - 0.0925).abs() < 1e-9);
    assert!((fit.parameters.f_v - 0.0403).abs() < 1e-9);
    assert!(matches!(
        fit.estimate(StribeckParameter::StaticFriction).unidentifiable,
        Some(Unidentifiable::NoDip { .. })
    ));
    assert!(fit.estimate(StribeckParameter::StribeckVelocity).unidentifiable.is_some());
}

#[test]
fn a_dip_below_the_slowest_speed_is_not_invented() {
    let hidden = StribeckValues { v_s: 0.002, ..TRUTH };
    let fit = fit(&exact(&hidden));
    assert!(fit.estimate(StribeckParameter::StribeckVelocity).unidentifiable.is_some());
    assert!((fit.parameters.f_c - 0.0925).abs() < 1e-6);
}

#[test]
fn falling_friction_keeps_the_viscous_term_at_its_bound() {
    let mut points = exact(&StribeckValues { f_v: 0.0, ..TRUTH });
    for point in &mut points {
        point.torque -= 0.005 * point.velocity;
    }
    let fit = fit(&points);
    assert_eq!(fit.parameters.f_v, 0.0);
    assert_eq!(
        fit.estimate(StribeckParameter::Viscous).unidentifiable,
        Some(Unidentifiable::AtBound { bound: 0.0 })
    );
}

#[test]
fn deviations_weigh_the_points() {
    // One point is far off but says so.
    let mut points = exact(&TRUTH);
    points[40].torque += 0.05;
    for (i, point) in points.iter_mut().enumerate() {
        point.deviation = Some(if i == 40 { 1e3 } else { 1e-3 });
    }
    assert_recovers(&fit(&points), &TRUTH, 1e-4);
    let scale = |factor: f64| {
        let scaled: Vec<_> = noisy(1e-3, 5)
            .into_iter()
            .map(|point| SteadyPoint { deviation: Some(factor), ..point })
            .collect();
        fit(&scaled)
    };
    let (one, other) = (scale(1e-3), scale(7.0));
    assert!(
        (one.standard_errors[0].unwrap() / other.standard_errors[0].unwrap() - 1.0).abs() < 1e-6
    );
}

#[test]
fn the_gradient_is_that_of_the_curve() {
    for velocity in [-2.0, -0.1, 0.05, 0.14, 3.0] {
        let gradient = TRUTH.gradient(velocity);
        for (i, slope) in gradient.iter().enumerate() {
            let moved = |step: f64| {
                let mut v = TRUTH;
                *[&mut v.f_s, &mut v.f_c, &mut v.v_s, &mut v.f_v][i] += step;
                v.torque(velocity)
            };
            let numeric = (moved(1e-6) - moved(-1e-6)) / 2e-6;
            assert!((slope - numeric).abs() < 1e-8, "{i} at {velocity}: {slope} and {numeric}");
        }
    }
}

#[test]
fn correlation_is_one_with_itself() {
    let fit = fit(&noisy(1e-3, 1));
    use StribeckParameter::*;
    assert!((fit.correlation(Viscous, Viscous).unwrap() - 1.0).abs() < 1e-12);
    // More kinetic friction is traded against less slope.
    assert!(fit.correlation(CoulombFriction, Viscous).unwrap() < -0.5);
}

#[test]
fn degenerate_points_are_refused() {
    let run = |points: &[SteadyPoint]| fit_stribeck(points, &StribeckOptions::default());
    assert!(matches!(run(&[]), Err(IdentError::TooFewSamples { found: 0, .. })));
    let same = vec![SteadyPoint::new(1.0, 0.1); 20];
    assert!(matches!(run(&same), Err(IdentError::TooFewSpeeds { found: 1, .. })));
    let still = vec![SteadyPoint::new(0.0, 0.1); 20];
    assert!(matches!(run(&still), Err(IdentError::TooFewSpeeds { found: 0, .. })));
    let mut points = exact(&TRUTH);
    points[3].torque = f64::NAN;
    assert!(matches!(
        run(&points),
        Err(IdentError::NotFinite { channel: "the torque", index: 3, .. })
    ));
    let zero: Vec<_> =
        exact(&TRUTH).into_iter().map(|p| SteadyPoint::new(p.velocity, 0.0)).collect();
    assert_eq!(run(&zero), Err(IdentError::ZeroForce));
    let driving: Vec<_> =
        exact(&TRUTH).into_iter().map(|p| SteadyPoint::new(p.velocity, -p.torque)).collect();
    assert!(matches!(run(&driving), Err(IdentError::NotFriction { .. })));
    let mut points = exact(&TRUTH);
    points[0].deviation = Some(1.0);
    assert!(matches!(run(&points), Err(IdentError::MixedDeviations { index: 1 })));
    points[0].deviation = Some(0.0);
    assert!(matches!(run(&points), Err(IdentError::StandardDeviation { index: 0, .. })));
    let exponent = fit_stribeck(&exact(&TRUTH), &StribeckOptions { delta: 0.0 });
    assert!(matches!(exponent, Err(IdentError::Exponent(_))));
}

proptest! {
    #[test]
    fn recovers_any_visible_curve(
        f_c in 0.01..100.0f64, dip in 0.05..2.0f64, v_s in 0.06..1.0f64, slope in 0.05..2.0f64,
    ) {
        let truth = StribeckValues { f_s: f_c * (1.0 + dip), f_c, v_s, f_v: f_c * slope, delta: 2.0 };
        assert_recovers(&fit(&exact(&truth)), &truth, 1e-6);
    }

    #[test]
    fn whatever_comes_the_curve_is_valid(
        points in proptest::collection::vec((-10.0..10.0f64, -5.0..5.0f64), 0..60),
    ) {
        let points: Vec<_> = points.into_iter().map(|(v, t)| SteadyPoint::new(v, t)).collect();
        if let Ok(fit) = fit_stribeck(&points, &StribeckOptions::default()) {
            let StribeckValues { f_s, f_c, v_s, f_v, .. } = fit.parameters;
            prop_assert!(f_c > 0.0 && f_s >= f_c && v_s > 0.0 && f_v >= 0.0);
            prop_assert!(f_s.is_finite() && v_s.is_finite() && fit.mse.is_finite());
        }
    }
}

/// A deviation of 1e-320 gave a singular value decomposition of what is no number, and a panic.
#[test]
fn a_deviation_that_drowns_the_others_is_refused_and_named() {
    let mut points = exact(&TRUTH);
    points.iter_mut().for_each(|point| point.deviation = Some(1e-3));
    for tiny in [1e-320, 5e-324, 1e-20] {
        points[7].deviation = Some(tiny);
        let refused = fit_stribeck(&points, &StribeckOptions::default());
        assert!(
            matches!(refused, Err(IdentError::DeviationRange { index: 7, .. })),
            "{tiny:e}: {refused:?}"
        );
        let message = refused.unwrap_err().to_string();
        assert!(
            message.contains("point 7") && message.contains("leave the deviations out"),
            "{message}"
        );
    }
    // All of them alike: only the ratios count.
    points.iter_mut().for_each(|point| point.deviation = Some(1e-200));
    assert_recovers(&fit(&points), &TRUTH, 1e-6);
}
