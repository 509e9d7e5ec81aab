//! Friction that changes while it is measured, as a cold drive warms up.
//!
//! `u = F(v) (1 + d g(t)) + v/K`, with `g` zero now: a straight line of time, or an exponential of
//! one of several time constants. `d` is fitted together with everything that a curve may be (Frisch
//! and Waugh 1933: of residual and regressor only what no curve explains), and is believed where it
//! is clear of its scatter. The points are then told as they would be now.

use nalgebra::{DMatrix, DVector};

use super::Point;

/// Points below which nothing is said of a drift.
const ENOUGH: usize = 12;
/// A drift is clear where it is so many standard errors.
const CLEAR: f64 = 4.0;
/// Time constants that are tried \[s\]; the last is a straight line.
const TIMES: [f64; 5] = [60.0, 120.0, 240.0, 480.0, f64::INFINITY];
/// Stribeck velocities that a curve may have, as shares of the fastest speed.
const DIPS: [f64; 4] = [0.003, 0.01, 0.03, 0.1];

/// What was found.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Drift {
    /// The points as they would be now.
    pub points: Vec<Point>,
    /// Relative change of the friction since the first of them; none where none is clear.
    pub change: Option<f64>,
}

/// Brings `points` to the time of the last of them.
pub(super) fn now(points: &[Point]) -> Drift {
    let still = || Drift { points: points.to_vec(), change: None };
    if points.len() < ENOUGH {
        return still();
    }
    let begin = points.iter().map(|point| point.time).fold(f64::INFINITY, f64::min);
    let end = points.iter().map(|point| point.time).fold(f64::NEG_INFINITY, f64::max);
    let explained = explained(points);
    let Some(slope) = slope(points) else { return still() };
    // Friction is what is not the speed's.
    let friction = |point: &Point| (point.volts - slope * point.velocity).max(0.0);
    let volts = DVector::from_iterator(points.len(), points.iter().map(|point| point.volts));
    let left = beyond(&explained, &volts);
    let free = points.len().saturating_sub(explained.ncols() + 2).max(1) as f64;
    let tried = |time: f64| {
        let shape =
            |at: f64| if time.is_finite() { ((end - at) / time).exp_m1() } else { end - at };
        let values = points.iter().map(|p| friction(p) * shape(p.time) / shape(begin));
        let regressor = DVector::from_iterator(points.len(), values);
        let own = beyond(&explained, &regressor);
        let power = own.norm_squared();
        let d = own.dot(&left) / power;
        let rest = (&left - &own * d).norm_squared();
        let clear = d / (rest / free / power).sqrt();
        clear.is_finite().then_some((rest, d, clear, regressor))
    };
    let best = TIMES.into_iter().filter_map(tried).min_by(|a, b| a.0.total_cmp(&b.0));
    match best {
        Some((_, d, clear, regressor)) if clear.abs() > CLEAR => {
            let told = |(p, r): (&Point, &f64)| Point { volts: p.volts - d * r, ..*p };
            let points = points.iter().zip(regressor.iter()).map(told).collect();
            Drift { points, change: Some(-d / (1.0 + d)) }
        }
        _ => still(),
    }
}

/// Columns of everything that a curve may be.
fn explained(points: &[Point]) -> DMatrix<f64> {
    let fastest = points.iter().map(|point| point.velocity).fold(0.0, f64::max);
    DMatrix::from_fn(points.len(), 2 + DIPS.len(), |row, column| {
        let velocity = points[row].velocity;
        match column {
            0 => 1.0,
            1 => velocity / fastest,
            dip => (-(velocity / (fastest * DIPS[dip - 2])).powi(2)).exp(),
        }
    })
}

/// What of `of` the columns do not explain.
fn beyond(columns: &DMatrix<f64>, of: &DVector<f64>) -> DVector<f64> {
    let basis = columns.clone().svd(true, false);
    let Some(u) = basis.u else { return of.clone() };
    let largest = basis.singular_values.max();
    let mut left = of.clone();
    for (column, size) in u.column_iter().zip(basis.singular_values.iter()) {
        if *size > 1e-6 * largest {
            let share = column.dot(&left);
            left -= column * share;
        }
    }
    left
}

/// Volts per speed between the middle speeds and the fastest.
fn slope(points: &[Point]) -> Option<f64> {
    let fastest = points.iter().map(|point| point.velocity).fold(0.0, f64::max);
    let line: Vec<(f64, f64)> = points
        .iter()
        .filter(|point| point.velocity > 0.1 * fastest)
        .map(|point| (point.velocity, point.volts))
        .collect();
    Some(friction_ident::statistics::line(&line)?.slope.value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(change: f64) -> Vec<Point> {
        let speeds = [4.0, 0.1, 2.0, 0.03, 1.0, 0.02, 0.3, 0.015];
        (0..32)
            .map(|i| {
                let velocity = speeds[i % 8] * (1.0 + 0.01 * i as f64);
                let time = 50.0 + 9.0 * i as f64;
                let warm = 1.0 + change * (1.0 - (-time / 120.0).exp());
                let friction = 0.4 + 0.1 * (-(velocity / 0.05).powi(2)).exp();
                let scatter = 2e-4 * (i as f64 * 2.4).sin();
                let volts = warm * friction + 0.5 * velocity + scatter;
                Point { velocity, volts, one_way: 0.0, uneven: 0.0, time }
            })
            .collect()
    }

    #[test]
    fn points_of_a_drive_that_warms_up_are_told_as_they_would_be_now() {
        let found = now(&measured(-0.1));
        let last = 50.0 + 9.0 * 31.0;
        let warm = |time: f64| 1.0 - 0.1 * (1.0 - (-time / 120.0_f64).exp());
        for point in &found.points {
            let friction = 0.4 + 0.1 * (-(point.velocity / 0.05).powi(2)).exp();
            let expected = warm(last) * friction + 0.5 * point.velocity;
            assert!((point.volts - expected).abs() < 1.5e-3, "{point:?} {expected}");
        }
        let change = found.change.unwrap();
        assert!((change - (warm(last) / warm(50.0) - 1.0)).abs() < 0.01, "{change}");
    }

    #[test]
    fn what_does_not_drift_stays_as_it_is() {
        let points = measured(0.0);
        assert_eq!(now(&points), Drift { points: points.clone(), change: None });
    }
}
