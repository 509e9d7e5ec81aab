//! Nonlinear least squares within bounds: Levenberg and Marquardt with projection.
//!
//! Each step solves `(J^T J + mu D) d = -J^T r` over the unknowns that no bound holds (those at a
//! bound whose gradient points outwards are left out), cuts the step to the bounds, and accepts it
//! if the sum of squares falls. `D` is the largest diagonal of `J^T J` seen so far (Moré 1978),
//! `mu` follows the gain ratio (Nielsen 1999). The Jacobian is the problem's own, or forward
//! differences; between accepted steps it may be carried on by Broyden's rank-one update (1965),
//! which saves most of the evaluations where one is expensive.

use std::ops::ControlFlow;

use nalgebra::{DMatrix, DVector};

use crate::finite::finite;

/// A sum of squares to be made small.
pub trait Residuals {
    /// Residuals.
    fn len(&self) -> usize;

    /// Whether there is none at all.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Writes the residuals at `x` into `out`, which is as long as [`len`](Self::len). False where
    /// `x` is not allowed; `out` does not count then.
    fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool;

    /// Writes the derivatives of the residuals, one column an unknown, where they are known in
    /// closed form; `residuals` are those at `x`. False leaves them to forward differences.
    fn jacobian(&mut self, _x: &[f64], _residuals: &[f64], _jacobian: &mut DMatrix<f64>) -> bool {
        false
    }
}

/// Where an unknown may lie and how large it usually is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// Lowest value; may be minus infinity.
    pub low: f64,
    /// Highest value; may be infinite.
    pub high: f64,
    /// A usual magnitude, above zero: forward differences never step less than its square root of
    /// the rounding.
    pub scale: f64,
    /// Longest step, above zero; may be infinite. A step that is longer is shortened as a whole.
    pub reach: f64,
}

impl Bound {
    /// Any number, about as large as `scale`.
    pub const fn free(scale: f64) -> Self {
        Self::within(f64::NEG_INFINITY, f64::INFINITY, scale)
    }

    /// From `low` to `high`, about as large as `scale`.
    pub const fn within(low: f64, high: f64, scale: f64) -> Self {
        Self { low, high, scale, reach: f64::INFINITY }
    }

    /// The same with a longest step.
    #[must_use]
    pub const fn reaching(self, reach: f64) -> Self {
        Self { reach, ..self }
    }

    fn clip(&self, value: f64) -> f64 {
        value.max(self.low).min(self.high)
    }
}

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patience {
    /// Relative fall of the sum of squares that no longer counts.
    pub sum: f64,
    /// Relative step that no longer counts.
    pub step: f64,
    /// Jacobians at most.
    pub iterations: usize,
    /// Carry the Jacobian on by Broyden's update between accepted steps.
    pub broyden: bool,
}

impl Default for Patience {
    /// To about the rounding, 100 Jacobians, no updates.
    fn default() -> Self {
        Self { sum: 1e-14, step: 1e-12, iterations: 100, broyden: false }
    }
}

/// Why the search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// No step improves any more by what counts.
    Converged,
    /// The iterations are used up; the best point found is kept.
    OutOfPatience,
    /// The watcher asked for it; the best point found is kept.
    Stopped,
}

/// The best point found.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// The unknowns.
    pub x: Vec<f64>,
    /// The residuals there.
    pub residuals: DVector<f64>,
    /// Their derivatives there.
    pub jacobian: DMatrix<f64>,
    /// Unknowns that a bound holds.
    pub held: Vec<bool>,
    /// Sum of squares.
    pub sum: f64,
    /// How often the residuals were computed, those for differences included.
    pub evaluations: usize,
    /// Why the search ended.
    pub ending: Ending,
}

/// Sum of squares and evaluations so far, for whoever watches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Jacobians so far.
    pub iteration: usize,
    /// Least sum of squares so far.
    pub sum: f64,
}

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
    let (m, n) = (problem.len(), start.len());
    if bounds.len() != n {
        return None;
    }
    let mut x: Vec<f64> =
        start.iter().zip(bounds).map(|(&value, bound)| bound.clip(value)).collect();
    let mut residuals = DVector::zeros(m);
    let mut evaluations = 1;
    if !problem.residuals(&x, residuals.as_mut_slice()) {
        return None;
    }
    let mut sum = residuals.norm_squared();
    if !sum.is_finite() {
        return None;
    }
    let mut jacobian = DMatrix::zeros(m, n);
    let mut trial = DVector::zeros(m);
    let mut largest = vec![0.0f64; n];
    let (mut mu, mut growth) = (1e-4, 2.0);
    let mut ending = Ending::OutOfPatience;
    let mut iteration = 0;
    // Accepted steps since the Jacobian was computed afresh; none yet.
    let mut age: Option<usize> = None;
    loop {
        if age.is_none() {
            if iteration == patience.iterations {
                break;
            }
            evaluations +=
                differentiate(problem, &x, &residuals, bounds, &mut jacobian, &mut trial);
            (age, iteration) = (Some(0), iteration + 1);
            if watch(&Step { iteration, sum }).is_break() {
                ending = Ending::Stopped;
                break;
            }
        }
        let stale = age.is_some_and(|steps| steps > 0);
        let gradient = jacobian.tr_mul(&residuals);
        let normal = jacobian.tr_mul(&jacobian);
        let free: Vec<usize> = (0..n)
            .filter(|&j| {
                largest[j] = largest[j].max(normal[(j, j)]);
                let Bound { low, high, .. } = bounds[j];
                let outwards =
                    (x[j] <= low && gradient[j] > 0.0) || (x[j] >= high && gradient[j] < 0.0);
                low < high && !outwards && largest[j] > 0.0
            })
            .collect();
        if free.is_empty() || sum == 0.0 {
            ending = Ending::Converged;
            break;
        }
        // Shorter and shorter steps until one is better.
        let accepted = loop {
            let mut moved = DVector::zeros(n);
            if let Some(step) = damped_step(&normal, &gradient, &free, &largest, mu) {
                let too_long = free
                    .iter()
                    .zip(step.iter())
                    .map(|(&j, d)| d.abs() / bounds[j].reach)
                    .fold(1.0, f64::max);
                for (&j, d) in free.iter().zip(step.iter()) {
                    moved[j] = bounds[j].clip(x[j] + d / too_long) - x[j];
                }
            }
            let predicted = -(2.0 * gradient.dot(&moved) + moved.dot(&(&normal * &moved)));
            let small = (0..n)
                .all(|j| moved[j].abs() <= patience.step * x[j].abs().max(1e-3 * bounds[j].scale));
            let next: Vec<f64> = x.iter().zip(moved.iter()).map(|(a, b)| a + b).collect();
            evaluations += 1;
            let allowed = problem.residuals(&next, trial.as_mut_slice());
            let trial_sum = trial.norm_squared();
            if allowed && trial_sum < sum {
                let gain = (sum - trial_sum) / predicted.max(f64::MIN_POSITIVE);
                mu = (mu * (1.0 - (2.0 * gain - 1.0).powi(3)).clamp(0.1, 1.0)).max(1e-15);
                growth = 2.0;
                let enough = small
                    || (sum - trial_sum <= patience.sum * sum
                        && predicted <= 2.0 * patience.sum * sum);
                if patience.broyden && gain > 0.25 {
                    let surprise =
                        (&trial - &residuals - &jacobian * &moved) / moved.norm_squared();
                    jacobian.ger(1.0, &surprise, &moved, 1.0);
                    age = age.map(|steps| steps + 1);
                } else {
                    age = None;
                }
                std::mem::swap(&mut residuals, &mut trial);
                (x, sum) = (next, trial_sum);
                break if enough { Accepted::Last } else { Accepted::Better };
            }
            // A step that a bound has bent may point uphill: a shorter one does not.
            let nothing_to_gain = predicted.abs() <= f64::EPSILON * sum;
            if small || nothing_to_gain || mu > 1e18 || stale {
                break Accepted::None;
            }
            (mu, growth) = (mu * growth, growth * 2.0);
        };
        match accepted {
            Accepted::Better => {}
            // A Jacobian that was carried on may only think that it has arrived.
            Accepted::Last | Accepted::None if stale => age = None,
            Accepted::Last | Accepted::None => {
                ending = Ending::Converged;
                break;
            }
        }
    }
    if age != Some(0) {
        evaluations += differentiate(problem, &x, &residuals, bounds, &mut jacobian, &mut trial);
    }
    let held = x
        .iter()
        .zip(bounds)
        .map(|(&value, bound)| value <= bound.low || value >= bound.high)
        .collect();
    Some(Minimum { x, residuals, jacobian, held, sum, evaluations, ending })
}

/// What became of the steps tried with one Jacobian.
enum Accepted {
    Better,
    Last,
    None,
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

/// The Jacobian at `x`: the problem's own, or forward differences (backward where the upper bound
/// is in the way). Returns how often the residuals were computed.
fn differentiate(
    problem: &mut impl Residuals,
    x: &[f64],
    residuals: &DVector<f64>,
    bounds: &[Bound],
    jacobian: &mut DMatrix<f64>,
    trial: &mut DVector<f64>,
) -> usize {
    if problem.jacobian(x, residuals.as_slice(), jacobian) {
        return 0;
    }
    let mut evaluations = 0;
    let mut moved = x.to_vec();
    for (j, bound) in bounds.iter().enumerate() {
        let h = f64::EPSILON.sqrt() * x[j].abs().max(bound.scale);
        let mut column = jacobian.column_mut(j);
        column.fill(0.0);
        // The side that is allowed: a model may refuse what no bound says.
        for target in [x[j] + h, x[j] - h] {
            if target > bound.high || target < bound.low {
                continue;
            }
            moved[j] = target;
            evaluations += 1;
            if problem.residuals(&moved, trial.as_mut_slice())
                && trial.iter().all(|value| value.is_finite())
            {
                let exact = target - x[j];
                column
                    .zip_zip_apply(trial, residuals, |d, there, here| *d = (there - here) / exact);
                break;
            }
        }
        moved[j] = x[j];
    }
    evaluations
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Curve<F>(usize, F);

    impl<F: FnMut(&[f64], usize) -> f64> Residuals for Curve<F> {
        fn len(&self) -> usize {
            self.0
        }
        fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool {
            out.iter_mut().enumerate().for_each(|(i, r)| *r = (self.1)(x, i));
            true
        }
    }

    fn go(problem: &mut impl Residuals, start: &[f64], bounds: &[Bound], broyden: bool) -> Minimum {
        let patience = Patience { broyden, ..Patience::default() };
        minimise(problem, start, bounds, &patience, &mut |_| ControlFlow::Continue(())).unwrap()
    }

    /// Rosenbrock's valley as two residuals; the minimum is (1, 1).
    #[test]
    fn follows_a_curved_valley() {
        for broyden in [false, true] {
            let mut problem =
                Curve(
                    2,
                    |x: &[f64], i| if i == 0 { 10.0 * (x[1] - x[0] * x[0]) } else { 1.0 - x[0] },
                );
            let found = go(&mut problem, &[-1.2, 1.0], &[Bound::free(1.0); 2], broyden);
            assert!(
                (found.x[0] - 1.0).abs() < 1e-9 && (found.x[1] - 1.0).abs() < 1e-9,
                "{found:?}"
            );
        }
    }

    /// With x0 <= 0.5 the best point of the valley is (0.5, 0.25).
    #[test]
    fn stops_at_a_bound_and_says_so() {
        let bounds = [Bound::within(-2.0, 0.5, 1.0), Bound::free(1.0)];
        let mut problem =
            Curve(2, |x: &[f64], i| if i == 0 { 10.0 * (x[1] - x[0] * x[0]) } else { 1.0 - x[0] });
        let found = go(&mut problem, &[-1.2, 1.0], &bounds, false);
        assert!((found.x[0] - 0.5).abs() < 1e-12 && (found.x[1] - 0.25).abs() < 1e-8, "{found:?}");
        assert_eq!((found.held, found.ending), (vec![true, false], Ending::Converged));
    }

    /// Misra1a of NIST's reference data sets (nonlinear regression, start 1).
    #[test]
    fn agrees_with_a_certified_fit() {
        let x = [
            77.6, 114.9, 141.1, 190.8, 239.9, 289.0, 332.8, 378.4, 434.8, 477.3, 536.8, 593.1,
            689.1, 760.0,
        ];
        let y = [
            10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01, 66.40,
            75.47, 81.78,
        ];
        let bounds = [Bound::within(0.0, 1e4, 100.0), Bound::within(0.0, 1.0, 1e-3)];
        for broyden in [false, true] {
            let mut problem =
                Curve(14, |b: &[f64], i: usize| b[0] * (1.0 - (-b[1] * x[i]).exp()) - y[i]);
            let found = go(&mut problem, &[500.0, 1e-4], &bounds, broyden);
            assert!((found.x[0] / 2.3894212918e2 - 1.0).abs() < 1e-7, "{:?}", found.x);
            assert!((found.x[1] / 5.5015643181e-4 - 1.0).abs() < 1e-7, "{:?}", found.x);
            assert!((found.sum / 1.2455138894e-1 - 1.0).abs() < 1e-9, "{}", found.sum);
        }
    }

    #[test]
    fn a_watcher_stops_the_search_and_keeps_the_best() {
        let mut problem =
            Curve(2, |x: &[f64], i| if i == 0 { 10.0 * (x[1] - x[0] * x[0]) } else { 1.0 - x[0] });
        let mut sums = Vec::new();
        let found = minimise(
            &mut problem,
            &[-1.2, 1.0],
            &[Bound::free(1.0); 2],
            &Patience::default(),
            &mut |step| {
                sums.push(step.sum);
                if step.iteration == 4 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            },
        )
        .unwrap();
        assert_eq!((found.ending, sums.len()), (Ending::Stopped, 4));
        assert!(sums.windows(2).all(|pair| pair[1] < pair[0]) && found.sum == sums[3]);
    }

    #[test]
    fn what_is_not_allowed_is_refused_or_avoided() {
        struct Fence;
        impl Residuals for Fence {
            fn len(&self) -> usize {
                1
            }
            fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool {
                out[0] = x[0] + 3.0;
                x[0] >= 1.0
            }
        }
        let none =
            minimise(&mut Fence, &[0.0], &[Bound::free(1.0)], &Patience::default(), &mut |_| {
                ControlFlow::Continue(())
            });
        assert_eq!(none, None);
        let found = go(&mut Fence, &[9.0], &[Bound::free(1.0)], false);
        assert!(found.x[0] >= 1.0 && found.x[0] < 1.01, "{found:?}");
    }
}
