//! Confidence intervals from the profile of the likelihood.
//!
//! One parameter is held at a trial value, all others are fitted again, and the sum of squares `S`
//! of that fit is compared with the least one: the 95 % interval holds every value with
//!
//! ```text
//! S(value) <= S_min + t^2 s^2,   s^2 = S_min / (m - n),   t Student's quantile with m - n degrees of freedom
//! ```
//!
//! (Bates and Watts 1988, Nonlinear Regression Analysis, section 6.1; `t^2` is the F quantile with
//! 1 and `m - n` degrees of freedom.) For a linear problem it is the interval of the standard
//! error. For a curved one it is right where that one is not, and where the sum of squares never
//! reaches the limit the interval has no end on that side: the data fit as well with any value
//! there.

use std::ops::ControlFlow;

use crate::bounded::{Bound, Minimum, Patience, Residuals, minimise};
use crate::estimate::{Interval, IntervalMethod};
use crate::statistics::student_95;

/// Steps outwards, each twice as long as the one before, until an interval counts as open.
const DOUBLINGS: usize = 40;
/// Relative accuracy of an end, in units of the distance to the best value.
const ACCURACY: f64 = 1e-4;

/// The sum of squares that the 95 % interval may reach, from the least sum, the number of
/// residuals, the number of free parameters (the profiled one included) and the share of the
/// residuals that count as independent, see
/// [`effective_share`](crate::residual_whiteness::effective_share).
///
/// Infinite where no degree of freedom is left.
pub fn sum_limit(least: f64, residuals: usize, free: usize, share: f64) -> f64 {
    let degrees = residuals.saturating_sub(free);
    if degrees == 0 {
        return f64::INFINITY;
    }
    let independent = ((residuals as f64 * share) as usize).saturating_sub(free);
    let variance = least / degrees as f64 / share.clamp(f64::MIN_POSITIVE, 1.0);
    least + student_95(independent).powi(2) * variance
}

/// Where a profile is searched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Search {
    /// Best value.
    pub best: f64,
    /// First step outwards, above zero; a standard error suits.
    pub step: f64,
    /// Lowest value allowed; an interval that reaches it ends there. May be minus infinity.
    pub low: f64,
    /// Highest value allowed. May be infinite.
    pub high: f64,
    /// Sum of squares at the ends, from [`sum_limit`].
    pub limit: f64,
}

/// The interval around the best value whose profile stays below the limit. `profile` returns the
/// least sum of squares with the parameter held at a value, and none where no fit is possible,
/// which ends the interval.
///
/// ```
/// use friction_ident::profile::{Search, profile_interval};
///
/// // A parabola: the ends lie where it crosses the limit.
/// let search = Search { best: 3.0, step: 0.1, low: f64::NEG_INFINITY, high: f64::INFINITY, limit: 5.0 };
/// let interval = profile_interval(&search, &mut |x| Some(1.0 + (x - 3.0).powi(2)));
/// assert!((interval.low - 1.0).abs() < 1e-3 && (interval.high - 5.0).abs() < 1e-3);
/// ```
pub fn profile_interval(search: &Search, profile: &mut dyn FnMut(f64) -> Option<f64>) -> Interval {
    Interval {
        low: end(search, -1.0, search.low, profile),
        high: end(search, 1.0, search.high, profile),
        method: IntervalMethod::Profile,
    }
}

/// The end in direction `side`; `wall` if the profile does not reach the limit before.
fn end(search: &Search, side: f64, wall: f64, profile: &mut dyn FnMut(f64) -> Option<f64>) -> f64 {
    let mut excess = |x: f64| profile(x).map_or(f64::INFINITY, |sum| sum - search.limit);
    let mut step = search.step.abs().max(f64::EPSILON * search.best.abs()).max(f64::MIN_POSITIVE);
    let mut inside = search.best;
    let mut outside = None;
    for _ in 0..DOUBLINGS {
        let next = search.best + side * step;
        let at_wall = side * (next - wall) >= 0.0;
        let next = if at_wall { wall } else { next };
        let value = excess(next);
        if value > 0.0 {
            outside = Some((next, value));
            break;
        }
        if at_wall {
            return wall;
        }
        inside = next;
        step *= 2.0;
    }
    let Some((mut outside, mut above)) = outside else { return side * f64::INFINITY };
    let mut below = excess(inside).min(0.0);
    // Regula falsi with the halving of Illinois; plain halves where a value is infinite.
    for _ in 0..60 {
        if (outside - inside).abs() <= ACCURACY * (outside - search.best).abs() {
            break;
        }
        let share = if above.is_finite() && below < 0.0 { above / (above - below) } else { 0.5 };
        let middle = outside + share.clamp(0.02, 0.98) * (inside - outside);
        let value = excess(middle);
        if value > 0.0 {
            (outside, above, below) = (middle, value, 0.5 * below);
        } else {
            (inside, below, above) = (middle, value, 0.5 * above);
        }
    }
    if above.is_finite() { 0.5 * (inside + outside) } else { inside }
}

/// The interval of unknown `j` of a least squares problem at its minimum, the others fitted again
/// at every trial value within their bounds. `standard_error` sets the first step; `share` is the
/// share of the residuals that count as independent.
///
/// `None` where `j` is not an unknown of the problem.
pub fn profile_of(
    problem: &mut impl Residuals,
    minimum: &Minimum,
    bounds: &[Bound],
    j: usize,
    standard_error: f64,
    share: f64,
    patience: &Patience,
) -> Option<Interval> {
    let (&best, bound) = (minimum.x.get(j)?, bounds.get(j)?);
    let free = minimum.held.iter().filter(|&&held| !held).count().max(1);
    let limit = sum_limit(minimum.sum, minimum.residuals.len(), free, share);
    let step = if standard_error > 0.0 && standard_error.is_finite() {
        standard_error
    } else {
        bound.scale
    };
    let search = Search { best, step, low: bound.low, high: bound.high, limit };
    // Neighbouring fits start from one another.
    let mut start = minimum.x.clone();
    let interval = profile_interval(&search, &mut |value| {
        if !value.is_finite() {
            return None;
        }
        let mut held = bounds.to_vec();
        if let (Some(bound), Some(x)) = (held.get_mut(j), start.get_mut(j)) {
            *bound = Bound { low: value, high: value, ..*bound };
            *x = value;
        }
        let found = minimise(problem, &start, &held, patience, &mut |_| ControlFlow::Continue(()))?;
        start.clone_from(&found.x);
        Some(found.sum)
    });
    Some(interval)
}

#[cfg(test)]
mod tests;
