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
//! What the model lacks repeats with the motion: along a periodic trajectory it cancels in time, and
//! the error in time says only that the same trajectory would give the same numbers again. So the
//! score is looked at in the order of each quantity of the motion too ([`Course::motion`]: velocity,
//! acceleration, position, way since the last reversal). White noise has the same variance in every
//! order; a residual that goes with the quantity is slow in its order, as a drift is in time. The
//! widest interval counts. That treats what is missing as drawn at random by nature, as Kennedy and
//! O'Hagan (2001, Journal of the Royal Statistical Society B 63, 425) do: the interval is one for
//! the parameter of the axis, not for the one that this model would have along this trajectory.
//!
//! Measurements of their own beside a recording ([`Course::points`]) have waves of their own. A few
//! dozen of them among thousands of samples are a small part of the rows, but each confirms the
//! others; the variances of both add up (Satterthwaite 1946, Biometrics Bulletin 2, 110).
//!
//! Where the slowest waves stand out of the others, the axis changed during the recording. The
//! error is then taken from these waves alone, with their few degrees of freedom, and the parameter
//! has a doubt.

use std::ops::Range;

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
/// Waves at most over measurements of their own, whose noise is white.
const MOST_OF_POINTS: usize = 64;
/// Waves at least.
const LEAST: usize = 4;
/// Independent stretches of the score below which no wave is slow enough.
const STRETCHES: f64 = 12.0;
/// Degrees of freedom below which an error is a guess.
const DEGREES: f64 = 2.5;
/// Factor by which the fit may have taken the score's slow waves away.
const LACKING: f64 = 4.0;
/// Share of a parameter's weight below which some rows have nothing to say of it.
const NOTHING: f64 = 1e-12;
/// Slowest waves, in which a drift shows.
const SLOW: usize = 2;
/// Waves over the range of a quantity of the motion. Few, because what a model lacks is smooth there
/// and would be diluted by more.
const ALONG_MOTION: usize = 6;
/// Factor by which the fit may have taken these away: it follows the motion itself.
const TAKEN_AWAY: f64 = 10.0;

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
    /// The motion has one speed, and the parameter changes with it.
    #[error(
        "the motion has one speed, and what changes with speed hangs on the turns alone, where all acts at once"
    )]
    OneSpeed,
    /// Other joints move, and act on what it stands for.
    #[error("other joints move beside this one, and act on it where it stands")]
    OtherJoints,
    /// What it belongs to is not to be trusted as a whole.
    #[error("the fit as a whole is not to be trusted, as the warnings say")]
    WholeFit,
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

impl RobustCovariance {
    /// The correlations of the errors, a row a parameter.
    pub fn correlation(&self) -> Vec<Vec<f64>> {
        let n = self.covariance.nrows();
        let error = |at: usize| self.covariance[(at, at)].sqrt();
        let between = |a: usize, b: usize| self.covariance[(a, b)] / (error(a) * error(b));
        let row = |a: usize| (0..n).map(|b| if a == b { 1.0 } else { between(a, b) }).collect();
        (0..n).map(row).collect()
    }
}

/// How the rows of a fit follow one another.
#[derive(Debug, Clone, Copy, Default)]
pub struct Course<'a> {
    /// Rows at the head that are measurements of their own, in no order of time: what one has of
    /// noise says nothing of the next. The others follow one another.
    pub points: usize,
    /// Lengths of the stretches without a gap of the others, in the order of time; beyond their sum
    /// rows count as another piece.
    pub pieces: &'a [usize],
    /// Quantities of the motion, one value a row: what the model does not have repeats with them.
    pub motion: &'a [Vec<f64>],
}

/// Errors of the parameters of a least-squares fit at its minimum.
///
/// `jacobian` has a row a sample in the order of time and a column a free parameter (leave out what
/// a bound holds); its sign does not matter. `residuals` are those of the fit.
///
/// None where columns depend on one another, something is not finite, or there are fewer than four
/// rows a column.
///
/// ```
/// use friction_ident::robust_covariance::{Course, robust_covariance};
/// use nalgebra::DMatrix;
///
/// // The mean of an alternating residual is as sure as white noise, or surer.
/// let residuals: Vec<f64> = (0..200).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
/// let course = Course { points: 0, pieces: &[200], motion: &[] };
/// let found = robust_covariance(&DMatrix::from_element(200, 1, 1.0), &residuals, &course).unwrap();
/// assert!(found.parameters[0].standard_error < 1.0 / 200f64.sqrt());
/// ```
pub fn robust_covariance(
    jacobian: &DMatrix<f64>,
    residuals: &[f64],
    course: &Course,
) -> Option<RobustCovariance> {
    let (rows, columns) = jacobian.shape();
    let points = course.points.min(rows);
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
    let apart = cosines_over(rows, 0..points, points.saturating_sub(1).min(MOST_OF_POINTS));
    let in_time = rows - points;
    let count = MOST.min(most_waves(in_time as f64)).min(in_time);
    let following = Fit { waves: &cosines_over(rows, points..rows, count), ..fit };
    for j in 0..columns {
        let of_points = Fit { waves: &apart, ..fit }.of_points(j, residuals, points);
        let of_time = following.error(j, residuals, points, course.pieces);
        parameters.push(together(of_points, of_time));
    }
    for quantity in course.motion {
        let order = order_of(quantity, rows);
        let sorted = |matrix: &DMatrix<f64>| matrix.select_rows(&order);
        let (scaled, weights) = (sorted(&scaled), sorted(&weights));
        let residuals: Vec<f64> = order.iter().map(|&row| residuals[row]).collect();
        let waves = cosines(rows, ALONG_MOTION);
        let fit = Fit { scaled: &scaled, inverse: &inverse, weights: &weights, waves: &waves };
        for (j, parameter) in parameters.iter_mut().enumerate() {
            fit.repeats(j, &residuals, parameter);
        }
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

/// Waves over some of the rows, zero at the others.
fn cosines_over(rows: usize, some: Range<usize>, count: usize) -> DMatrix<f64> {
    let mut waves = DMatrix::zeros(rows, count);
    if count > 0 {
        waves.rows_mut(some.start, some.len()).copy_from(&cosines(some.len(), count));
    }
    waves
}

/// The first waves over the rows, one a column, each of mean square one and mean zero.
fn cosines(rows: usize, count: usize) -> DMatrix<f64> {
    let step = std::f64::consts::PI / rows as f64;
    DMatrix::from_fn(rows, count, |t, b| {
        std::f64::consts::SQRT_2 * (step * (b + 1) as f64 * (t as f64 + 0.5)).cos()
    })
}

/// The rows in the order of a quantity.
fn order_of(quantity: &[f64], rows: usize) -> Vec<usize> {
    let of = |row: usize| quantity.get(row).copied().unwrap_or(f64::INFINITY);
    let mut order: Vec<usize> = (0..rows).collect();
    order.sort_by(|&a, &b| of(a).total_cmp(&of(b)));
    order
}

#[derive(Clone, Copy)]
struct Fit<'a> {
    scaled: &'a DMatrix<f64>,
    inverse: &'a DMatrix<f64>,
    weights: &'a DMatrix<f64>,
    waves: &'a DMatrix<f64>,
}

/// The waves of one parameter's score.
struct Waves {
    coefficients: Vec<f64>,
    /// Covariance of the coefficients for a white residual of size one, the fit counted.
    white: DMatrix<f64>,
    /// What each coefficient's variance would be without the fit.
    power: f64,
}

/// A variance from some waves.
struct OfWaves {
    variance: f64,
    degrees: f64,
    /// Factor by which the fit made the waves too small.
    lacks: f64,
}

impl Waves {
    /// Of the first `count` waves alone.
    fn first(&self, count: usize) -> OfWaves {
        let block = self.white.view((0, 0), (count, count));
        let trace = block.trace();
        if trace <= 0.0 {
            return OfWaves { variance: f64::INFINITY, degrees: 0.0, lacks: f64::INFINITY };
        }
        let lacks = (self.power * count as f64 / trace).max(1.0);
        OfWaves {
            variance: mean_square(&self.coefficients[..count]) * lacks,
            degrees: trace * trace / block.norm_squared(),
            lacks,
        }
    }
}

fn mean_square(of: &[f64]) -> f64 {
    of.iter().map(|c| c * c).sum::<f64>() / of.len().max(1) as f64
}

impl Fit<'_> {
    fn waves(&self, j: usize, residuals: &[f64], count: usize) -> Waves {
        let weight = self.weights.column(j);
        // Row b: how the residual enters the coefficient of wave b.
        let mut entering = self.waves.columns(0, count).clone_owned();
        for (mut row, w) in entering.row_iter_mut().zip(weight.iter()) {
            row *= *w;
        }
        let coefficients = entering
            .column_iter()
            .map(|column| column.iter().zip(residuals).map(|(c, r)| c * r).sum())
            .collect();
        let through = entering.tr_mul(self.scaled);
        let white = entering.tr_mul(&entering) - &through * self.inverse * through.transpose();
        Waves { coefficients, white, power: weight.norm_squared() }
    }

    /// Widens an error to what the residual repeats in the order of the rows. Where the fit has
    /// taken nearly all of that away, or all hangs on one end of the order, nothing is known.
    fn repeats(&self, j: usize, residuals: &[f64], error: &mut RobustError) {
        let OfWaves { variance, degrees, lacks } =
            self.waves(j, residuals, self.waves.ncols()).first(self.waves.ncols());
        if lacks > TAKEN_AWAY || degrees < DEGREES {
            return;
        }
        let (standard_error, degrees_of_freedom) = (variance.sqrt(), degrees);
        let wider = RobustError { standard_error, degrees_of_freedom, ..*error };
        if standard_error > error.standard_error && wider.half_width() > error.half_width() {
            *error = wider;
        }
    }

    /// What the measurements of their own add to the variance.
    fn of_points(&self, j: usize, residuals: &[f64], points: usize) -> Option<Part> {
        let power = self.weights.view((0, j), (points, 1)).norm_squared();
        let count = self.waves.ncols();
        if count == 0 || power <= NOTHING * self.weights.column(j).norm_squared() {
            return None;
        }
        let waves = Waves { power, ..self.waves(j, residuals, count) };
        let OfWaves { variance, degrees, lacks } = waves.first(count);
        Some(Part { variance, degrees, lacks, power, doubt: None })
    }

    /// What the rows that follow one another add to it.
    fn error(&self, j: usize, residuals: &[f64], from: usize, pieces: &[usize]) -> Option<Part> {
        let weight = self.weights.view((from, j), (residuals.len() - from, 1));
        let power = weight.norm_squared();
        if weight.is_empty() || power <= NOTHING * self.weights.column(j).norm_squared() {
            return None;
        }
        let score: Vec<f64> =
            weight.iter().zip(residuals.iter().skip(from)).map(|(w, r)| w * r).collect();
        let stretches = score.len() as f64 * effective_share_of(&score, pieces);
        let count = most_waves(stretches).min(self.waves.ncols());
        let waves = Waves { power, ..self.waves(j, residuals, count) };
        let OfWaves { mut variance, mut degrees, lacks } = waves.first(count);
        let mut doubt = None;
        let (slow, rest) = waves.coefficients.split_at(SLOW.min(count));
        let ratio = mean_square(slow) / mean_square(rest);
        if rest.len() >= SLOW && ratio > beyond_chance(rest.len()) {
            doubt = Some(ErrorDoubt::Drift { ratio });
            let of_slow = waves.first(SLOW.min(count));
            (variance, degrees) = (variance.max(of_slow.variance), of_slow.degrees);
        }
        if stretches < STRETCHES {
            doubt = Some(ErrorDoubt::FewStretches { found: stretches });
        }
        Some(Part { variance, degrees, lacks, power, doubt })
    }
}

/// What some of the rows add to the variance of a parameter.
struct Part {
    variance: f64,
    degrees: f64,
    /// Factor by which the fit made its waves too small.
    lacks: f64,
    /// How much of a white residual comes through these rows.
    power: f64,
    doubt: Option<ErrorDoubt>,
}

/// The error from both parts. A doubt of the recording counts where most of the error is its own.
fn together(of_points: Option<Part>, of_time: Option<Part>) -> RobustError {
    let parts: Vec<Part> = of_points.into_iter().chain(of_time).collect();
    let sum = |of: fn(&Part) -> f64| parts.iter().map(of).sum::<f64>();
    let variance = sum(|part| part.variance);
    let degrees = match &parts[..] {
        [only] => only.degrees,
        // Of a part that says nothing the variance has no end.
        _ if !variance.is_finite() => 0.0,
        _ => variance * variance / sum(|part| part.variance.powi(2) / part.degrees),
    };
    let lacks = sum(|part| part.power) / sum(|part| part.power / part.lacks);
    let most = |part: &&Part| 2.0 * part.variance >= variance;
    let mut doubt = parts.iter().filter(most).find_map(|part| part.doubt);
    if (degrees < DEGREES || lacks > LACKING || degrees.is_nan()) && doubt.is_none() {
        doubt = Some(ErrorDoubt::OneEvent { degrees });
    }
    RobustError { standard_error: variance.sqrt(), degrees_of_freedom: degrees, doubt }
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
