//! Which speed next: the one that adds most information (D-optimal), averaged over the Stribeck
//! velocities that are still possible.
//!
//! The curve is linear in all parameters but `v_s`, so that only `v_s` decides what a speed tells.
//! With `g(v)` the curve's gradient and `M` the sum of `g g'` over the blocks so far, a block at `v`
//! adds `log det(1 + g' M^-1 g)`. Where intervals are wanted of some
//! parameters only, the gain that is told is how much the worst of these would shrink.

use nalgebra::{Matrix4, Vector4};

use super::{Curve, Point};
use crate::friction::wanted::{CurveParameter, Wanted};

/// Stribeck velocities beyond this factor from the best one are not believed.
const FARTHEST: f64 = 3.0;
/// Information of a faint guess, as a share of what a point at the fastest speed gives: it keeps
/// the matrix from being singular.
const RIDGE: f64 = 1e-9;

/// The next block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Choice {
    /// Its speed [rad/s].
    pub velocity: f64,
    /// By which share the worst wanted interval shrinks, as predicted; of all speeds the best.
    pub gain: f64,
}

/// Chooses among the speeds of `menu`.
pub(super) fn next(curve: &Curve, points: &[Point], wanted: &Wanted, menu: &[f64]) -> Choice {
    let possible = possible(curve, menu);
    let mut best = Choice { velocity: menu[0], gain: 0.0 };
    let mut most = f64::NEG_INFINITY;
    let mut gain: f64 = 0.0;
    for &velocity in menu {
        let told = possible.iter().map(|&v_s| information(points, v_s, velocity)).sum::<f64>();
        if told > most {
            (most, best.velocity) = (told, velocity);
        }
        gain = gain.max(shrinking(curve, points, wanted, velocity));
    }
    best.gain = gain;
    best
}

/// The best Stribeck velocity and the ends of its interval.
fn possible(curve: &Curve, menu: &[f64]) -> [f64; 3] {
    let best = if curve.dips { curve.v_s.value } else { menu[menu.len() / 3] };
    let within =
        |end: Option<f64>, open: f64| end.unwrap_or(open).clamp(best / FARTHEST, best * FARTHEST);
    [within(curve.v_s.low, 0.0), best, within(curve.v_s.high, f64::INFINITY)]
}

/// Gradient by `f_s`, `f_c`, `v_s` in units of the dip, and slope.
fn gradient(velocity: f64, v_s: f64) -> Vector4<f64> {
    let ratio = (velocity / v_s).powi(2);
    let dip = (-ratio).exp();
    Vector4::new(dip, 1.0 - dip, 2.0 * dip * ratio / v_s, velocity)
}

fn sum(points: &[Point], v_s: f64) -> Matrix4<f64> {
    let fastest = points.iter().map(|point| point.velocity).fold(0.0, f64::max);
    let one = gradient(fastest, v_s).norm_squared();
    let faint = Matrix4::identity() * (RIDGE * one);
    points.iter().fold(faint, |sum, point| {
        let g = gradient(point.velocity, v_s);
        sum + g * g.transpose()
    })
}

/// `log det` of what a block at `velocity` adds.
fn information(points: &[Point], v_s: f64, velocity: f64) -> f64 {
    let g = gradient(velocity, v_s);
    let Some(inverse) = sum(points, v_s).try_inverse() else { return 0.0 };
    (g.transpose() * inverse * g)[0].ln_1p()
}

/// The share by which a block at `velocity` narrows the worst of the wanted intervals.
fn shrinking(curve: &Curve, points: &[Point], wanted: &Wanted, velocity: f64) -> f64 {
    let missing = wanted.missing(curve);
    let Some((worst, _)) = missing.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1)) else {
        return 0.0;
    };
    let index = match worst {
        CurveParameter::FS => 0,
        CurveParameter::FC => 1,
        CurveParameter::VS => 2,
        CurveParameter::Slope => 3,
    };
    let before = sum(points, curve.v_s.value);
    let g = gradient(velocity, curve.v_s.value);
    let after = before + g * g.transpose();
    match (before.try_inverse(), after.try_inverse()) {
        (Some(before), Some(after)) => {
            1.0 - (after[(index, index)] / before[(index, index)]).max(0.0).sqrt()
        }
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Ranged;

    fn curve(v_s: Ranged) -> Curve {
        let known = |value: f64| Ranged::new(value, 0.99 * value, 1.01 * value);
        Curve {
            f_s: known(0.5),
            f_c: known(0.45),
            v_s,
            slope: known(0.7),
            dips: true,
            deviation: 0.01,
            one_way: 0.0,
        }
    }

    fn points(velocities: &[f64]) -> Vec<Point> {
        let point = |velocity: &f64| Point {
            velocity: *velocity,
            volts: 1.0,
            one_way: 0.0,
            uneven: 0.0,
            time: 0.0,
        };
        velocities.iter().map(point).collect()
    }

    const MENU: [f64; 6] = [0.02, 0.05, 0.1, 0.2, 1.0, 4.0];

    #[test]
    fn what_was_never_measured_is_chosen() {
        let v_s = Ranged::new(0.1, 0.05, 0.2);
        let many = |left: f64| -> Vec<f64> {
            MENU.iter().filter(|v| **v != left).flat_map(|v| [*v; 8]).collect()
        };
        let fast = next(&curve(v_s), &points(&many(4.0)), &Wanted::default(), &MENU);
        assert_eq!(fast.velocity, 4.0);
        let slow = next(&curve(v_s), &points(&many(0.02)), &Wanted::default(), &MENU);
        assert_eq!(slow.velocity, 0.02);
    }

    #[test]
    fn another_block_gains_less_the_more_there_are() {
        let v_s = Ranged::new(0.1, 0.05, 0.2);
        let gain = |times: usize| {
            let all: Vec<f64> = (0..times).flat_map(|_| MENU).collect();
            next(&curve(v_s), &points(&all), &Wanted::default(), &MENU).gain
        };
        assert!(gain(2) > 0.05 && gain(400) < 0.01, "{} {}", gain(2), gain(400));
        let met =
            next(&curve(Ranged::new(0.1, 0.099, 0.101)), &points(&MENU), &Wanted::default(), &MENU);
        assert_eq!(met.gain, 0.0);
    }
}
