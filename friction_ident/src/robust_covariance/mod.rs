//! Standard errors of a least-squares fit whose residual is neither white nor of one size: noise
//! that is coloured, and what the model does not have.
//!
//! The covariance is the sandwich `N S N` with `N = (J^T J)^-1` and `S` the long-run variance of
//! the score `J_t r_t`. `S` is the mean square of the score's first `B` cosine coefficients over
//! the recording, the estimator that Lazarus, Lewis, Stock and Watson (2018, Journal of Business
//! and Economic Statistics 36, 541) recommend: equal weights, and Student's quantile with `B`
//! degrees of freedom in place of the normal one. Only slow waves of the score enter. A score that
//! repeats with the motion, as a model error under a periodic trajectory makes it, is slow nowhere
//! and cancels in the estimate as it does in the error.
//!
//! `B` is 0.4 n^(2/3) of their paper, with `n` the samples that the parameter's own score is worth
//! ([`residual_whiteness`](crate::residual_whiteness)), 4 to 16: with 16 the interval is 8 % wider
//! than with any number, and asks nothing of the spectrum beyond 8 waves over the recording.
//!
//! Corrections, as Bell and McCaffrey (2002) and Imbens and Kolesar (2016) make them for clusters:
//! the residual of a fit is smaller than the error, and a parameter that a few reversals determine
//! has fewer degrees of freedom than `B`. Both are computed as if the residual were white.
//!
//! Where the slowest waves stand out of the others, the axis changed during the recording. The
//! error is then taken from these waves alone, with their few degrees of freedom, and the parameter
//! has a doubt.

use nalgebra::DMatrix;
use serde::Serialize;

use crate::finite::finite;
use crate::residual_whiteness::effective_share_of;
use crate::statistics::student_95_of;

/// The method, for pages and documents.
pub const METHOD: &str = "sandwich covariance with cosine weights (Lazarus, Lewis, Stock and Watson 2018): \
     coloured residuals and what the model does not have are counted; Student's quantile";

/// Waves at most.
const MOST: usize = 16;
/// Waves at least.
const LEAST: usize = 4;
/// Independent stretches of the score below which no wave is slow enough.
const STRETCHES: f64 = 12.0;
/// Degrees of freedom below which an error is a guess.
const DEGREES: f64 = 2.5;
/// Factor by which the fit may have taken the score's slow waves away.
const LACKING: f64 = 4.0;
/// Slowest waves, in which a drift shows.
const SLOW: usize = 2;

/// Why a standard error is not to be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, thiserror::Error)]
#[serde(tag = "reason", rename_all = "snake_case")]
pub enum ErrorDoubt {
    /// The residual changes too slowly for the length of the recording.
    #[error(
        "what the fit leaves changes so slowly that the recording holds only {found:.0} independent \
         stretches of it, and {STRETCHES:.0} are needed: a longer recording helps"
    )]
    FewStretches {
        /// Stretches found.
        found: f64,
    },
    /// A small part of the recording determines the parameter.
    #[error(
        "a small part of the recording determines it, so that nothing confirms it ({degrees:.1} degrees of freedom): \
         a motion that shows it throughout helps"
    )]
    OneEvent {
        /// Degrees of freedom left.
        degrees: f64,
    },
    /// It is not the same at the beginning and at the end.
    #[error(
        "it drifts during the recording: the slowest part of the residual is {ratio:.0} times the \
         rest (temperature, wear, or a place that only part of the recording visits)"
    )]
    Drift {
        /// Mean square of the slowest waves over that of the others.
        ratio: f64,
    },
}

/// How sure one parameter is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RobustError {
    /// Standard error.
    pub standard_error: f64,
    /// Degrees of freedom of that error, for Student's quantile.
    pub degrees_of_freedom: f64,
    /// Why the error is not to be trusted.
    pub doubt: Option<ErrorDoubt>,
}

impl RobustError {
    /// Half the width of the 95 % interval.
    pub fn half_width(&self) -> f64 {
        self.standard_error * student_95_of(self.degrees_of_freedom)
    }
}

/// Errors of all parameters of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct RobustCovariance {
    /// One a column of the Jacobian.
    pub parameters: Vec<RobustError>,
    /// Covariance of the parameters; its diagonal is the square of the standard errors.
    pub covariance: DMatrix<f64>,
}

/// Errors of the parameters of a least-squares fit at its minimum.
///
/// `jacobian` has a row a sample in the order of time and a column a free parameter (leave out what
/// a bound holds); its sign does not matter. `residuals` are those of the fit. `pieces` are the
/// lengths of the stretches without a gap, in order; one for a recording without gaps. Beyond their
/// sum rows count as another piece.
///
/// None where columns depend on one another, something is not finite, or there are fewer than four
/// rows a column.
///
/// ```
/// use friction_ident::robust_covariance::robust_covariance;
/// use nalgebra::DMatrix;
///
/// // The mean of an alternating residual is as sure as white noise, or surer.
/// let residuals: Vec<f64> = (0..200).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
/// let found = robust_covariance(&DMatrix::from_element(200, 1, 1.0), &residuals, &[200]).unwrap();
/// assert!(found.parameters[0].standard_error < 1.0 / 200f64.sqrt());
/// ```
pub fn robust_covariance(
    jacobian: &DMatrix<f64>,
    residuals: &[f64],
    pieces: &[usize],
) -> Option<RobustCovariance> {
    let (rows, columns) = jacobian.shape();
    if columns == 0 || rows != residuals.len() || rows < 4 * columns {
        return None;
    }
    if !residuals.iter().all(|r| r.is_finite()) {
        return None;
    }
    let scale: Vec<f64> = jacobian.column_iter().map(|column| column.norm()).collect();
    if scale.iter().any(|norm| !(*norm > 0.0 && norm.is_finite())) {
        return None;
    }
    let mut scaled = jacobian.clone();
    scaled.column_iter_mut().zip(&scale).for_each(|(mut column, norm)| column /= *norm);
    let inverse = finite(finite(scaled.tr_mul(&scaled))?.try_inverse()?)?;
    // What a residual of one in a row moves each parameter by, the columns scaled.
    let weights = &scaled * &inverse;
    let waves = cosines(rows, MOST.min(most_waves(rows as f64)));
    let fit = Fit { scaled: &scaled, inverse: &inverse, weights: &weights, waves: &waves };
    let mut parameters = Vec::with_capacity(columns);
    for j in 0..columns {
        parameters.push(fit.error(j, residuals, pieces));
    }
    // Correlations from all waves, errors from those that suit each parameter.
    let mut scores = weights.clone();
    scores.row_iter_mut().zip(residuals).for_each(|(mut row, r)| row *= *r);
    let coefficients = waves.tr_mul(&scores);
    let together = coefficients.tr_mul(&coefficients);
    let covariance = DMatrix::from_fn(columns, columns, |a, b| {
        let root = (together[(a, a)] * together[(b, b)]).sqrt();
        let alike = if a == b {
            1.0
        } else if root > 0.0 {
            together[(a, b)] / root
        } else {
            0.0
        };
        alike * parameters[a].standard_error * parameters[b].standard_error / (scale[a] * scale[b])
    });
    for (parameter, scale) in parameters.iter_mut().zip(&scale) {
        parameter.standard_error /= scale;
    }
    Some(RobustCovariance { parameters, covariance })
}

/// The paper's number of waves for `samples` independent ones.
fn most_waves(samples: f64) -> usize {
    (0.4 * samples.powf(2.0 / 3.0)).round().clamp(LEAST as f64, MOST as f64) as usize
}

/// The first waves over the rows, one a column, each of mean square one and mean zero.
fn cosines(rows: usize, count: usize) -> DMatrix<f64> {
    let step = std::f64::consts::PI / rows as f64;
    DMatrix::from_fn(rows, count, |t, b| {
        std::f64::consts::SQRT_2 * (step * (b + 1) as f64 * (t as f64 + 0.5)).cos()
    })
}

struct Fit<'a> {
    scaled: &'a DMatrix<f64>,
    inverse: &'a DMatrix<f64>,
    weights: &'a DMatrix<f64>,
    waves: &'a DMatrix<f64>,
}

impl Fit<'_> {
    fn error(&self, j: usize, residuals: &[f64], pieces: &[usize]) -> RobustError {
        let weight = self.weights.column(j);
        let score: Vec<f64> = weight.iter().zip(residuals).map(|(w, r)| w * r).collect();
        let stretches = score.len() as f64 * effective_share_of(&score, pieces);
        let count = most_waves(stretches).min(self.waves.ncols());
        // Row b: how the residual enters the coefficient of wave b.
        let mut entering = self.waves.columns(0, count).clone_owned();
        for (mut row, w) in entering.row_iter_mut().zip(weight.iter()) {
            row *= *w;
        }
        let coefficients: Vec<f64> = entering
            .column_iter()
            .map(|column| column.iter().zip(residuals).map(|(c, r)| c * r).sum())
            .collect();
        let through = entering.tr_mul(self.scaled);
        let white = entering.tr_mul(&entering) - &through * self.inverse * through.transpose();
        let power = weight.norm_squared();
        let squares = |of: &[f64]| of.iter().map(|c| c * c).sum::<f64>() / of.len().max(1) as f64;
        // Of the first waves alone: their mean square, what it lacks, and its degrees of freedom.
        let of_first = |n: usize| {
            let block = white.view((0, 0), (n, n));
            let trace = block.trace();
            let lacks =
                if trace > 0.0 { (power * n as f64 / trace).max(1.0) } else { f64::INFINITY };
            let degrees = if trace > 0.0 { trace * trace / block.norm_squared() } else { 0.0 };
            (squares(&coefficients[..n]) * lacks, degrees, lacks)
        };
        let (mut variance, mut degrees, lacks) = of_first(count);
        let mut doubt = None;
        let (slow, rest) = coefficients.split_at(SLOW.min(count));
        let ratio = squares(slow) / squares(rest);
        let (of_slow, degrees_of_slow, _) = of_first(SLOW.min(count));
        if rest.len() >= SLOW && ratio > beyond_chance(rest.len()) {
            doubt = Some(ErrorDoubt::Drift { ratio });
            (variance, degrees) = (variance.max(of_slow), degrees_of_slow);
        }
        if stretches < STRETCHES {
            doubt = Some(ErrorDoubt::FewStretches { found: stretches });
        }
        if (degrees < DEGREES || lacks > LACKING) && doubt.is_none() {
            doubt = Some(ErrorDoubt::OneEvent { degrees });
        }
        RobustError { standard_error: variance.sqrt(), degrees_of_freedom: degrees, doubt }
    }
}

/// The ratio of the mean squares of two waves and of `others` that chance exceeds in 0.5 % of all
/// cases: the quantile of the F distribution with 2 and `others` degrees of freedom, which has a
/// closed form.
fn beyond_chance(others: usize) -> f64 {
    let n = others as f64;
    0.5 * n * (0.005f64.powf(-2.0 / n) - 1.0)
}

#[cfg(test)]
mod tests;
