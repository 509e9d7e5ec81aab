//! The fit's errors, from the sums of the last pass, and verdicts.

use friction_model::Unit;
use nalgebra::{Matrix5, Vector2};

use super::LagValues;
use super::pass::{Prepared, Sums};
use super::point::Point;
use crate::estimate::{Doubt, Estimate, Estimates, Interval, IntervalMethod, Verdict};
use crate::statistics::student_95;

/// Errors from the sums of the last pass, and verdicts.
pub(super) fn estimates(
    data: &Prepared,
    point: &Point,
    values: &LagValues,
    x: Vector2<f64>,
    sum: f64,
    share: f64,
) -> Estimates {
    let dip = point.linear[1];
    let variance = sum / data.samples().saturating_sub(5).max(1) as f64 / share;
    let degrees = ((data.samples() as f64 * share) as usize).saturating_sub(5);
    let covariance = covariance(point, values, variance);
    let spread = covariance.map(|covariance| covariance.diagonal().map(|x| x.max(0.0).sqrt()));
    let factor = student_95(degrees);
    // Error of the dip itself: without it v_s and tau mean nothing.
    let dip_error = covariance.map(|c| (c[(0, 0)] + c[(1, 1)] - 2.0 * c[(0, 1)]).max(0.0).sqrt());
    let no_dip = dip_error.is_none_or(|error| dip < 3.0 * error || error.is_nan());
    let rows = [
        ("f_s", Unit::Force.rotary(), values.f_s),
        ("f_c", Unit::Force.rotary(), values.f_c),
        ("v_s", Unit::Speed.rotary(), values.v_s),
        ("f_v", Unit::Damping.rotary(), values.f_v),
        ("tau", Unit::Time.rotary(), values.tau),
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

/// Covariance of f_s, f_c, v_s, f_v and tau; none where the sums do not tell them apart.
fn covariance(point: &Point, values: &LagValues, variance: f64) -> Option<Matrix5<f64>> {
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
    let root = normal.diagonal().map(f64::sqrt);
    let inverse = Matrix5::from_fn(|i, j| normal[(i, j)] / (root[i] * root[j]))
        .try_inverse()
        .filter(|inverse| inverse.diagonal().iter().all(|x| x.is_finite() && *x > 0.0))?;
    // f_s = f_c + dip.
    let mut turn = Matrix5::zeros();
    for (row, column) in [(0, 0), (0, 1), (1, 0), (2, 3), (3, 2), (4, 4)] {
        turn[(row, column)] = 1.0;
    }
    let plain = Matrix5::from_fn(|i, j| variance * inverse[(i, j)] / (root[i] * root[j]));
    Some(turn * plain * turn.transpose())
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
