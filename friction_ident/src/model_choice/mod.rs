//! Which of several models to use.
//!
//! The choice goes by the error on what no fit has seen, and by nothing else. Then the
//! one-standard-error rule (Breiman, Friedman, Olshen and Stone 1984): of the models whose error is
//! at most one standard error above the best one's, the one with the fewest *free* parameters is
//! taken. The standard error is that of the best model's own error. Parameters count whether or not
//! the data determined them: a fit that knows nothing of its parameters is no simple model.
//!
//! A model whose fit cannot be trusted ([`unfit`]) takes no part.

mod unfit;

#[cfg(test)]
mod tests;

use crate::information::{AS_GOOD, Difference};
use crate::statistics::Sample;

pub use unfit::{Unfit, unfit};

/// What the choice goes by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// Mean square error on what no fit has seen \[N^2 or (N m)^2\].
    pub mean_square: f64,
    /// Standard error of that mean square, as of [`standard_error`].
    pub standard_error: f64,
    /// Parameters that were free in the fit.
    pub free_parameters: usize,
    /// Logarithm of its mean square over the best one's in the usual block, as of
    /// [`paired_ratio`](crate::information::paired_ratio).
    pub ln_ratio: Difference,
    /// Whether its fit can be trusted.
    pub fit: bool,
}

impl Candidate {
    /// Whether it is worse than the best by more than [`AS_GOOD`] in the usual block, clear of
    /// chance. A few moments that no model predicts, such as breakaways, make the error of a mean
    /// square so large that anything lies within it.
    fn usually_worse(&self) -> bool {
        self.ln_ratio.mean > 2.0 * AS_GOOD.ln() && !self.ln_ratio.is_tie()
    }
}

/// The place of the model to use: the simplest within one standard error of the best, the better
/// one of two alike. An error more than a fifth above the best is never taken for the sake of
/// simplicity, however uncertain the best one's is; nor one that is as much above it in the usual
/// block. None where no model can be trusted.
///
/// ```
/// use friction_ident::information::Difference;
/// use friction_ident::model_choice::{Candidate, choose};
///
/// let ln_ratio = Difference { mean: 0.0, standard_error: 0.1 };
/// let rich =
///     Candidate { mean_square: 1.00, standard_error: 0.08, free_parameters: 6, ln_ratio, fit: true };
/// let plain = Candidate { mean_square: 1.05, free_parameters: 2, ..rich };
/// let diverged = Candidate { mean_square: 0.90, free_parameters: 0, fit: false, ..rich };
/// assert_eq!(choose(&[rich, plain, diverged]), Some(1));
/// ```
#[must_use]
pub fn choose(candidates: &[Candidate]) -> Option<usize> {
    let trusted = || {
        let usable = |candidate: &Candidate| candidate.fit && candidate.mean_square.is_finite();
        candidates.iter().enumerate().filter(move |(_, candidate)| usable(candidate))
    };
    let (_, best) = trusted().min_by(|a, b| a.1.mean_square.total_cmp(&b.1.mean_square))?;
    // An error of which nothing is known gives no leave to be worse.
    let leave = if best.standard_error.is_finite() { best.standard_error.max(0.0) } else { 0.0 };
    let most = (best.mean_square + leave).min(AS_GOOD * AS_GOOD * best.mean_square);
    let within = trusted()
        .filter(|(_, candidate)| candidate.mean_square <= most && !candidate.usually_worse());
    let simplest = within.min_by(|(_, a), (_, b)| {
        let better = a.mean_square.total_cmp(&b.mean_square);
        a.free_parameters.cmp(&b.free_parameters).then(better)
    });
    simplest.map(|(place, _)| place)
}

/// Standard error of the mean square of residuals, from the scatter over contiguous blocks within
/// each kind of recording: neighbouring samples are alike, and what one kind shows otherwise than
/// another is no scatter. Each kind gets its part of `blocks`, two at least; infinite where no kind
/// has two residuals.
#[must_use]
pub fn standard_error(kinds: &[Vec<f64>], blocks: usize) -> f64 {
    let all: usize = kinds.iter().map(Vec::len).sum();
    let mut variance = 0.0;
    let mut seen = 0;
    for residuals in kinds.iter().filter(|residuals| residuals.len() > 1) {
        let n = residuals.len();
        let share = n as f64 / all as f64;
        let count = ((blocks as f64 * share) as usize).clamp(2, n);
        let mean_square = |block: usize| {
            let part = &residuals[block * n / count..(block + 1) * n / count];
            part.iter().map(|r| r * r).sum::<f64>() / part.len() as f64
        };
        let sample = Sample::of((0..count).map(mean_square));
        variance += share * share * sample.variance() / count as f64;
        seen += 1;
    }
    if seen == 0 { f64::INFINITY } else { variance.sqrt() }
}
