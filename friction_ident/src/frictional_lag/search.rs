//! The search over `ln v_s` and `ln tau`, the other three projected out.

use friction_model::Unit;
use nalgebra::{Matrix2, Matrix3, Matrix5, Vector2, Vector3};

use super::pass::{Prepared, Sums};
use super::start::start;
use super::{LagFit, LagValues};
use crate::IdentError;
use crate::estimate::{Doubt, Estimate, Estimates, Interval, IntervalMethod, Verdict};
use crate::finite::finite;
use crate::residual_whiteness::effective_share;
use crate::statistics::student_95;

/// Passes at most.
const PATIENCE: usize = 60;
/// Step of the logarithms that no longer counts.
const SMALL: f64 = 1e-7;
/// Rounding of the sum of squares, as a share of the torque's own.
const ROUNDING: f64 = 1e-13;
/// Longest step of the logarithms.
const LONGEST: f64 = 1.0;

/// What the sums say at one point.
struct Point {
    /// `f_c`, dip, `f_v`, less the baseline.
    linear: Vector3<f64>,
    /// Sum of squares.
    sum: f64,
    /// Sensitivities of the linear unknowns to the logarithms, and the projected normal equations.
    tilt: [Vector3<f64>; 2],
    normal: Matrix2<f64>,
    gradient: Vector2<f64>,
    sums: Sums,
}

impl Point {
    /// `None` where the three linear unknowns cannot be told apart.
    fn new(sums: Sums) -> Option<Self> {
        let matrix = Matrix3::from_fn(|i, j| sums.linear[i][j]);
        // Scaled to a unit diagonal.
        let root = matrix.diagonal().map(f64::sqrt);
        let scaled = Matrix3::from_fn(|i, j| matrix[(i, j)] / (root[i] * root[j]));
        let factor = finite(scaled)?.cholesky()?;
        let solve =
            |right: Vector3<f64>| factor.solve(&right.component_div(&root)).component_div(&root);
        let torque = Vector3::from(sums.torque);
        let linear = solve(torque);
        if !linear.iter().all(|x| x.is_finite()) {
            return None;
        }
        let sum = (sums.yy - linear.dot(&torque)).max(0.0);
        let by = sums.by.map(Vector3::from);
        let tilt = by.map(solve);
        let dip = linear[1];
        let normal = Matrix2::from_fn(|i, j| dip * dip * (sums.by_by[i][j] - by[i].dot(&tilt[j])));
        let gradient = Vector2::from_fn(|i, _| dip * (sums.by_torque[i] - by[i].dot(&linear)));
        Some(Self { linear, sum, tilt, normal, gradient, sums })
    }
}

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

/// What helps where a parameter stays unknown.
pub(super) fn remedy(name: &str) -> &'static str {
    match name {
        "tau" => {
            "vary the velocity faster through the Stribeck velocity, average more runs, or use a finer torque sensor"
        }
        "f_v" => "include higher speeds",
        _ => {
            "include speeds from well below to well above the Stribeck velocity, and average more runs"
        }
    }
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

/// Errors from the sums of the last pass, and verdicts.
fn estimates(
    data: &Prepared,
    point: &Point,
    values: &LagValues,
    x: Vector2<f64>,
    sum: f64,
    share: f64,
) -> Estimates {
    let Sums { linear, by, by_by, .. } = &point.sums;
    let dip = point.linear[1];
    // Unknowns f_c, dip, f_v, v_s, tau.
    let scale = [dip / values.v_s, dip / values.tau];
    let normal = Matrix5::from_fn(|i, j| match (i < 3, j < 3) {
        (true, true) => linear[i][j],
        (false, true) => scale[i - 3] * by[i - 3][j],
        (true, false) => scale[j - 3] * by[j - 3][i],
        (false, false) => scale[i - 3] * scale[j - 3] * by_by[i - 3][j - 3],
    });
    let variance = sum / data.samples().saturating_sub(5).max(1) as f64 / share;
    let degrees = ((data.samples() as f64 * share) as usize).saturating_sub(5);
    let root = normal.diagonal().map(f64::sqrt);
    let inverse = Matrix5::from_fn(|i, j| normal[(i, j)] / (root[i] * root[j]))
        .try_inverse()
        .filter(|inverse| inverse.diagonal().iter().all(|x| x.is_finite() && *x > 0.0));
    // f_s = f_c + dip; the order of the parameters is f_s, f_c, v_s, f_v, tau.
    let mut turn = Matrix5::zeros();
    for (row, column) in [(0, 0), (0, 1), (1, 0), (2, 3), (3, 2), (4, 4)] {
        turn[(row, column)] = 1.0;
    }
    let covariance = inverse.map(|inverse| {
        let plain = Matrix5::from_fn(|i, j| variance * inverse[(i, j)] / (root[i] * root[j]));
        turn * plain * turn.transpose()
    });
    let spread = covariance.map(|covariance| covariance.diagonal().map(|x| x.max(0.0).sqrt()));
    let factor = student_95(degrees);
    // Error of the dip itself: without it v_s and tau mean nothing.
    let dip_error = covariance.map(|c| (c[(0, 0)] + c[(1, 1)] - 2.0 * c[(0, 1)]).max(0.0).sqrt());
    let no_dip = dip_error.is_none_or(|error| dip < 3.0 * error || error.is_nan());
    let rotary = |unit: Unit| unit.rotary();
    let rows = [
        ("f_s", rotary(Unit::Force), values.f_s),
        ("f_c", rotary(Unit::Force), values.f_c),
        ("v_s", rotary(Unit::Speed), values.v_s),
        ("f_v", rotary(Unit::Damping), values.f_v),
        ("tau", rotary(Unit::Time), values.tau),
    ];
    let parameters = rows
        .into_iter()
        .enumerate()
        .map(|(i, (name, unit, value))| {
            let error = spread.map(|spread| spread[i]);
            let relative_error = error.map_or(f64::INFINITY, |error| error / value.abs());
            let bound = match name {
                "v_s" => Some((x[0], data.range(0))),
                "tau" => Some((x[1], data.range(1))),
                _ => None,
            };
            let doubt = if no_dip && ["f_s", "v_s", "tau"].contains(&name) {
                Some(Doubt::BelowNoise {
                    effect: dip,
                    standard_error: dip_error.unwrap_or(f64::INFINITY),
                })
            } else if bound.is_some_and(|(x, (low, high))| x <= low || x >= high) {
                Some(Doubt::AtBound { bound: value })
            } else if relative_error > 0.5 || relative_error.is_nan() {
                Some(Doubt::LargeError { relative_error })
            } else {
                None
            };
            let interval = error.map(|error| Interval {
                low: value - factor * error,
                high: value + factor * error,
                method: IntervalMethod::Linearised,
            });
            let verdict = doubt.map_or(Verdict::Identified, |doubt| Verdict::NotIdentifiable {
                doubt,
                remedy: remedy(name),
            });
            Estimate { id: name.into(), unit, value, standard_error: error, interval, verdict }
        })
        .collect();
    let covariance = covariance.unwrap_or_else(Matrix5::zeros);
    let rows_of = |matrix: Matrix5<f64>| -> Vec<Vec<f64>> {
        matrix.row_iter().map(|row| row.iter().copied().collect()).collect()
    };
    let correlation = Matrix5::from_fn(|i, j| {
        let both = (covariance[(i, i)] * covariance[(j, j)]).sqrt();
        if i == j {
            1.0
        } else if both > 0.0 {
            covariance[(i, j)] / both
        } else {
            0.0
        }
    });
    Estimates {
        parameters,
        correlation: rows_of(correlation),
        covariance: rows_of(covariance),
        residual_deviation: variance.sqrt(),
        degrees_of_freedom: degrees,
    }
}
