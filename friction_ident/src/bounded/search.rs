//! The search itself.

use std::ops::ControlFlow;

use nalgebra::{DMatrix, DVector};

use super::{Bound, Ending, Minimum, Patience, Residuals, Step};
use crate::finite::finite;

/// Damping up to which a step is that of the straight problem, and what it promises is to be trusted.
const TRUSTED: f64 = 1e-3;

/// Makes the sum of squares small, from `start` within `bounds`. `watch` sees every iteration and
/// may stop the search.
///
/// `None` where `start`, cut to the bounds, is not allowed or gives no finite residuals.
pub fn minimise(
    problem: &mut impl Residuals,
    start: &[f64],
    bounds: &[Bound],
    patience: &Patience,
    watch: &mut dyn FnMut(&Step) -> ControlFlow<()>,
) -> Option<Minimum> {
    let mut search = Search::begin(problem, start, bounds, patience)?;
    let ending = search.run(watch);
    Some(search.end(ending))
}

/// The unknowns alone, for who asks for no derivatives there. A step that promises less than what
/// counts is not tried: neither the last one nor those that a refused one is cut to, which cost the
/// residuals once more each.
pub(crate) fn lowest(
    problem: &mut impl Residuals,
    start: &[f64],
    bounds: &[Bound],
    patience: &Patience,
) -> Option<Vec<f64>> {
    let mut search = Search::begin(problem, start, bounds, patience)?;
    search.foresees = true;
    search.run(&mut |_| ControlFlow::Continue(()));
    Some(search.x)
}

/// The best point so far, and what the next step goes by.
struct Search<'a, P> {
    problem: &'a mut P,
    bounds: &'a [Bound],
    patience: &'a Patience,
    x: Vec<f64>,
    residuals: DVector<f64>,
    sum: f64,
    jacobian: DMatrix<f64>,
    /// Residuals of the point that is tried.
    trial: DVector<f64>,
    /// Largest diagonal of `J^T J` so far.
    largest: Vec<f64>,
    mu: f64,
    /// Factor by which `mu` grows at the next step that is refused.
    growth: f64,
    evaluations: usize,
    /// Whether it ends before a step that promises less than what counts.
    foresees: bool,
    /// Jacobians so far.
    iteration: usize,
    /// Accepted steps since the Jacobian was computed afresh; none where it is to be computed.
    age: Option<usize>,
}

/// What became of the steps tried with one Jacobian.
enum Accepted {
    Better,
    Last,
    None,
}

/// The quadratic model of the sum of squares.
struct Slope {
    gradient: DVector<f64>,
    normal: DMatrix<f64>,
}

impl<'a, P: Residuals> Search<'a, P> {
    fn begin(
        problem: &'a mut P,
        start: &[f64],
        bounds: &'a [Bound],
        patience: &'a Patience,
    ) -> Option<Self> {
        let (m, n) = (problem.len(), start.len());
        if bounds.len() != n {
            return None;
        }
        let x: Vec<f64> =
            start.iter().zip(bounds).map(|(&value, bound)| bound.clip(value)).collect();
        let mut residuals = DVector::zeros(m);
        if !problem.residuals(&x, residuals.as_mut_slice()) {
            return None;
        }
        let sum = residuals.norm_squared();
        sum.is_finite().then(|| Self {
            problem,
            bounds,
            patience,
            x,
            residuals,
            sum,
            jacobian: DMatrix::zeros(m, n),
            trial: DVector::zeros(m),
            largest: vec![0.0f64; n],
            mu: 1e-4,
            growth: 2.0,
            evaluations: 1,
            foresees: false,
            iteration: 0,
            age: None,
        })
    }

    fn run(&mut self, watch: &mut dyn FnMut(&Step) -> ControlFlow<()>) -> Ending {
        loop {
            if self.age.is_none() {
                if self.iteration == self.patience.iterations {
                    return Ending::OutOfPatience;
                }
                self.differentiate();
                (self.age, self.iteration) = (Some(0), self.iteration + 1);
                if watch(&Step { iteration: self.iteration, sum: self.sum }).is_break() {
                    return Ending::Stopped;
                }
            }
            let stale = self.age.is_some_and(|steps| steps > 0);
            let slope = Slope {
                gradient: self.jacobian.tr_mul(&self.residuals),
                normal: normal(&self.jacobian),
            };
            let free = self.free(&slope);
            if free.is_empty() || self.sum == 0.0 {
                return Ending::Converged;
            }
            match self.step(&slope, &free, stale) {
                Accepted::Better => {}
                // A Jacobian that was carried on may only think that it has arrived.
                Accepted::Last | Accepted::None if stale => self.age = None,
                Accepted::Last | Accepted::None => return Ending::Converged,
            }
        }
    }

    /// The unknowns that no bound holds.
    fn free(&mut self, slope: &Slope) -> Vec<usize> {
        (0..self.x.len())
            .filter(|&j| {
                self.largest[j] = self.largest[j].max(slope.normal[(j, j)]);
                let Bound { low, high, .. } = self.bounds[j];
                let outwards = (self.x[j] <= low && slope.gradient[j] > 0.0)
                    || (self.x[j] >= high && slope.gradient[j] < 0.0);
                low < high && !outwards && self.largest[j] > 0.0
            })
            .collect()
    }

    /// Shorter and shorter steps until one is better.
    fn step(&mut self, slope: &Slope, free: &[usize], stale: bool) -> Accepted {
        let Slope { gradient, normal } = slope;
        let mut refused = false;
        loop {
            let moved = self.proposed(slope, free);
            let predicted = -(2.0 * gradient.dot(&moved) + moved.dot(&(normal * &moved)));
            let small = (0..self.x.len()).all(|j| {
                moved[j].abs()
                    <= self.patience.step * self.x[j].abs().max(1e-3 * self.bounds[j].scale)
            });
            let counts = predicted > self.patience.sum * self.sum;
            if self.foresees && !counts && (refused || self.mu <= TRUSTED) {
                return Accepted::None;
            }
            let next: Vec<f64> = self.x.iter().zip(moved.iter()).map(|(a, b)| a + b).collect();
            self.evaluations += 1;
            let allowed = self.problem.residuals(&next, self.trial.as_mut_slice());
            if allowed && self.trial.norm_squared() < self.sum {
                return self.accept(next, &moved, predicted, small);
            }
            // A step that a bound has bent may point uphill: a shorter one does not.
            let nothing_to_gain = predicted.abs() <= f64::EPSILON * self.sum;
            if small || nothing_to_gain || self.mu > 1e18 || stale {
                return Accepted::None;
            }
            (self.mu, self.growth) = (self.mu * self.growth, self.growth * 2.0);
            refused = true;
        }
    }

    /// The step under the present damping, cut to the longest one and to the bounds; none at all
    /// where the equations have no solution.
    fn proposed(&self, slope: &Slope, free: &[usize]) -> DVector<f64> {
        let mut moved = DVector::zeros(self.x.len());
        if let Some(step) =
            damped_step(&slope.normal, &slope.gradient, free, &self.largest, self.mu)
        {
            let too_long = free
                .iter()
                .zip(step.iter())
                .map(|(&j, d)| d.abs() / self.bounds[j].reach)
                .fold(1.0, f64::max);
            for (&j, d) in free.iter().zip(step.iter()) {
                moved[j] = self.bounds[j].clip(self.x[j] + d / too_long) - self.x[j];
            }
        }
        moved
    }

    /// Takes the point that was tried.
    fn accept(
        &mut self,
        next: Vec<f64>,
        moved: &DVector<f64>,
        predicted: f64,
        small: bool,
    ) -> Accepted {
        let (sum, trial_sum) = (self.sum, self.trial.norm_squared());
        let gain = (sum - trial_sum) / predicted.max(f64::MIN_POSITIVE);
        self.mu = (self.mu * (1.0 - (2.0 * gain - 1.0).powi(3)).clamp(0.1, 1.0)).max(1e-15);
        self.growth = 2.0;
        let least = self.patience.sum;
        let enough = small || (sum - trial_sum <= least * sum && predicted <= 2.0 * least * sum);
        if self.patience.broyden && gain > 0.25 {
            let surprise =
                (&self.trial - &self.residuals - &self.jacobian * moved) / moved.norm_squared();
            self.jacobian.ger(1.0, &surprise, moved, 1.0);
            self.age = self.age.map(|steps| steps + 1);
        } else {
            self.age = None;
        }
        std::mem::swap(&mut self.residuals, &mut self.trial);
        (self.x, self.sum) = (next, trial_sum);
        if enough { Accepted::Last } else { Accepted::Better }
    }

    fn end(mut self, ending: Ending) -> Minimum {
        if self.age != Some(0) {
            self.differentiate();
        }
        let held = self
            .x
            .iter()
            .zip(self.bounds)
            .map(|(&value, bound)| value <= bound.low || value >= bound.high)
            .collect();
        let Self { x, residuals, jacobian, sum, evaluations, .. } = self;
        Minimum { x, residuals, jacobian, held, sum, evaluations, ending }
    }

    /// The Jacobian at the best point: the problem's own, or forward differences (backward where
    /// the upper bound is in the way).
    fn differentiate(&mut self) {
        let Self { problem, x, residuals, jacobian, trial, .. } = self;
        if problem.jacobian(x, residuals.as_slice(), jacobian) {
            return;
        }
        let mut moved = x.to_vec();
        for (j, bound) in self.bounds.iter().enumerate() {
            let h = f64::EPSILON.sqrt() * x[j].abs().max(bound.scale);
            let mut column = jacobian.column_mut(j);
            column.fill(0.0);
            // The side that is allowed: a model may refuse what no bound says.
            for target in [x[j] + h, x[j] - h] {
                if target > bound.high || target < bound.low {
                    continue;
                }
                moved[j] = target;
                self.evaluations += 1;
                if problem.residuals(&moved, trial.as_mut_slice())
                    && trial.iter().all(|value| value.is_finite())
                {
                    let exact = target - x[j];
                    column.zip_zip_apply(trial, residuals, |d, there, here| {
                        *d = (there - here) / exact
                    });
                    break;
                }
            }
            moved[j] = x[j];
        }
    }
}

/// `J^T J`: each product once, as it is symmetric.
fn normal(jacobian: &DMatrix<f64>) -> DMatrix<f64> {
    let n = jacobian.ncols();
    let mut normal = DMatrix::zeros(n, n);
    for i in 0..n {
        for j in 0..=i {
            let product = jacobian.column(i).dot(&jacobian.column(j));
            (normal[(i, j)], normal[(j, i)]) = (product, product);
        }
    }
    normal
}

/// Solves the damped normal equations of the free unknowns; none where they are not positive
/// definite in floating point.
fn damped_step(
    normal: &DMatrix<f64>,
    gradient: &DVector<f64>,
    free: &[usize],
    largest: &[f64],
    mu: f64,
) -> Option<DVector<f64>> {
    // Scaled to a unit diagonal, so that units do not matter.
    let root: Vec<f64> = free.iter().map(|&j| largest[j].sqrt()).collect();
    let matrix = DMatrix::from_fn(free.len(), free.len(), |a, b| {
        normal[(free[a], free[b])] / (root[a] * root[b]) + if a == b { mu } else { 0.0 }
    });
    let right = DVector::from_fn(free.len(), |a, _| -gradient[free[a]] / root[a]);
    let mut step = finite(matrix)?.cholesky()?.solve(&right);
    step.iter_mut().zip(&root).for_each(|(d, root)| *d /= root);
    step.iter().all(|d| d.is_finite()).then_some(step)
}
