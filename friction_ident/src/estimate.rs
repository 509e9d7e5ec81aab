//! An estimated parameter: its value, how sure it is, and whether the data say anything about it at
//! all.
//!
//! Every fit of this crate that estimates named parameters ends in [`Estimates`]. A parameter that
//! the data do not determine carries a [`Doubt`] and what to measure instead; its number is then a
//! placeholder that is safe to compute with.

use nalgebra::DMatrix;
use serde::Serialize;

use crate::bounded::Minimum;
use crate::finite::finite;
use crate::parameter_id::ParameterId;
use crate::statistics::student_95;

/// How an interval was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum IntervalMethod {
    /// Value plus and minus Student's quantile times the standard error.
    Linearised,
    /// Where the profile of the likelihood crosses its limit: right for curved problems, and
    /// open-ended where it must be.
    Profile,
    /// The range over repeated searches that fit equally well.
    EquallyGoodFits,
    /// From the ranks of repeated measurements, without assuming a distribution.
    Ranks,
}

/// A 95 % confidence interval; an end may be infinite.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// How it was found.
    pub method: IntervalMethod,
}

impl Interval {
    /// Whether `value` lies within.
    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

/// A relative error in words: per cent as long as these say something,
/// `more than 10 times its value` beyond.
pub(crate) fn of_its_value(relative_error: f64) -> String {
    const SENSIBLE: f64 = 10.0;
    if relative_error <= SENSIBLE {
        format!("{:.0} % of its value", 100.0 * relative_error)
    } else {
        format!("more than {SENSIBLE:.0} times its value")
    }
}

/// Why the data do not determine a parameter.
#[derive(Debug, Clone, PartialEq, Serialize, thiserror::Error)]
#[serde(tag = "reason", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Doubt {
    /// The standard error is more than half the value.
    #[error("its standard error is {}", of_its_value(*relative_error))]
    LargeError {
        /// Standard error over value.
        relative_error: f64,
    },
    /// The interval has no end on one side.
    #[error("its interval has no end: the data fit about as well without the effect")]
    OpenInterval,
    /// The best value allowed is a bound itself.
    #[error("the best value lies at its bound {bound}")]
    AtBound {
        /// The bound.
        bound: f64,
    },
    /// Changing it changes nothing in this data.
    #[error("it changes nothing in this data")]
    NoEffect,
    /// It cannot be told from another parameter.
    #[error("it cannot be told from {other} (correlation {correlation:.4})")]
    Confounded {
        /// The other parameter.
        other: String,
        /// Their correlation.
        correlation: f64,
    },
    /// What it describes is not clear of the noise.
    #[error(
        "the effect it describes, {effect:.3e}, is not clear of its standard error {standard_error:.3e}"
    )]
    BelowNoise {
        /// Size of the effect.
        effect: f64,
        /// Its standard error.
        standard_error: f64,
    },
    /// What it is the mean of happened too rarely.
    #[error("it needs {needed} events, and the recording has {found}")]
    TooFewEvents {
        /// Events found.
        found: usize,
        /// Events needed.
        needed: usize,
    },
    /// Only its ratio to something unknown is determined.
    #[error("only its ratio to the torque per volt is determined")]
    RatioOnly,
    /// The sensor's steps are too coarse for the noise to fill them: the mean error of rounding is
    /// not known well enough.
    #[error(
        "the sensor's steps of {step:.3e} are too coarse for the noise of {noise:.3e} that should fill them"
    )]
    CoarseSensor {
        /// One step.
        step: f64,
        /// Standard deviation of the noise before rounding.
        noise: f64,
    },
    /// Repeated searches that fit equally well disagree.
    #[error("the {fits} equally good fits disagree on it")]
    Scatter {
        /// Least of them.
        low: f64,
        /// Greatest.
        high: f64,
        /// How many fits there are.
        fits: usize,
    },
    /// Only one search came this far.
    #[error("only one search reached this error: nothing confirms the value")]
    Unrepeated,
    /// It lies outside the range that was measured.
    #[error("it lies outside the measured range, {low} to {high}")]
    OutsideRange {
        /// Lower end of the range.
        low: f64,
        /// Upper end.
        high: f64,
    },
}

/// Whether the data determine a parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "verdict", rename_all = "snake_case")]
pub enum Verdict {
    /// They do.
    Identified,
    /// They do not.
    NotIdentifiable {
        /// Why.
        doubt: Doubt,
        /// What to measure instead.
        remedy: &'static str,
    },
    /// It was not estimated but computed from others, or given.
    Given {
        /// Where it comes from.
        source: &'static str,
    },
}

/// One parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimate {
    /// Which parameter; in documents its text, under `name`.
    #[serde(rename = "name")]
    pub id: ParameterId,
    /// Unit.
    pub unit: &'static str,
    /// Best value; where it is not identifiable, one that is safe to compute with.
    pub value: f64,
    /// Standard error; none where a bound holds it or where it was not estimated.
    pub standard_error: Option<f64>,
    /// 95 % interval.
    pub interval: Option<Interval>,
    /// Whether the data determine it.
    #[serde(flatten)]
    pub verdict: Verdict,
}

impl Estimate {
    /// A value that was not estimated here.
    pub fn given(
        id: impl Into<ParameterId>,
        unit: &'static str,
        value: f64,
        source: &'static str,
    ) -> Self {
        let verdict = Verdict::Given { source };
        Self { id: id.into(), unit, value, standard_error: None, interval: None, verdict }
    }

    /// Whether the data determine it.
    pub fn is_identified(&self) -> bool {
        self.verdict == Verdict::Identified
    }
}

/// What an unknown of a fit is called and what helps where it stays unknown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unknown {
    /// Which parameter.
    pub id: ParameterId,
    /// Unit.
    pub unit: &'static str,
    /// What to measure where this data does not determine it.
    pub remedy: &'static str,
}

/// Parameters estimated together.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct Estimates {
    /// One a parameter.
    pub parameters: Vec<Estimate>,
    /// Correlations, in the order of the parameters; zero beside one that was not free.
    pub correlation: Vec<Vec<f64>>,
    /// Covariance, likewise.
    pub covariance: Vec<Vec<f64>>,
    /// Standard deviation of the residuals, degrees of freedom taken into account.
    pub residual_deviation: f64,
    /// Residuals minus free parameters.
    pub degrees_of_freedom: usize,
}

/// Correlation beyond which two parameters cannot be told apart.
const CONFOUNDED: f64 = 0.9999;

impl Estimates {
    /// From a minimum of least squares, linearised: covariance `s^2 (J^T J)^-1` of the unknowns
    /// that no bound holds. `share` is the share of the residuals that count as independent: 1 for
    /// white ones, else [`effective_share`](crate::residual_whiteness::effective_share).
    pub fn linearised(minimum: &Minimum, unknowns: &[Unknown], share: f64) -> Self {
        let matrix = minimum.jacobian.tr_mul(&minimum.jacobian);
        let normal = NormalEquations {
            x: &minimum.x,
            held: &minimum.held,
            matrix: matrix.as_slice().to_vec(),
            sum: minimum.sum,
            residuals: minimum.residuals.len(),
        };
        normal.estimates(unknowns, share)
    }

    /// The place of a parameter among the rows of correlation and covariance.
    pub fn place(&self, id: impl Into<ParameterId>) -> Option<usize> {
        let id = id.into();
        self.parameters.iter().position(|estimate| estimate.id == id)
    }

    /// The estimate of a parameter.
    pub fn get(&self, id: impl Into<ParameterId>) -> Option<&Estimate> {
        self.parameters.get(self.place(id)?)
    }

    /// The same, to be changed.
    pub fn get_mut(&mut self, id: impl Into<ParameterId>) -> Option<&mut Estimate> {
        let place = self.place(id)?;
        self.parameters.get_mut(place)
    }

    /// The value of a parameter.
    pub fn value(&self, id: impl Into<ParameterId>) -> Option<f64> {
        self.get(id).map(|estimate| estimate.value)
    }
}

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
                let verdict = match doubt(self, unknowns, &correlation, standard_error, j) {
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
    standard_error: Option<f64>,
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
    (relative_error > 0.5 || relative_error.is_nan())
        .then_some(Doubt::LargeError { relative_error })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounded::{Bound, Patience, Residuals, minimise};
    use std::ops::ControlFlow;

    #[test]
    fn an_error_beyond_sense_is_told_in_times() {
        let doubt = |relative_error| Doubt::LargeError { relative_error }.to_string();
        assert_eq!(doubt(0.62), "its standard error is 62 % of its value");
        assert_eq!(doubt(3_222_979.53), "its standard error is more than 10 times its value");
        assert_eq!(doubt(f64::INFINITY), "its standard error is more than 10 times its value");
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
