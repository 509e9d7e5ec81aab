//! Errors from the normal equations at a minimum of least squares.

use nalgebra::DMatrix;

use super::{Doubt, Estimate, Estimates, Interval, IntervalMethod, Unknown, Verdict};
use crate::finite::finite;
use crate::statistics::student_95;

/// Correlation beyond which two parameters cannot be told apart.
const CONFOUNDED: f64 = 0.9999;

/// Normal equations at a minimum of least squares: all that a linearised error needs.
pub(crate) struct NormalEquations<'a> {
    pub x: &'a [f64],
    /// Unknowns that a bound holds.
    pub held: &'a [bool],
    /// `J^T J`, column by column.
    pub matrix: Vec<f64>,
    pub sum: f64,
    /// How many residuals there are.
    pub residuals: usize,
}

impl NormalEquations<'_> {
    fn at(&self, i: usize, j: usize) -> f64 {
        self.matrix.get(i + j * self.x.len()).copied().unwrap_or(0.0)
    }

    pub fn estimates(&self, unknowns: &[Unknown], share: f64) -> Estimates {
        let n = unknowns.len().min(self.x.len());
        let free: Vec<usize> = (0..n).filter(|&j| !self.held[j] && self.at(j, j) > 0.0).collect();
        let m = self.residuals;
        let degrees_of_freedom = ((m as f64 * share) as usize).saturating_sub(free.len());
        let variance = self.sum
            / m.saturating_sub(free.len()).max(1) as f64
            / share.clamp(f64::MIN_POSITIVE, 1.0);
        let root: Vec<f64> = free.iter().map(|&j| self.at(j, j).sqrt()).collect();
        let normal = DMatrix::from_fn(free.len(), free.len(), |a, b| {
            self.at(free[a], free[b]) / (root[a] * root[b])
        });
        // Singular in floating point: nothing is known of the parameters concerned.
        let inverse = finite(normal).and_then(|normal| normal.try_inverse()).filter(|inverse| {
            (0..free.len()).all(|a| inverse[(a, a)].is_finite() && inverse[(a, a)] > 0.0)
        });
        let mut covariance = vec![vec![0.0; n]; n];
        let mut correlation = vec![vec![0.0; n]; n];
        for (j, row) in correlation.iter_mut().enumerate() {
            row[j] = 1.0;
        }
        if let Some(inverse) = &inverse {
            for (a, &i) in free.iter().enumerate() {
                for (b, &j) in free.iter().enumerate() {
                    covariance[i][j] = variance * inverse[(a, b)] / (root[a] * root[b]);
                    correlation[i][j] =
                        inverse[(a, b)] / (inverse[(a, a)] * inverse[(b, b)]).sqrt();
                }
            }
        }
        let factor = student_95(degrees_of_freedom);
        let parameters = (0..n)
            .map(|j| {
                let Unknown { id, unit, remedy } = unknowns[j];
                let value = self.x[j];
                let known = free.contains(&j) && inverse.is_some();
                let standard_error = known.then(|| covariance[j][j].sqrt());
                let verdict = match doubt(self, unknowns, &correlation, (standard_error, factor), j)
                {
                    Some(doubt) => Verdict::NotIdentifiable { doubt, remedy },
                    None => Verdict::Identified,
                };
                let interval = standard_error.map(|error| Interval {
                    low: value - factor * error,
                    high: value + factor * error,
                    method: IntervalMethod::Linearised,
                });
                Estimate { id, unit, value, standard_error, interval, verdict }
            })
            .collect();
        let residual_deviation = variance.sqrt();
        Estimates { parameters, correlation, covariance, residual_deviation, degrees_of_freedom }
    }
}

fn doubt(
    minimum: &NormalEquations,
    unknowns: &[Unknown],
    correlation: &[Vec<f64>],
    (standard_error, factor): (Option<f64>, f64),
    j: usize,
) -> Option<Doubt> {
    let value = minimum.x[j];
    if minimum.held[j] {
        return Some(Doubt::AtBound { bound: value });
    }
    if minimum.at(j, j) == 0.0 {
        return Some(Doubt::NoEffect);
    }
    let Some(error) = standard_error else {
        return Some(Doubt::LargeError { relative_error: f64::INFINITY });
    };
    let others = (0..unknowns.len()).filter(|&i| i != j);
    let twin = others.max_by(|&a, &b| correlation[j][a].abs().total_cmp(&correlation[j][b].abs()));
    if let Some(twin) =
        twin.filter(|&i| correlation[j][i].abs() > CONFOUNDED && error > 0.05 * value.abs())
    {
        return Some(Doubt::Confounded {
            other: unknowns[twin].id.to_string(),
            correlation: correlation[j][twin],
        });
    }
    let relative_error = error / value.abs();
    is_large(relative_error, factor).then_some(Doubt::LargeError { relative_error })
}

/// Whether an error leaves open that there is anything: more than half the value, or an interval,
/// `factor` errors to each side, that reaches zero.
pub(super) fn is_large(relative_error: f64, factor: f64) -> bool {
    relative_error > 0.5 || factor * relative_error >= 1.0 || relative_error.is_nan()
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::bounded::{Bound, Patience, Residuals, minimise};
    use crate::parameter_id::ParameterId;

    /// Of few residuals the interval is wide: one through zero is no finding, even where the error
    /// is less than half the value.
    #[test]
    fn what_an_interval_through_zero_leaves_open_is_not_identified() {
        assert!(!is_large(0.4, 2.0) && is_large(0.4, 2.6) && is_large(0.51, 1.9));
        let y = [1.2, -0.2, 0.9, 0.7];
        let found = fit(&[vec![1.0; 4]], &y, &[Bound::free(1.0)]);
        let mean = &found.parameters[0];
        let relative = mean.standard_error.unwrap() / mean.value;
        assert!(relative > 0.4 && relative < 0.5, "{relative}");
        assert!(mean.interval.unwrap().low < 0.0 && !mean.is_identified(), "{mean:?}");
    }

    /// `a + b t + c t` (or a third column of its own) against given data.
    struct Line<'a> {
        columns: &'a [Vec<f64>],
        y: &'a [f64],
    }

    impl Residuals for Line<'_> {
        fn len(&self) -> usize {
            self.y.len()
        }
        fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool {
            for (i, r) in out.iter_mut().enumerate() {
                *r = self.columns.iter().zip(x).map(|(column, x)| column[i] * x).sum::<f64>()
                    - self.y[i];
            }
            true
        }
    }

    fn fit(columns: &[Vec<f64>], y: &[f64], bounds: &[Bound]) -> Estimates {
        let start = vec![0.5; columns.len()];
        let go = &mut |_: &_| ControlFlow::Continue(());
        let minimum =
            minimise(&mut Line { columns, y }, &start, bounds, &Patience::default(), go).unwrap();
        let unknown = |name| Unknown { id: ParameterId::new(name), unit: "", remedy: "more" };
        Estimates::linearised(
            &minimum,
            &["a", "b", "c"][..columns.len()].iter().map(|n| unknown(n)).collect::<Vec<_>>(),
            1.0,
        )
    }

    /// A line through four points: a = 0.7, b = 2.2, s^2 = 1.2 / 2; variances 0.7 s^2 and 0.2 s^2.
    #[test]
    fn a_line_has_the_errors_of_the_textbook() {
        let columns = [vec![1.0; 4], vec![0.0, 1.0, 2.0, 3.0]];
        let found = fit(&columns, &[1.0, 3.0, 4.0, 8.0], &[Bound::free(1.0); 2]);
        let sum = [0.3f64, 0.1, -1.1, 0.7].iter().map(|r| r * r).sum::<f64>();
        let error = |share: f64| (share * sum / 2.0).sqrt();
        let [a, b] = [&found.parameters[0], &found.parameters[1]];
        assert!((a.value - 0.7).abs() < 1e-8 && (b.value - 2.2).abs() < 1e-8);
        assert!((a.standard_error.unwrap() - error(0.7)).abs() < 1e-6);
        assert!((b.standard_error.unwrap() - error(0.2)).abs() < 1e-6);
        assert!((found.correlation[0][1] + 0.3 / 0.14f64.sqrt()).abs() < 1e-6);
        assert!((b.interval.unwrap().high - 2.2 - 4.302653 * error(0.2)).abs() < 1e-5);
        assert!(matches!(
            a.verdict,
            Verdict::NotIdentifiable { doubt: Doubt::LargeError { .. }, .. }
        ));
        assert!(b.is_identified());
    }

    #[test]
    fn parameters_that_cannot_be_told_apart_say_so() {
        let t: Vec<f64> = (0..50).map(|i| f64::from(i) * 0.1).collect();
        let noise = |i: usize| 0.01 * ((i * 7919 % 101) as f64 / 50.0 - 1.0);
        let y: Vec<f64> = t.iter().enumerate().map(|(i, t)| 1.0 + 2.0 * t + noise(i)).collect();
        let twin: Vec<f64> = t.iter().enumerate().map(|(i, t)| t + 1e-4 * noise(i * 3)).collect();
        let found = fit(&[vec![1.0; 50], t.clone(), twin], &y, &[Bound::free(1.0); 3]);
        assert!(found.parameters[0].is_identified());
        for estimate in &found.parameters[1..] {
            assert!(!estimate.is_identified(), "{estimate:?}");
        }
        let found = fit(&[vec![1.0; 50], t, vec![0.0; 50]], &y, &[Bound::free(1.0); 3]);
        assert!(matches!(
            found.parameters[2].verdict,
            Verdict::NotIdentifiable { doubt: Doubt::NoEffect, .. }
        ));
        let bounds = [Bound::free(1.0), Bound::within(0.0, 1.5, 1.0)];
        let columns = [vec![1.0; 50], (0..50).map(|i| f64::from(i) * 0.1).collect()];
        let held = fit(&columns, &y, &bounds);
        assert!(
            matches!(held.parameters[1].verdict, Verdict::NotIdentifiable { doubt: Doubt::AtBound { bound }, .. } if bound == 1.5)
        );
    }
}
