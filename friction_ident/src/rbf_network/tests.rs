use friction_model::Stribeck;
use friction_model::presets::Presets;
use proptest::prelude::*;

use super::*;

/// The 80 speeds of the constant-velocity experiment: 30 in .03-.5 and 50 in .55-4 rad/s.
fn protocol_speeds() -> impl Iterator<Item = f64> {
    let slow = (0..30).map(|i| 0.03 + 0.47 * f64::from(i) / 29.0);
    slow.chain((0..50).map(|i| 0.55 + 3.45 * f64::from(i) / 49.0))
}

fn exact(speeds: impl IntoIterator<Item = f64>, model: &Stribeck) -> Vec<SteadyPoint> {
    speeds.into_iter().map(|v| SteadyPoint::new(v, model.steady_state(v))).collect()
}

fn test_bed() -> Vec<SteadyPoint> {
    exact(protocol_speeds(), &Stribeck::test_bed())
}

/// Just above standstill, where the curve is at the breakaway level.
const BREAKAWAY: f64 = 1e-9;

fn logarithmic(count: usize, smallest: f64, largest: f64) -> RbfOptions {
    RbfOptions {
        count,
        centres: Centres::Logarithmic { smallest, largest },
        ..RbfOptions::default()
    }
}

fn uniform(count: usize) -> RbfOptions {
    RbfOptions { count, centres: Centres::Uniform { largest: 4.0 }, ..RbfOptions::default() }
}

/// Root mean square errors \[N m\] on table 4.13's Stribeck curve, from an independent
/// implementation.
#[test]
fn the_errors_on_the_test_bed_are_the_known_ones() {
    let rms = |options| train_rbf_network(&test_bed(), &options).unwrap().mse.sqrt();
    for (count, with_logarithmic, with_uniform) in
        [(5, 1.2815e-3, 1.5745e-3), (10, 3.1415e-4, 4.6281e-4), (20, 2.0292e-5, 4.9752e-4)]
    {
        for (error, expected) in [
            (rms(logarithmic(count, 0.05, 4.0)), with_logarithmic),
            (rms(uniform(count)), with_uniform),
        ] {
            assert!(
                (error / expected - 1.0).abs() < 1e-4,
                "{count} bells: {error} instead of {expected}"
            );
        }
    }
}

#[test]
fn training_again_gives_the_presets() {
    let with_breakaway = std::iter::once(BREAKAWAY).chain(protocol_speeds());
    let chapter_3 = (0..=100).map(|i| f64::max(BREAKAWAY, 1e-3 * f64::from(i)));
    for (points, options, preset) in [
        (
            exact(with_breakaway, &Stribeck::test_bed()),
            logarithmic(10, 0.05, 4.0),
            RbfNetworkParameters::test_bed(),
        ),
        (
            exact(chapter_3, &Stribeck::chapter_3()),
            logarithmic(10, 0.002, 0.05),
            RbfNetworkParameters::chapter_3(),
        ),
    ] {
        let fit = train_rbf_network(&points, &options).unwrap();
        let p = *fit.network.parameters();
        assert!((p.w0 / preset.w0 - 1.0).abs() < 1e-9);
        let lists =
            [(p.weights, preset.weights), (p.centres, preset.centres), (p.widths, preset.widths)];
        for (trained, preset) in lists {
            let largest = preset.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
            assert_eq!(trained.len(), preset.len());
            for (a, b) in trained.iter().zip(preset.iter()) {
                assert!((a - b).abs() < 1e-9 * largest, "{a} {b}");
            }
        }
    }
}

/// What a network says of standstill is an extrapolation: measured breakaway makes it right.
#[test]
fn breakaway_must_be_among_the_points_to_be_known() {
    let level = |points: &[SteadyPoint]| {
        train_rbf_network(points, &RbfOptions::default())
            .unwrap()
            .network
            .holding(0.0)
            .unwrap()
            .forward
    };
    let mut points = test_bed();
    assert!(level(&points) > 1.15 * 0.0994);
    points.push(SteadyPoint::new(BREAKAWAY, 0.0994));
    assert!((level(&points) / 0.0994 - 1.0).abs() < 0.025);
}

#[test]
fn a_network_is_found_again() {
    let truth = RbfNetwork::test_bed();
    let points: Vec<_> =
        protocol_speeds().map(|v| SteadyPoint::new(v, truth.steady_state(v))).collect();
    let fit = train_rbf_network(&points, &RbfOptions::default()).unwrap();
    assert!(fit.mse.sqrt() < 1e-6, "{}", fit.mse);
    for v in [0.02, 0.3, 2.1, 4.0] {
        assert!((fit.torque(v) - truth.steady_state(v)).abs() < 1e-4, "{v}");
    }
}

#[test]
fn both_directions_points_at_rest_and_deviations() {
    let expected = train_rbf_network(&test_bed(), &RbfOptions::default()).unwrap();
    let mut points = test_bed();
    for point in points.iter_mut().step_by(2) {
        *point = SteadyPoint::new(-point.velocity, -point.torque);
    }
    points.push(SteadyPoint::new(0.0, 0.05));
    // Equal deviations change nothing, whatever their size; a point that is worth nothing changes
    // nothing either.
    for point in &mut points {
        point.deviation = Some(7.0);
    }
    let fit = train_rbf_network(&points, &RbfOptions::default()).unwrap();
    assert_eq!((fit.points, fit.speeds), (80, (0.03, 4.0)));
    points.push(SteadyPoint { velocity: 1.0, torque: 5.0, deviation: Some(1e9), place: None });
    let with_outlier = train_rbf_network(&points, &RbfOptions::default()).unwrap();
    for v in [0.03, 0.14, 1.0, 3.9, -2.0] {
        assert!((fit.torque(v) - expected.torque(v)).abs() < 1e-12, "{v}");
        assert!((with_outlier.torque(v) - expected.torque(v)).abs() < 1e-6, "{v}");
    }
}

#[test]
fn the_ridge_is_the_least_of_residual_and_weights_together() {
    let options = RbfOptions { ridge: 1e-3, ..RbfOptions::default() };
    let fit = train_rbf_network(&test_bed(), &options).unwrap();
    let cost = |p: RbfNetworkParameters| {
        let network = RbfNetwork::try_from(p).unwrap();
        let residual = test_bed()
            .iter()
            .map(|x| (network.steady_state(x.velocity) - x.torque).powi(2))
            .sum::<f64>();
        residual + options.ridge * (p.w0.powi(2) + p.weights.iter().map(|w| w.powi(2)).sum::<f64>())
    };
    let best = *fit.network.parameters();
    for step in [1e-4, -1e-4] {
        assert!(cost(RbfNetworkParameters { w0: best.w0 + step, ..best }) > cost(best));
        for i in 0..10 {
            let mut moved = best;
            moved.weights[i] += step;
            assert!(cost(moved) > cost(best), "weight {i}");
        }
    }
}

#[test]
fn widths_are_the_distances_between_the_centres() {
    assert_eq!(distances(&[0.0, 1.0, 4.0, 6.0]), [1.0, 2.0, 2.5, 2.0]);
    let centres = Centres::Logarithmic { smallest: 0.1, largest: 10.0 }.place(4);
    for (centre, expected) in centres.iter().zip([0.0, 0.1, 1.0, 10.0]) {
        assert!((centre - expected).abs() < 1e-14);
    }
    assert_eq!(Centres::Uniform { largest: 4.0 }.place(5), [0.0, 1.0, 2.0, 3.0, 4.0]);
}

#[test]
fn impossible_options_and_points_are_refused() {
    let run = |options: RbfOptions| train_rbf_network(&test_bed(), &options).map(|_| ());
    assert_eq!(run(uniform(2)), Err(IdentError::CentreCount(2)));
    assert_eq!(run(uniform(33)), Err(IdentError::CentreCount(33)));
    for (smallest, largest) in [(0.0, 4.0), (4.0, 4.0), (0.1, f64::INFINITY), (f64::NAN, 4.0)] {
        assert!(matches!(
            run(logarithmic(10, smallest, largest)),
            Err(IdentError::CentreSpan { .. })
        ));
    }
    assert_eq!(run(RbfOptions { ridge: 0.0, ..uniform(10) }), Err(IdentError::Ridge(0.0)));
    let few = train_rbf_network(&test_bed()[..10], &uniform(10)).unwrap_err();
    assert!(matches!(few, IdentError::TooFewSamples { needed: 11, found: 10, .. }), "{few}");
    assert!(few.to_string().contains("lower the number of centres"), "{few}");
    let same = vec![SteadyPoint::new(1.0, 0.1); 80];
    let few = train_rbf_network(&same, &uniform(10)).map(|_| ());
    assert_eq!(few, Err(IdentError::TooFewSpeeds { needed: 11, found: 1 }));
    let driving: Vec<_> =
        test_bed().iter().map(|point| SteadyPoint::new(point.velocity, -point.torque)).collect();
    let error = train_rbf_network(&driving, &RbfOptions::default()).unwrap_err();
    assert!(matches!(error, IdentError::NotAModel { parameter: "w0", .. }), "{error}");
}

proptest! {
    #[test]
    fn whatever_comes_the_network_is_friction(
        points in proptest::collection::vec((-10.0..10.0f64, -5.0..5.0f64), 0..60), count in 3usize..=32,
    ) {
        let points: Vec<_> = points.into_iter().map(|(v, t)| SteadyPoint::new(v, t)).collect();
        if let Ok(fit) = train_rbf_network(&points, &logarithmic(count, 0.05, 10.0)) {
            prop_assert!(fit.mse.is_finite());
            for v in [1e-6, 0.1, 1.0, 10.0, 1e6] {
                prop_assert!(fit.torque(v) >= 0.0);
            }
        }
    }
}
