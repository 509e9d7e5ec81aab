//! Intervals of the nonlinear parameters from the profile of the sum of squares.
//!
//! A value belongs to the 95 % interval while the best sum of squares with the parameter kept there
//! stays below a limit (Bates and Watts 1988, chapter 6): where the model is straight, the interval
//! is then that of the parameter's robust error and Student's quantile.

use super::search::{Best, Search};
use super::shape::{Shape, ShapeTerm};
use crate::estimate::{Doubt, Estimate, Estimates, Interval, IntervalMethod, Verdict};

/// Secant steps for each end, at most.
const REFINEMENTS: usize = 12;
/// How near the limit an end must lie, as a share of the half width.
const CLOSE: f64 = 0.01;

/// Replaces the linearised intervals of the nonlinear parameters. `rises` says how far the sum of
/// squares may rise within the interval of each parameter.
pub(super) fn intervals(
    search: &mut Search,
    best: &Best,
    rises: &[f64],
    estimates: &mut Estimates,
) {
    let least = best.solution.residual.norm_squared();
    let terms = ShapeTerm::of(&search.structure);
    let first = estimates.parameters.len().saturating_sub(terms.len());
    let nonlinear = estimates.parameters[first..].iter_mut().zip(&rises[first..]);
    for (term, (estimate, rise)) in terms.into_iter().zip(nonlinear) {
        // Without an error of its own the interval has no end.
        if !rise.is_finite() {
            continue;
        }
        let limit = least + rise.max(1e-12 * least);
        let low = end(search, best, term, estimate, limit, false);
        let high = end(search, best, term, estimate, limit, true);
        let open = low.is_none() || high.is_none();
        let none = if term == ShapeTerm::Delay { f64::NEG_INFINITY } else { 0.0 };
        let (low, high) = (low.unwrap_or(none), high.unwrap_or(f64::INFINITY));
        estimate.interval = Some(Interval { low, high, method: IntervalMethod::Profile });
        if let (true, Verdict::Identified) = (open, &estimate.verdict) {
            let remedy = "a motion in which the effect is larger against the rest of the residual";
            estimate.verdict = Verdict::NotIdentifiable { doubt: Doubt::OpenInterval, remedy };
        }
    }
}

/// Where the profile crosses the limit on one side; none where it never does within the bounds.
fn end(
    search: &mut Search,
    best: &Best,
    term: ShapeTerm,
    estimate: &Estimate,
    limit: f64,
    up: bool,
) -> Option<f64> {
    let wall = if up { term.value(&search.limits.high) } else { term.value(&search.limits.low) };
    let centre = term.value(&best.shape);
    let mut last: Shape = best.shape;
    let least = best.solution.residual.norm_squared();
    // The root of the rise over its limit: about proportional to the distance, so that secants
    // arrive quickly.
    let mut rise = |value: f64| {
        let mut start = last;
        term.set(&mut start, value);
        match search.from(start, &[term]) {
            Ok(found) => {
                last = found.shape;
                let over = found.solution.residual.norm_squared() - least;
                over.max(0.0).sqrt() / (limit - least).sqrt() - 1.0
            }
            Err(_) => f64::INFINITY,
        }
    };
    let usual = estimate.standard_error.filter(|error| *error > 0.0).unwrap_or(0.1 * centre.abs());
    let mut step = 2.0 * usual.max(1e-6 * wall.abs().max(centre.abs()));
    let mut inside = (centre, -1.0);
    let mut outside = loop {
        let trial = if up { (inside.0 + step).min(wall) } else { (inside.0 - step).max(wall) };
        let over = rise(trial);
        if over > 0.0 {
            break (trial, over);
        }
        if trial == wall {
            return None;
        }
        (inside, step) = ((trial, over), 2.0 * step);
    };
    for _ in 0..REFINEMENTS {
        if inside.1.abs() < CLOSE || outside.1.abs() < CLOSE {
            break;
        }
        let share = (inside.1 / (inside.1 - outside.1)).clamp(0.05, 0.95);
        let middle = inside.0 + share * (outside.0 - inside.0);
        let over = rise(middle);
        if over > 0.0 { outside = (middle, over) } else { inside = (middle, over) }
    }
    Some(if inside.1.abs() < outside.1.abs() { inside.0 } else { outside.0 })
}
