//! Nonlinear least squares without bounds: Levenberg and Marquardt with a trust region.
//!
//! The algorithm is that of Moré (1978) as MINPACK's `lmder` has it, in the order of operations of
//! the crate `levenberg-marquardt` 0.15 (MIT, copyright 2020 rust-cv), so that the figures are
//! those which that crate gave, to the last bit. It stops where rounding leaves nothing to gain.
//!
//! [`bounded`](crate::bounded) is the solver for all else: for bounds, for derivatives that are
//! expensive or missing, for a watcher. Its steps are others. Put to the Stribeck curve it ends a
//! relative 3e-9 beside this one: the same minimum by any measure, but not the same figures.

mod factors;
#[cfg(test)]
mod tests;

use nalgebra::{DMatrix, DVector};

use self::factors::{Factor, Factors, length};

/// Relative fall of the sum of squares, relative step and cosine between residuals and columns that
/// no longer count.
const TOLERANCE: f64 = 30.0 * f64::EPSILON;
/// First radius of the region, in lengths of the scaled unknowns.
const FIRST_RADIUS: f64 = 100.0;
/// Evaluations at most, for each unknown and one more.
const PATIENCE: usize = 100;
/// Corrections of the damping at most.
const CORRECTIONS: usize = 10;

/// A problem with derivatives in closed form, with at least as many residuals as unknowns.
pub(crate) trait Problem {
    /// The residuals.
    fn residuals(&self, x: &[f64]) -> DVector<f64>;

    /// Their derivatives, one column an unknown.
    fn jacobian(&self, x: &[f64]) -> DMatrix<f64>;
}

/// The unknowns that make the sum of squares small, from `start`. A problem that still improves
/// when the patience ends gives the best that was found.
///
/// # Errors
/// A few words about what is no finite number.
pub(crate) fn minimise(problem: &impl Problem, start: &[f64]) -> Result<Vec<f64>, &'static str> {
    let mut x = DVector::from_column_slice(start);
    let mut residuals = problem.residuals(start);
    let norm = length(&residuals);
    if !norm.is_finite() {
        return Err("the residuals at the start");
    }
    if norm <= f64::MIN_POSITIVE {
        return Ok(start.to_vec());
    }
    let mut region = None;
    loop {
        let mut factors = Factors::of(problem.jacobian(x.as_slice()), residuals);
        let region = region.get_or_insert_with(|| Region::around(&factors, &x, norm));
        if !region.rescale(&factors)? {
            return Ok(x.as_slice().to_vec());
        }
        let better = loop {
            let tried = region.attempt(problem, &mut factors, &x)?;
            match (tried.better, tried.last) {
                (Some(better), false) => break better,
                (Some(better), true) => return Ok(better.x.as_slice().to_vec()),
                (None, true) => return Ok(x.as_slice().to_vec()),
                (None, false) => {}
            }
        };
        (x, residuals) = (better.x, better.residuals);
    }
}

/// Where the linear problem is believed.
struct Region {
    /// Length of the residuals at the best point.
    norm: f64,
    /// Weight of each unknown: the largest length of its column so far.
    scale: DVector<f64>,
    /// Length of the scaled unknowns.
    unknowns: f64,
    /// Radius, in scaled unknowns.
    radius: f64,
    damping: f64,
    /// The first step sets the radius.
    first: bool,
    /// Residuals computed so far, and at most.
    evaluations: usize,
    most: usize,
}

/// What became of a step.
struct Tried {
    /// The point, if it is better.
    better: Option<Point>,
    /// Nothing is to be gained any more.
    last: bool,
}

struct Point {
    x: DVector<f64>,
    residuals: DVector<f64>,
}

impl Region {
    fn around(factors: &Factors, x: &DVector<f64>, norm: f64) -> Self {
        let scale = factors.lengths.map(|length| if length == 0.0 { 1.0 } else { length });
        let unknowns = length(&scale.component_mul(x));
        let radius = if unknowns == 0.0 { FIRST_RADIUS } else { FIRST_RADIUS * unknowns };
        let most = PATIENCE * (x.len() + 1);
        Self { norm, scale, unknowns, radius, damping: 0.0, first: true, evaluations: 1, most }
    }

    /// Takes the columns' lengths in; false where the residuals are orthogonal to all columns.
    fn rescale(&mut self, factors: &Factors) -> Result<bool, &'static str> {
        let cosine = factors.cosine(self.norm).ok_or("the derivatives")?;
        if !self.unknowns.is_finite() {
            return Err("the unknowns");
        }
        self.scale.zip_apply(&factors.lengths, |scale, length| *scale = length.max(*scale));
        Ok(cosine > TOLERANCE)
    }

    /// Tries the step of this region from `x`, and judges the region by it.
    fn attempt(
        &mut self,
        problem: &impl Problem,
        factors: &mut Factors,
        x: &DVector<f64>,
    ) -> Result<Tried, &'static str> {
        let (step, reach) = self.step(factors);
        let linear = (factors.length_of_product(&step) / self.norm).powi(2);
        let damped = ((self.damping.sqrt() * reach) / self.norm).powi(2);
        if !(reach.is_finite() && linear.is_finite() && damped.is_finite()) {
            return Err("the step");
        }
        let predicted = linear + damped / 0.5;
        if std::mem::take(&mut self.first) && reach < self.radius {
            self.radius = reach;
        }
        let next = x - step;
        let residuals = problem.residuals(next.as_slice());
        self.evaluations += 1;
        let norm = length(&residuals);
        let much_worse = norm * 0.1 >= self.norm;
        let fall = if norm * 0.1 < self.norm { 1.0 - (norm / self.norm).powi(2) } else { -1.0 };
        let ratio = if predicted == 0.0 { 0.0 } else { fall / predicted };
        if ratio <= 0.25 {
            let slope = -(linear + damped);
            let shrink = if fall < 0.0 { 0.5 * slope / (slope + 0.5 * fall) } else { 0.5 };
            let shrink = if much_worse || shrink < 0.1 { 0.1 } else { shrink };
            self.radius = shrink * self.radius.min(reach * 10.0);
            self.damping /= shrink;
        } else if self.damping == 0.0 || ratio >= 0.75 {
            self.radius = reach / 0.5;
            self.damping *= 0.5;
        }
        let better = (ratio >= 1e-4).then_some(Point { x: next, residuals });
        if let Some(better) = &better {
            self.unknowns = length(&self.scale.component_mul(&better.x));
            self.norm = norm;
            if !self.unknowns.is_finite() {
                return Err("the unknowns");
            }
        }
        let nothing_gained = fall.abs() <= TOLERANCE && predicted <= TOLERANCE && ratio <= 2.0;
        let last = self.norm <= f64::MIN_POSITIVE
            || nothing_gained
            || self.radius <= TOLERANCE * self.unknowns
            || self.evaluations >= self.most;
        Ok(Tried { better, last })
    }

    /// The step whose scaled length is the radius within a tenth, or the shorter one of the
    /// undamped problem, and that length. Sets the damping.
    fn step(&mut self, factors: &mut Factors) -> (DVector<f64>, f64) {
        let radius = self.radius;
        let mut step = factors.solve();
        let mut scaled = step.component_mul(&self.scale);
        let mut reach = length(&scaled);
        let mut excess = reach - radius;
        if excess <= radius * 0.1 {
            self.damping = 0.0;
            return (step, reach);
        }
        // Newton's iteration for the damping, within what is known of it.
        let correction =
            |factors: &Factors, factor: &Factor, scaled: &DVector<f64>, reach: f64, excess: f64| {
                let direction = (scaled / reach).component_mul(&self.scale);
                let norm = length(&factors.solve_factor(factor, &direction));
                ((excess / radius) / norm) / norm
            };
        let mut lowest = if factors.is_regular() {
            correction(factors, &Factor::Plain, &scaled, reach, excess)
        } else {
            0.0
        };
        let gradient = length(&factors.gradient(&self.scale));
        let mut highest = gradient / radius;
        if highest == 0.0 {
            highest = f64::MIN_POSITIVE / radius.min(0.1);
        }
        let mut damping = self.damping.max(lowest).min(highest);
        if damping == 0.0 {
            damping = gradient / reach;
        }
        for iteration in 1..=CORRECTIONS {
            if damping == 0.0 {
                damping = f64::MIN_POSITIVE.max(highest * 0.001);
            }
            let factor;
            (step, factor) = factors.solve_damped(&(&self.scale * damping.sqrt()));
            scaled = step.component_mul(&self.scale);
            reach = length(&scaled);
            if iteration == CORRECTIONS {
                break;
            }
            let before = std::mem::replace(&mut excess, reach - radius);
            let enough = excess.abs() <= radius * 0.1;
            if enough || (lowest == 0.0 && excess <= before && before < 0.0) {
                break;
            }
            let more = correction(factors, &factor, &scaled, reach, excess);
            if excess > 0.0 {
                lowest = lowest.max(damping);
            } else {
                highest = highest.min(damping);
            }
            damping = lowest.max(damping + more);
        }
        self.damping = damping;
        (step, reach)
    }
}
