//! The search over `ln v_s` and `ln tau`, the other three projected out.

use nalgebra::Vector2;

use super::estimates::estimates;
use super::pass::Prepared;
use super::point::Point;
use super::start::start;
use super::{LagFit, LagValues};
use crate::IdentError;
use crate::finite::finite;
use crate::residual_whiteness::effective_share;

/// Passes at most.
const PATIENCE: usize = 60;
/// Step of the logarithms that no longer counts.
const SMALL: f64 = 1e-7;
/// Rounding of the sum of squares, as a share of the torque's own.
const ROUNDING: f64 = 1e-13;
/// Longest step of the logarithms.
const LONGEST: f64 = 1.0;

/// Evaluates points, counts passes.
struct Walker<'a> {
    data: &'a Prepared,
    scratch: Vec<[f64; 2]>,
    passes: usize,
}

impl<'a> Walker<'a> {
    fn new(data: &'a Prepared) -> Self {
        let longest =
            data.recordings.iter().map(|recording| recording.speed.len()).max().unwrap_or(0);
        Self { data, scratch: Vec::with_capacity(longest), passes: 0 }
    }

    fn at(&mut self, x: &Vector2<f64>) -> Option<Point> {
        self.passes += 1;
        Point::new(self.data.pass(x[0], x[1], &mut self.scratch))
    }
}

/// Walks downhill over the logarithms in `free`. Returns the last point, where it lies, and the
/// step from there that was too small to be worth another pass.
fn walk(
    walker: &mut Walker,
    start: Vector2<f64>,
    free: [bool; 2],
) -> Option<(Point, Vector2<f64>, Vector2<f64>)> {
    let data = walker.data;
    let ranges = [data.range(0), data.range(1)];
    let within = |x: Vector2<f64>| Vector2::from_fn(|i, _| x[i].max(ranges[i].0).min(ranges[i].1));
    let mut x = within(start);
    let mut here = walker.at(&x)?;
    let mut mu = 0.0;
    let degrees = data.samples().saturating_sub(5).max(1) as f64;
    for _ in 0..PATIENCE {
        let mut normal = here.normal;
        let mut gradient = here.gradient;
        for i in 0..2 {
            // A bound that holds, or a logarithm that was given.
            let held = !free[i]
                || (x[i] <= ranges[i].0 && gradient[i] < 0.0)
                || (x[i] >= ranges[i].1 && gradient[i] > 0.0);
            if held {
                (normal[(i, 1 - i)], normal[(1 - i, i)], gradient[i]) = (0.0, 0.0, 0.0);
            }
            normal[(i, i)] = normal[(i, i)] * (1.0 + mu) + f64::MIN_POSITIVE;
        }
        let step = normal
            .try_inverse()
            .and_then(finite)
            .map_or(Vector2::zeros(), |inverse| inverse * gradient);
        let longest = step.amax();
        let step = if longest > LONGEST { step * (LONGEST / longest) } else { step };
        let next = within(x + step);
        let moved = next - x;
        // A thousandth of the standard error, or nothing at all.
        let worth = (moved.transpose() * here.normal * moved)[(0, 0)];
        if moved.amax() < SMALL
            || (worth < 1e-6 * here.sum / degrees && mu == 0.0)
            || !worth.is_finite()
        {
            return Some((here, x, moved));
        }
        match walker.at(&next) {
            // On exact data only rounding is left of the sum.
            Some(there) if there.sum <= here.sum + ROUNDING * here.sums.yy => {
                (x, here) = (next, there);
                mu = if mu > 1e-3 { 0.1 * mu } else { 0.0 };
            }
            _ => mu = (4.0 * mu).max(0.3),
        }
    }
    Some((here, x, Vector2::zeros()))
}

/// Least sum of squares with one logarithm held at `value`, and where the other one then lies.
pub(super) fn held(
    data: &Prepared,
    which: usize,
    value: f64,
    other: f64,
    passes: &mut usize,
) -> Option<(f64, f64)> {
    let mut walker = Walker::new(data);
    let start = if which == 0 { Vector2::new(value, other) } else { Vector2::new(other, value) };
    let (point, x, _) = walk(&mut walker, start, [which != 0, which != 1])?;
    *passes += walker.passes;
    Some((point.sum, x[1 - which]))
}

fn alike() -> IdentError {
    IdentError::NoConvergence("the recording shows no dip that can be told from the slope".into())
}

/// Values near the best ones: those of the coarse scan, after one pass.
pub(super) fn near(data: &Prepared) -> Result<LagValues, IdentError> {
    let x = start(data);
    let Point { linear, .. } = Walker::new(data).at(&x.into()).ok_or_else(alike)?;
    let [base_c, base_v] = data.baseline;
    let f_c = linear[0] + base_c;
    if f_c <= 0.0 {
        return Err(IdentError::NotFriction { f_c });
    }
    Ok(LagValues {
        f_s: f_c + linear[1],
        f_c,
        v_s: x[0].exp(),
        f_v: linear[2] + base_v,
        tau: x[1].exp(),
    })
}

/// The best fit. With `whiteness` the errors count neighbouring residuals that are alike as one,
/// which takes a pass and the autocorrelation of the residuals; the share of independent residuals
/// is returned too.
pub(super) fn fit(data: &Prepared, whiteness: bool) -> Result<(LagFit, f64), IdentError> {
    let mut walker = Walker::new(data);
    let first = start(data);
    let (point, x, step) = walk(&mut walker, first.into(), [true; 2]).ok_or_else(alike)?;
    // The last small step, without another pass.
    let linear =
        point.linear - (point.tilt[0] * step[0] + point.tilt[1] * step[1]) * point.linear[1];
    let x = x + step;
    let [base_c, base_v] = data.baseline;
    let values = LagValues {
        f_s: linear[0] + linear[1] + base_c,
        f_c: linear[0] + base_c,
        v_s: x[0].exp(),
        f_v: linear[2] + base_v,
        tau: x[1].exp(),
    };
    if values.f_c <= 0.0 {
        return Err(IdentError::NotFriction { f_c: values.f_c });
    }
    let samples = data.samples();
    let sum = (point.sum - step.dot(&point.gradient)).max(0.0);
    let share =
        if whiteness { effective_share(&data.residuals(x[0], x[1], linear.as_ref())) } else { 1.0 };
    let estimates = estimates(data, &point, &values, x, sum, share);
    Ok((
        LagFit { values, estimates, mse: sum / samples as f64, samples, passes: walker.passes },
        share,
    ))
}
