//! How the curve depends on each of its speeds.
//!
//! Where a curve misses the friction at a speed, all blocks near that speed miss it alike, and their
//! scatter says nothing of it. So the parameters are told without the blocks of one speed, for each
//! speed in turn: the jackknife over groups (Efron and Tibshirani 1993, eq. 11.5), with Student's
//! quantile for as many groups as are left of the parameters.

use friction_ident::statistics::student_95;

use super::Point;
use super::curve::Curve;
use crate::Ranged;

/// Ratio of speeds up to which blocks are of one group.
const ALIKE: f64 = 1.25;
/// Parameters of a curve.
const PARAMETERS: usize = 4;

/// Groups of points of speeds that are alike.
fn groups(points: &[Point]) -> Vec<Vec<usize>> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|a, b| points[*a].velocity.total_cmp(&points[*b].velocity));
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut begins = f64::NEG_INFINITY;
    for index in order {
        let velocity = points[index].velocity;
        if velocity > ALIKE * begins || begins < 0.0 {
            begins = velocity;
            groups.push(Vec::new());
        }
        if let Some(group) = groups.last_mut() {
            group.push(index);
        }
    }
    groups
}

/// The curve with intervals that are at least as wide as the spread over its speeds. `fitted` says
/// the curve of some of the points.
pub(super) fn widened(
    curve: Curve,
    points: &[Point],
    fitted: impl Fn(&[Point]) -> Option<Curve>,
) -> Curve {
    let groups = groups(points);
    let Some(free) = groups.len().checked_sub(PARAMETERS).filter(|free| *free > 0) else {
        return curve;
    };
    let without = |group: &Vec<usize>| {
        let kept = |(i, point): (usize, &Point)| (!group.contains(&i)).then_some(*point);
        let points: Vec<Point> = points.iter().enumerate().filter_map(kept).collect();
        fitted(&points)
    };
    let curves: Vec<Option<Curve>> = groups.iter().map(without).collect();
    let n = groups.len() as f64;
    let spread = |of: fn(&Curve) -> Ranged| {
        let values: Vec<f64> = curves
            .iter()
            .flatten()
            .map(|curve| of(curve).value)
            .filter(|v| v.is_finite())
            .collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let squares = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
        let half = student_95(free) * (squares * (n - 1.0) / n).sqrt();
        let own = of(&curve);
        Ranged {
            low: own.low.map(|low| low.min(own.value - half)),
            high: own.high.map(|high| high.max(own.value + half)),
            ..own
        }
    };
    Curve {
        f_s: spread(|curve| curve.f_s),
        f_c: spread(|curve| curve.f_c),
        v_s: if curve.dips { spread(|curve| curve.v_s) } else { curve.v_s },
        slope: spread(|curve| curve.slope),
        ..curve
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_speed_that_misses_the_curve_widens_the_intervals() {
        let speeds = [0.02, 0.04, 0.08, 0.16, 0.32, 0.64, 1.28, 2.56];
        let points = |wrong: f64| -> Vec<Point> {
            (0..40)
                .map(|i| {
                    let velocity = speeds[i % 8];
                    let scatter = 1e-3 * (i as f64 * 2.4).sin();
                    let miss = if i % 8 == 4 { wrong } else { 0.0 };
                    let volts = 0.4 + 0.5 * velocity + scatter + miss;
                    Point { velocity, volts, one_way: 0.0, uneven: 0.0, time: 0.0 }
                })
                .collect()
        };
        let half = |wrong: f64| {
            let points = points(wrong);
            let curve = Curve::straight(&points).unwrap();
            let wide = widened(curve, &points, Curve::straight);
            wide.f_c.relative().unwrap() / curve.f_c.relative().unwrap()
        };
        assert!(half(0.05) > 1.5 * half(0.0), "{} {}", half(0.0), half(0.05));
    }
}
