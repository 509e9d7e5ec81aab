//! Parameters computed from estimated ones, with their errors carried along.
//!
//! To first order: with the gradient `G` of the new parameters with respect to the old ones, the
//! covariance becomes `G C G^T`. A parameter that depends on one that the data do not determine is
//! not determined either.

use nalgebra::DMatrix;

use crate::estimate::{Doubt, Estimate, Estimates, Interval, IntervalMethod, Unknown, Verdict};
use crate::statistics::student_95;

/// Standard error over value beyond which a parameter counts as unknown, as in
/// [`Estimates::linearised`].
const LARGE: f64 = 0.5;

/// A parameter computed from others.
#[derive(Debug, Clone, PartialEq)]
pub struct Derived {
    /// Name, unit and remedy.
    pub unknown: Unknown,
    /// Value.
    pub value: f64,
    /// Derivatives with respect to the parameters it comes from, in their order; missing ones are
    /// zero.
    pub gradient: Vec<f64>,
}

/// The derived parameters as estimates of their own.
///
/// ```
/// use friction_ident::bounded::{Bound, Patience, Residuals, minimise};
/// use friction_ident::derived::{Derived, derive};
/// use friction_ident::{Estimates, ParameterId, Unknown};
///
/// # struct Mean([f64; 4]);
/// # impl Residuals for Mean {
/// #     fn len(&self) -> usize { 4 }
/// #     fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool {
/// #         out.iter_mut().zip(self.0).for_each(|(r, y)| *r = x[0] - y);
/// #         true
/// #     }
/// # }
/// # let mut problem = Mean([1.0, 2.0, 3.0, 2.0]);
/// # let go = &mut |_: &_| std::ops::ControlFlow::Continue(());
/// # let minimum = minimise(&mut problem, &[0.0], &[Bound::free(1.0)], &Patience::default(), go).unwrap();
/// # let unknown = |name| Unknown { id: ParameterId::new(name), unit: "", remedy: "" };
/// let mean = Estimates::linearised(&minimum, &[unknown("mean")], 1.0);
/// let tenfold = derive(&mean, &[Derived { unknown: unknown("tenfold"), value: 20.0, gradient: vec![10.0] }]);
/// let ratio = tenfold.parameters[0].standard_error.unwrap() / mean.parameters[0].standard_error.unwrap();
/// assert!((ratio - 10.0).abs() < 1e-9);
/// ```
pub fn derive(source: &Estimates, derived: &[Derived]) -> Estimates {
    let (rows, columns) = (derived.len(), source.parameters.len());
    let gradient =
        DMatrix::from_fn(rows, columns, |i, j| derived[i].gradient.get(j).copied().unwrap_or(0.0));
    let covariance = DMatrix::from_fn(columns, columns, |i, j| {
        source.covariance.get(i).and_then(|row| row.get(j)).copied().unwrap_or(0.0)
    });
    let carried = &gradient * covariance * gradient.transpose();
    let factor = student_95(source.degrees_of_freedom);
    let parameters = derived
        .iter()
        .enumerate()
        .map(|(i, Derived { unknown, value, .. })| {
            let touched =
                || source.parameters.iter().enumerate().filter(|&(j, _)| gradient[(i, j)] != 0.0);
            let unknown_source = touched().find_map(|(_, estimate)| match &estimate.verdict {
                Verdict::NotIdentifiable { doubt, .. } => Some(doubt.clone()),
                _ => None,
            });
            let known = touched().all(|(_, estimate)| {
                estimate.standard_error.is_some()
                    || matches!(estimate.verdict, Verdict::Given { .. })
            });
            let error = known.then(|| carried[(i, i)].max(0.0).sqrt());
            let relative_error = error.map_or(0.0, |error| error / value.abs());
            let large = relative_error > LARGE || relative_error.is_nan();
            let doubt =
                unknown_source.or_else(|| large.then_some(Doubt::LargeError { relative_error }));
            Estimate {
                id: unknown.id,
                unit: unknown.unit,
                value: *value,
                standard_error: error,
                interval: error.map(|error| Interval {
                    low: value - factor * error,
                    high: value + factor * error,
                    method: IntervalMethod::Linearised,
                }),
                verdict: doubt.map_or(Verdict::Identified, |doubt| Verdict::NotIdentifiable {
                    doubt,
                    remedy: unknown.remedy,
                }),
            }
        })
        .collect();
    let entry = |i: usize, j: usize| carried[(i, j)];
    let correlation = |i: usize, j: usize| {
        let both = (entry(i, i) * entry(j, j)).sqrt();
        if i == j {
            1.0
        } else if both > 0.0 {
            entry(i, j) / both
        } else {
            0.0
        }
    };
    Estimates {
        parameters,
        correlation: (0..rows).map(|i| (0..rows).map(|j| correlation(i, j)).collect()).collect(),
        covariance: (0..rows).map(|i| (0..rows).map(|j| entry(i, j)).collect()).collect(),
        residual_deviation: source.residual_deviation,
        degrees_of_freedom: source.degrees_of_freedom,
    }
}
