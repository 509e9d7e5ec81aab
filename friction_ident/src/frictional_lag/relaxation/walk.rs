//! The search: Levenberg and Marquardt's on the sums of a pass, within bounds.

use nalgebra::{SMatrix, SVector};

use crate::finite::finite;

use super::simulation::{Normal, Trial, UNKNOWNS};

/// Passes at most.
const PATIENCE: usize = 60;
/// Relative step that no longer counts.
const SMALL: f64 = 1e-8;
/// Rounding of the sum of squares, as a share of the torque's own.
const ROUNDING: f64 = 1e-13;
/// Longest step of the logarithms.
const LONGEST: f64 = 1.0;
/// Fall of the sum of squares, in variances of the residual, below which a step is made without
/// another pass: a fifth of a standard error, of which the step leaves a hundredth or so.
const WORTH: f64 = 0.05;

pub(super) type Vector = SVector<f64, UNKNOWNS>;

/// Where the search ended: the last pass, and the step from there that was too small for another
/// one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Found {
    pub normal: Normal,
    pub x: [f64; UNKNOWNS],
    pub step: Vector,
    pub held: [bool; UNKNOWNS],
}

/// Downhill from `start` within `bounds` (lowest and highest value of each unknown; equal ones hold
/// it). `pass` runs a trial; `usual` is the size of each unknown.
///
/// `None` where the start is not allowed.
pub(super) fn walk(
    start: Trial,
    bounds: &[(f64, f64); UNKNOWNS],
    usual: &[f64; UNKNOWNS],
    samples: usize,
    pass: &mut dyn FnMut(&Trial) -> Option<Normal>,
) -> Option<Found> {
    let mut trial = start;
    let mut here = pass(&trial)?;
    let degrees = samples.saturating_sub(UNKNOWNS).max(1) as f64;
    let mut mu = 0.0;
    let clipped = |x: &[f64; UNKNOWNS], step: &Vector| -> [f64; UNKNOWNS] {
        std::array::from_fn(|i| (x[i] + step[i]).max(bounds[i].0).min(bounds[i].1))
    };
    for _ in 0..PATIENCE {
        let mut held: [bool; UNKNOWNS] = std::array::from_fn(|i| {
            let (low, high) = bounds[i];
            let x = trial.x[i];
            low >= high
                || (x <= low && here.gradient[i] < 0.0)
                || (x >= high && here.gradient[i] > 0.0)
        });
        let mut step = damped(&here, &held, mu).unwrap_or_else(Vector::zeros);
        // A bound in the way holds its unknown; the others go on without it.
        for _ in 0..UNKNOWNS {
            let outwards = |i: usize| {
                (trial.x[i] <= bounds[i].0 && step[i] < 0.0)
                    || (trial.x[i] >= bounds[i].1 && step[i] > 0.0)
            };
            let blocked: [bool; UNKNOWNS] = std::array::from_fn(|i| !held[i] && outwards(i));
            if !blocked.contains(&true) {
                break;
            }
            held = std::array::from_fn(|i| held[i] || blocked[i]);
            step = damped(&here, &held, mu).unwrap_or_else(Vector::zeros);
        }
        let longest = step[2].abs().max(step[4].abs());
        let step = if longest > LONGEST { step * (LONGEST / longest) } else { step };
        let next = clipped(&trial.x, &step);
        let moved = Vector::from_fn(|i, _| next[i] - trial.x[i]);
        let fall = 2.0 * here.gradient.dot(&moved) - moved.dot(&(here.matrix * moved));
        let small = (0..UNKNOWNS).all(|i| moved[i].abs() < SMALL * usual[i]);
        let bent = (0..UNKNOWNS)
            .any(|i| !held[i] && moved[i] != step[i] && trial.x[i] + step[i] != next[i]);
        if small || !fall.is_finite() || (mu == 0.0 && !bent && fall < WORTH * here.sum / degrees) {
            let held = std::array::from_fn(|i| {
                held[i] || next[i] <= bounds[i].0 || next[i] >= bounds[i].1
            });
            return Some(Found { normal: here, x: trial.x, step: moved, held });
        }
        let there = Trial { x: next, ..trial };
        match pass(&there) {
            // On exact data only rounding is left of the sum.
            Some(normal) if normal.sum <= here.sum + ROUNDING * here.scale => {
                (trial, here) = (there, normal);
                mu = if mu > 1e-3 { 0.1 * mu } else { 0.0 };
            }
            _ => mu = (4.0 * mu).max(0.1),
        }
    }
    Some(Found { normal: here, x: trial.x, step: Vector::zeros(), held: [false; UNKNOWNS] })
}

/// Solves the normal equations of the unknowns that are not held, scaled to a unit diagonal.
fn damped(here: &Normal, held: &[bool; UNKNOWNS], mu: f64) -> Option<Vector> {
    let root = Vector::from_fn(|i, _| if held[i] { 1.0 } else { here.matrix[(i, i)].sqrt() });
    let matrix = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::from_fn(|i, j| {
        if i == j {
            1.0 + mu
        } else if held[i] || held[j] {
            0.0
        } else {
            here.matrix[(i, j)] / (root[i] * root[j])
        }
    });
    let right = Vector::from_fn(|i, _| if held[i] { 0.0 } else { here.gradient[i] / root[i] });
    let step = finite(matrix)?.cholesky()?.solve(&right).component_div(&root);
    step.iter().all(|d| d.is_finite()).then_some(step)
}
