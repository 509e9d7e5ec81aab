use proptest::prelude::*;
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64Mcg;

use super::*;
use crate::{IdentError, SteadyPoint};

/// The 80 speeds of the constant-velocity experiment: 30 in .03-.5 and 50 in .55-4 rad/s.
fn protocol_speeds() -> Vec<f64> {
    let slow = (0..30).map(|i| 0.03 + 0.47 * f64::from(i) / 29.0);
    slow.chain((0..50).map(|i| 0.55 + 3.45 * f64::from(i) / 49.0)).collect()
}

/// The tangents of the Tustin curve with table 4.13's parameters.
fn truth() -> TwoLine {
    TwoLine::test_bed()
}

fn exact(model: &TwoLine) -> Vec<SteadyPoint> {
    protocol_speeds().into_iter().map(|v| SteadyPoint::new(v, model.steady_state(v))).collect()
}

fn noisy(mut points: Vec<SteadyPoint>, noise: f64, seed: u64) -> Vec<SteadyPoint> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let normal = Normal::new(0.0, noise).unwrap();
    for point in &mut points {
        point.torque += normal.sample(&mut rng);
    }
    points
}

fn values(p: &TwoLineParameters) -> [f64; 4] {
    [p.a1, p.b1, p.a2, p.b2]
}

fn assert_recovers(fit: &TwoLineFit, truth: &TwoLine, tolerance: f64) {
    for (got, want) in values(fit.parameters()).into_iter().zip(values(truth.parameters())) {
        assert!((got - want).abs() < tolerance, "{:?} instead of {truth:?}", fit.model);
    }
}

#[test]
fn exact_data_give_the_truth_back() {
    let fit = fit_two_line(&exact(&truth())).unwrap();
    assert_recovers(&fit, &truth(), 1e-13);
    assert!((fit.model.switch_speed() - truth().switch_speed()).abs() < 1e-12);
    assert!(fit.mse < 1e-30);
    assert_eq!((fit.points, fit.degrees_of_freedom, fit.speeds), (80, 76, (0.03, 4.0)));
}

#[test]
fn both_directions_points_at_rest_and_repetitions_count_as_they_should() {
    let mut points = exact(&truth());
    for point in points.iter_mut().step_by(2) {
        *point = SteadyPoint::new(-point.velocity, -point.torque);
    }
    // A second round at speeds that differ by a rounding.
    let again: Vec<_> =
        points.iter().map(|p| SteadyPoint::new(p.velocity * (1.0 + 1e-9), p.torque)).collect();
    points.extend(again);
    points.push(SteadyPoint::new(0.0, 0.05));
    let fit = fit_two_line(&points).unwrap();
    assert_recovers(&fit, &truth(), 1e-9);
    assert_eq!(fit.points, 160);
    assert_eq!(fit.torque(-1.0), -fit.torque(1.0));
}

/// Points with a tenth of the deviation count a hundred times as much.
#[test]
fn deviations_are_weights() {
    let mut points = noisy(exact(&truth()), 3e-4, 5);
    for (i, point) in points.iter_mut().enumerate() {
        let good = i % 2 == 0;
        if good {
            point.torque = truth().steady_state(point.velocity);
        } else {
            point.torque += 1e-3;
        }
        point.deviation = Some(if good { 1e-6 } else { 1.0 });
    }
    assert_recovers(&fit_two_line(&points).unwrap(), &truth(), 1e-9);
}

/// Over many repetitions the scatter of the estimates is the standard error that each fit states,
/// and the intervals cover the truth as often as they say.
#[test]
fn standard_errors_are_the_scatter() {
    const NOISE: f64 = 3e-4;
    const REPEATS: u64 = 400;
    let (mut squares, mut reported, mut covered) = ([0.0; 5], [0.0; 5], [0.0; 5]);
    let mut mse = 0.0;
    for seed in 0..REPEATS {
        let fit = fit_two_line(&noisy(exact(&truth()), NOISE, seed)).unwrap();
        mse += fit.mse / REPEATS as f64;
        let [a1, b1, a2, b2] = values(fit.parameters());
        let [c1, d1, c2, d2] = values(truth().parameters());
        let errors =
            [a1 - c1, b1 - d1, a2 - c2, b2 - d2, fit.model.switch_speed() - truth().switch_speed()];
        let intervals = fit.intervals();
        for i in 0..5 {
            let error =
                if i < 4 { fit.standard_errors[i].unwrap() } else { fit.switch_speed_error };
            let (low, high) =
                if i < 4 { intervals[i].unwrap() } else { fit.switch_speed_interval() };
            squares[i] += errors[i].powi(2) / REPEATS as f64;
            reported[i] += error.powi(2) / REPEATS as f64;
            let truth = 0.5 * (low + high) - errors[i];
            covered[i] += if (low..=high).contains(&truth) { 1.0 / REPEATS as f64 } else { 0.0 };
        }
    }
    for i in 0..5 {
        let ratio = (squares[i] / reported[i]).sqrt();
        assert!((ratio - 1.0).abs() < 0.2, "parameter {i}: {ratio}");
        assert!((0.90..=0.99).contains(&covered[i]), "parameter {i}: covered in {}", covered[i]);
    }
    let expected = NOISE * NOISE * (1.0 - 4.0 / 80.0);
    assert!((mse / expected - 1.0).abs() < 0.05, "{mse}");
}

/// Sum of squares of the best lines that bend at `bend`, from the normal equations in
/// `[1, v, max(v - bend, 0)]`.
fn bent(points: &[SteadyPoint], bend: f64) -> f64 {
    use nalgebra::{Matrix3, Vector3};
    let row = |v: f64| Vector3::new(1.0, v, (v - bend).max(0.0));
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for point in points {
        normal += row(point.velocity) * row(point.velocity).transpose();
        right += row(point.velocity) * point.torque;
    }
    let x = normal.lu().solve(&right).unwrap();
    points.iter().map(|point| (row(point.velocity).dot(&x) - point.torque).powi(2)).sum()
}

#[test]
fn no_other_break_does_better() {
    let speeds = protocol_speeds();
    let curves: [fn(f64) -> f64; 3] = [
        |v| truth().steady_state(v),
        |v| 0.0925 + 0.0069 * (-v / 0.1407).exp() + 0.0403 * v,
        |v| 0.0925 + 0.0069 * (-(v / 0.1407).powi(2)).exp() + 0.0403 * v,
    ];
    for (curve, seed) in curves.into_iter().zip(0..) {
        for noise in [1e-9, 3e-4] {
            let points = speeds.iter().map(|&v| SteadyPoint::new(v, curve(v))).collect();
            let points = noisy(points, noise, seed);
            let fit = fit_two_line(&points).unwrap();
            let squares = fit.mse * 80.0;
            let (slow, fast) = (speeds[2], speeds[76]);
            let least = (0..=5000)
                .map(|i| bent(&points, slow + (fast - slow) * f64::from(i) / 5000.0))
                .fold(f64::INFINITY, f64::min);
            assert!(squares < least * (1.0 + 1e-6), "{squares} {least} {:?}", fit.model);
            // The scan's own break is no worse than the grid's by the width of the grid.
            assert!(bent(&points, fit.model.switch_speed()) < squares * (1.0 + 1e-6) + 1e-20);
        }
    }
}

/// The tangents of a Tustin curve lie below it; the best lines leave less than a tenth of their
/// mean square. They bend later, and start lower than the curve does.
#[test]
fn the_best_lines_beat_the_tangents_of_the_curve() {
    let tustin = |v: f64| 0.0925 + 0.0069 * (-v / 0.1407).exp() + 0.0403 * v;
    let points: Vec<_> =
        protocol_speeds().iter().map(|&v| SteadyPoint::new(v, tustin(v))).collect();
    let fit = fit_two_line(&points).unwrap();
    let tangents =
        points.iter().map(|p| (truth().steady_state(p.velocity) - p.torque).powi(2)).sum::<f64>()
            / 80.0;
    assert!(fit.mse < tangents / 10.0, "{} {tangents}", fit.mse);
    assert!(fit.model.switch_speed() > 0.2 && fit.parameters().a1 < 0.0985, "{:?}", fit.model);
}

/// Dry friction: the second line is level, and noise would make it fall every other time.
#[test]
fn a_falling_second_line_is_held_level() {
    let dry =
        TwoLine::try_from(TwoLineParameters { a1: 0.15, b1: -0.2, a2: 0.09, b2: 0.0 }).unwrap();
    let mut held = 0;
    for seed in 0..100 {
        let fit = fit_two_line(&noisy(exact(&dry), 1e-3, seed)).unwrap();
        assert!(fit.parameters().b2 >= 0.0);
        assert!((fit.parameters().a2 / 0.09 - 1.0).abs() < 0.02, "{:?}", fit.model);
        if fit.parameters().b2 == 0.0 {
            held += 1;
            assert_eq!(
                (fit.standard_errors[3], fit.intervals()[3], fit.degrees_of_freedom),
                (None, None, 77)
            );
        }
    }
    assert!((30..=70).contains(&held), "{held} of 100");
}

#[test]
fn points_on_one_line_show_no_bend() {
    let line = |v: f64| 0.0925 + 0.0403 * v;
    let points: Vec<_> = protocol_speeds().iter().map(|&v| SteadyPoint::new(v, line(v))).collect();
    assert!(matches!(fit_two_line(&points), Err(IdentError::NoBend { .. })));
    let refused = (0..200)
        .filter(|&seed| {
            matches!(
                fit_two_line(&noisy(points.clone(), 1e-3, seed)),
                Err(IdentError::NoBend { .. })
            )
        })
        .count();
    assert!(refused > 170, "{refused} of 200");
}

#[test]
fn impossible_points_are_refused() {
    assert!(matches!(fit_two_line(&[]), Err(IdentError::TooFewSamples { found: 0, .. })));
    let same = vec![SteadyPoint::new(1.0, 0.1); 20];
    assert!(matches!(fit_two_line(&same), Err(IdentError::TooFewSpeeds { needed: 6, found: 1 })));
    let mut points = exact(&truth());
    points[3].torque = f64::NAN;
    assert!(matches!(fit_two_line(&points), Err(IdentError::NotFinite { index: 3, .. })));
    let driving: Vec<_> =
        exact(&truth()).into_iter().map(|p| SteadyPoint::new(p.velocity, -p.torque)).collect();
    let error = fit_two_line(&driving).unwrap_err();
    assert!(matches!(error, IdentError::NotAModel { parameter: "a1", .. }), "{error}");
    assert!(error.to_string().contains("check the sign of the torque"), "{error}");
}

proptest! {
    #[test]
    fn recovers_any_lines(
        a2 in 0.01..100.0f64, dip in 0.05..2.0f64, v_sw in 0.08..3.5f64, b2 in 0.0..2.0f64,
    ) {
        let (a1, b2) = (a2 * (1.0 + dip), a2 * b2);
        let truth = TwoLine::try_from(TwoLineParameters { a1, b1: b2 - (a1 - a2) / v_sw, a2, b2 }).unwrap();
        let fit = fit_two_line(&exact(&truth)).unwrap();
        assert_recovers(&fit, &truth, 1e-10 * a1);
    }

    #[test]
    fn whatever_comes_the_lines_are_friction(
        points in proptest::collection::vec((-10.0..10.0f64, -5.0..5.0f64), 0..60),
    ) {
        let points: Vec<_> = points.into_iter().map(|(v, t)| SteadyPoint::new(v, t)).collect();
        if let Ok(fit) = fit_two_line(&points) {
            for v in [1e-6, 0.1, 1.0, 10.0, 1e6] {
                prop_assert!(fit.torque(v) > 0.0);
            }
            prop_assert!(fit.mse.is_finite() && fit.switch_speed_error.is_finite());
        }
    }
}
