//! Curves that fit as well.
//!
//! A curve has its shape by assumption. Others of the same kind, with a dip elsewhere, a steeper one
//! or none, may fit the points as well: an interval then reaches to what these say too. A curve is as
//! good where its squares are within Student's quantile of the chosen one's, as for one parameter more
//! (the profile of the likelihood; Seber and Wild 2003, section 5.9.3).
//!
//! What nobody measured has no interval: the bottom of a dip below the slowest speed that the shaft
//! followed.

use friction_ident::statistics::student_95;
use nalgebra::{DMatrix, DVector};

use super::Point;
use super::curve::{Curve, SLOW};
use crate::Ranged;

/// Ratio of two Stribeck velocities that are tried.
const RATIO: f64 = 1.08;
/// The lowest that is tried, over the slowest speed.
const LOWEST: f64 = 0.5;
/// Shapes of the dip that are tried: Tustin's and the Gaussian one (Armstrong-Helouvry 1991).
const SHAPES: [f64; 2] = [1.0, 2.0];
/// Parameters of a curve.
const PARAMETERS: usize = 4;

/// A curve as good.
struct Rival {
    f_s: f64,
    f_c: f64,
    v_s: f64,
    slope: f64,
    shape: f64,
    squares: f64,
}

/// The curve with intervals that reach to what its rivals say, of a rig that can turn as fast as
/// `able` [rad/s].
pub(super) fn reaching(curve: Curve, points: &[Point], able: f64) -> Curve {
    let Some(free) = points.len().checked_sub(PARAMETERS).filter(|free| *free > 0) else {
        return curve;
    };
    let own: f64 = points.iter().map(|p| (p.volts - curve.volts(p.velocity)).powi(2)).sum();
    let allowed = own * (1.0 + student_95(free).powi(2) / free as f64);
    let rivals: Vec<Rival> =
        rivals(points, able).into_iter().filter(|rival| rival.squares <= allowed).collect();
    let reach = |ranged: Ranged, of: fn(&Rival) -> f64, counts: fn(&Rival) -> bool| {
        let said = || rivals.iter().filter(|rival| counts(rival)).map(of);
        Ranged {
            low: ranged.low.map(|low| said().fold(low, f64::min)),
            high: ranged.high.map(|high| said().fold(high, f64::max)),
            ..ranged
        }
    };
    let all: fn(&Rival) -> bool = |_| true;
    let mut curve = Curve {
        f_c: reach(curve.f_c, |rival| rival.f_c, all),
        slope: reach(curve.slope, |rival| rival.slope, all),
        f_s: reach(curve.f_s, |rival| rival.f_s, all),
        // Another shape has another velocity.
        v_s: reach(curve.v_s, |rival| rival.v_s, |rival| rival.shape == 2.0),
        ..curve
    };
    let slowest = points.iter().map(|point| point.velocity).fold(f64::INFINITY, f64::min);
    if curve.dips && slowest > curve.v_s.value {
        let open = |ranged: Ranged| Ranged { low: None, high: None, ..ranged };
        (curve.f_s, curve.v_s) = (open(curve.f_s), open(curve.v_s));
    }
    curve
}

/// All that are tried and are friction.
fn rivals(points: &[Point], able: f64) -> Vec<Rival> {
    let slowest = points.iter().map(|point| point.velocity).fold(f64::INFINITY, f64::min);
    let fastest = points.iter().map(|point| point.velocity).fold(able, f64::max);
    let mut all = Vec::new();
    let mut v_s = LOWEST * slowest;
    while v_s < SLOW * fastest {
        all.extend(SHAPES.iter().filter_map(|shape| rival(points, v_s, *shape)));
        v_s *= RATIO;
    }
    all
}

/// The best curve of that Stribeck velocity and shape; none where it is no friction.
fn rival(points: &[Point], v_s: f64, shape: f64) -> Option<Rival> {
    let row = |point: &Point| {
        let dip = (-(point.velocity / v_s).powf(shape)).exp();
        [1.0, dip, point.velocity]
    };
    let matrix = DMatrix::from_row_iterator(points.len(), 3, points.iter().flat_map(row));
    let volts = DVector::from_iterator(points.len(), points.iter().map(|point| point.volts));
    let found = matrix.clone().svd(true, true).solve(&volts, 1e-9).ok()?;
    let squares = (&matrix * &found - &volts).norm_squared();
    let (f_c, dip, slope) = (found[0], found[1], found[2]);
    let is_friction = f_c > 0.0 && dip >= 0.0 && slope > 0.0;
    is_friction.then_some(Rival { f_s: f_c + dip, f_c, v_s, slope, shape, squares })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(speeds: &[f64]) -> Vec<Point> {
        let one = |i: usize| {
            let velocity = speeds[i % speeds.len()];
            let volts = 0.4 + 0.1 * (-(velocity / 0.5_f64).powi(2)).exp() + 0.6 * velocity;
            let scatter = 1e-3 * (i as f64 * 2.4).sin();
            Point { velocity, volts: volts + scatter, one_way: 0.0, uneven: 0.0, time: 0.0 }
        };
        (0..4 * speeds.len()).map(one).collect()
    }

    /// A short travel keeps the speeds below the end of the dip: the straight line fits, and is wrong.
    #[test]
    fn where_a_dip_may_end_beyond_the_fastest_speed_the_interval_says_so() {
        let slow = points(&[0.01, 0.02, 0.03, 0.05, 0.08, 0.12]);
        let straight = Curve::straight(&slow).unwrap();
        assert!(!straight.f_c.holds(0.4), "{straight:?}");
        let found = reaching(straight, &slow, 10.0);
        assert!(found.f_c.holds(0.4) && found.slope.holds(0.6), "{found:?}");
        // Where the rig can turn no faster, there is none.
        assert_eq!(reaching(straight, &slow, 0.0).f_c, straight.f_c);
    }

    #[test]
    fn the_bottom_of_a_dip_below_the_slowest_speed_has_no_interval() {
        let whole = points(&[0.05, 0.1, 0.3, 0.5, 0.8, 1.2, 2.0, 4.0]);
        let curve = reaching(Curve::of(&whole, 0.0).unwrap(), &whole, 0.0);
        assert!(curve.f_s.holds(0.5) && curve.f_s.relative().unwrap() < 0.1, "{curve:?}");
        let tail = points(&[0.55, 0.6, 0.7, 0.9, 1.2, 2.0, 4.0]);
        let seen = Curve::of(&tail, 0.0).unwrap();
        let curve =
            reaching(Curve { dips: true, v_s: Ranged::new(0.5, 0.4, 0.6), ..seen }, &tail, 0.0);
        assert_eq!((curve.f_s.low, curve.v_s.high), (None, None));
    }
}
