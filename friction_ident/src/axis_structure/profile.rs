//! Intervals of the nonlinear parameters from the profile of the sum of squares.
//!
//! A value belongs to the 95 % interval while the best sum of squares with the parameter kept there
//! stays below a limit (Bates and Watts 1988, chapter 6): where the model is straight, the interval
//! is then that of the parameter's robust error and Student's quantile.

use super::at_bound;
use super::left_out::Whole;
use super::search::{Best, Search};
use super::shape::{Shape, ShapeTerm};
use crate::estimate::{Doubt, Estimate, Estimates, Interval, IntervalMethod, Verdict};

/// Secant steps for each end, at most.
const REFINEMENTS: usize = 12;
/// How near the limit an end must lie, as a share of the half width.
const CLOSE: f64 = 0.03;
/// How exactly each sum is found, as a share of what the limit lies above the least.
const EXACT: f64 = 1e-3;
/// A straight step that takes off less than this share of the rise is as good as a search.
const SHORT: f64 = 0.1;
/// How far the logarithm of another parameter may be expected to move at once.
const LEAP: f64 = 0.5;

/// Replaces the linearised intervals of the nonlinear parameters, and says what helps at a bound.
/// `rises` says how far the sum of squares may rise within the interval of each parameter.
pub(super) fn intervals(
    search: &mut Search,
    best: &Best,
    whole: &Whole,
    rises: &[f64],
    estimates: &mut Estimates,
) {
    let least = best.solution.residual.norm_squared();
    let terms = ShapeTerm::of(&search.structure);
    let first = estimates.parameters.len().saturating_sub(terms.len());
    at_bound::remedies(&terms, &search.limits, &mut estimates.parameters[first..]);
    let nonlinear = estimates.parameters[first..].iter_mut().zip(&rises[first..]);
    for (term, (estimate, rise)) in terms.into_iter().zip(nonlinear) {
        // Without an error of its own the interval has no end.
        if !rise.is_finite() {
            continue;
        }
        let limit = least + rise.max(1e-12 * least);
        let profile = Profile { best, way: whole.along(term), term, limit };
        let low = profile.end(search, estimate, false);
        let high = profile.end(search, estimate, true);
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

/// The sum of squares as one parameter moves and the others follow.
struct Profile<'a> {
    best: &'a Best,
    /// Derivative of the other nonlinear parameters' unknowns with respect to its own.
    way: Vec<(ShapeTerm, f64)>,
    term: ShapeTerm,
    limit: f64,
}

impl Profile<'_> {
    /// Where the others are likely to be when it goes from its place in `last` to `value`.
    fn start(&self, last: &Shape, value: f64) -> Shape {
        let moved = self.term.unknown(value) - self.term.unknown(self.term.value(last));
        let mut start = *last;
        for (other, slope) in &self.way {
            let unknown = other.unknown(other.value(last));
            let reach = if *other == ShapeTerm::Delay { f64::INFINITY } else { LEAP };
            other.set(&mut start, other.natural(unknown + (slope * moved).clamp(-reach, reach)));
        }
        self.term.set(&mut start, value);
        start
    }

    /// Where it crosses the limit on one side; none where it never does within the bounds.
    fn end(&self, search: &mut Search, estimate: &Estimate, up: bool) -> Option<f64> {
        let Self { best, term, limit, .. } = *self;
        let wall =
            if up { term.value(&search.limits.high) } else { term.value(&search.limits.low) };
        let centre = term.value(&best.shape);
        let mut last: Shape = best.shape;
        let least = best.solution.residual.norm_squared();
        let enough = EXACT * (limit - least) / least;
        // The root of the rise over its limit: about proportional to the distance, so that secants
        // arrive quickly.
        let mut rise = |value: f64| {
            let start = self.start(&last, value);
            let step = search.stepped(start, &[term]);
            let sum = match step.filter(|step| step.gain < SHORT * (step.sum - least)) {
                Some(step) => {
                    last = step.shape;
                    step.sum
                }
                None => match search.closer(start, &[term], enough) {
                    Ok(found) => {
                        last = found.shape;
                        found.solution.residual.norm_squared()
                    }
                    Err(_) => return f64::INFINITY,
                },
            };
            (sum - least).max(0.0).sqrt() / (limit - least).sqrt() - 1.0
        };
        let usual =
            estimate.standard_error.filter(|error| *error > 0.0).unwrap_or(0.1 * centre.abs());
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
}
