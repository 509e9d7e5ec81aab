//! How well a model fits for the number of its parameters, and which of two models predicts better.

use serde::{Deserialize, Deserializer, Serialize};

use crate::statistics::Sample;

/// Fit and information criteria of one model on one set of residuals.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Information {
    /// Residuals.
    pub samples: usize,
    /// Residuals that count as independent.
    pub effective_samples: f64,
    /// Free parameters.
    pub parameters: usize,
    /// Mean square.
    pub mse: f64,
    /// Akaike's criterion `n ln mse + 2 k` (1974), over the effective samples. Only differences
    /// between models on the same data count.
    pub aic: f64,
    /// Schwarz's criterion `n ln mse + k ln n` (1978), likewise.
    pub bic: f64,
}

impl Information {
    /// From a mean square over `samples` residuals of which `share` count as independent.
    pub fn new(mse: f64, samples: usize, share: f64, parameters: usize) -> Self {
        let n = samples as f64 * share;
        let fit = n * mse.max(f64::MIN_POSITIVE).ln();
        let k = parameters as f64;
        Self {
            samples,
            effective_samples: n,
            parameters,
            mse,
            aic: fit + 2.0 * k,
            bic: fit + k * n.max(1.0).ln(),
        }
    }
}

/// By how much one model predicts worse than another, paired over blocks of the same data.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Difference {
    /// Mean of the differences of the blocks' mean squares, above zero where the first model is
    /// worse.
    #[serde(deserialize_with = "or_nan")]
    pub mean: f64,
    /// Standard error of the mean, from the scatter over the blocks.
    #[serde(deserialize_with = "or_nan")]
    pub standard_error: f64,
}

/// Reads the `null` that JSON has for what is no number: `#[serde(deserialize_with = "or_nan")]`.
///
/// # Errors
/// What `from` says of anything else.
pub fn or_nan<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    <Option<f64> as Deserialize>::deserialize(from).map(|value| value.unwrap_or(f64::NAN))
}

impl Difference {
    /// Whether the two cannot be told apart: the difference is within two of its standard errors.
    pub fn is_tie(&self) -> bool {
        self.mean.abs() <= 2.0 * self.standard_error
    }
}

/// Errors that differ by less are as good as equal, as a ratio: nobody would notice, whichever
/// model compensates.
pub const AS_GOOD: f64 = 1.2;

/// How a model stands beside the best one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Standing {
    /// The two cannot be told apart: their difference lies within its uncertainty, and it is small.
    Alike,
    /// The data show that it is worse.
    Worse,
    /// Its error is larger by more than a little, but the difference lies within its uncertainty:
    /// these data do not decide.
    Undecided,
}

impl Standing {
    /// From the root mean squares of both and whether their difference lies `within` its
    /// uncertainty.
    pub fn of(error: f64, best: f64, within: bool) -> Self {
        match within {
            false => Self::Worse,
            // What is not a number is not small.
            true if error <= AS_GOOD * best => Self::Alike,
            true => Self::Undecided,
        }
    }
}

/// Compares two models' residuals on the same samples, paired over `blocks` contiguous blocks:
/// neighbouring samples are alike, blocks are nearly independent. Needs two blocks of at least one
/// sample; otherwise the standard error is infinite.
pub fn paired_difference(first: &[f64], second: &[f64], blocks: usize) -> Difference {
    paired(first, second, blocks, |first, second| first - second)
}

/// The same of the logarithms of the blocks' mean squares. A few blocks with large errors make the
/// standard error of the difference large; here a model that is worse in nearly every block is told
/// from the other all the same.
pub fn paired_ratio(first: &[f64], second: &[f64], blocks: usize) -> Difference {
    // A block without any residual is as good as the smallest number.
    let ln = |mean_square: f64| mean_square.max(f64::MIN_POSITIVE).ln();
    paired(first, second, blocks, |first, second| ln(first) - ln(second))
}

fn paired(
    first: &[f64],
    second: &[f64],
    blocks: usize,
    compare: impl Fn(f64, f64) -> f64,
) -> Difference {
    let n = first.len().min(second.len());
    let blocks = blocks.min(n);
    if blocks < 2 {
        return Difference { mean: 0.0, standard_error: f64::INFINITY };
    }
    let size = n / blocks;
    let differences: Vec<f64> = (0..blocks)
        .map(|block| {
            let range = block * size..(block + 1) * size;
            let square =
                |r: &[f64]| r[range.clone()].iter().map(|r| r * r).sum::<f64>() / size as f64;
            compare(square(first), square(second))
        })
        .collect();
    let sample = Sample::of(differences.into_iter());
    let standard_error = (sample.variance() / blocks as f64).sqrt();
    Difference { mean: sample.mean, standard_error }
}

/// Differences of several kinds of recording put together, each weighed by its samples. What one
/// kind shows otherwise than another is no scatter: only the scatter within the kinds counts.
pub fn stratified(kinds: &[(Difference, usize)]) -> Difference {
    let all = kinds.iter().map(|(_, n)| *n).sum::<usize>().max(1) as f64;
    let weigh = |n: &usize| *n as f64 / all;
    let mean = kinds.iter().map(|(difference, n)| weigh(n) * difference.mean).sum();
    let variance: f64 =
        kinds.iter().map(|(difference, n)| (weigh(n) * difference.standard_error).powi(2)).sum();
    Difference { mean, standard_error: variance.sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn criteria_have_their_closed_forms() {
        let found = Information::new(0.25, 100, 1.0, 3);
        assert!((found.aic - (100.0 * 0.25f64.ln() + 6.0)).abs() < 1e-12);
        assert!((found.bic - (100.0 * 0.25f64.ln() + 3.0 * 100f64.ln())).abs() < 1e-12);
        // Twice the samples by counting each twice is no more evidence.
        let doubled = Information::new(0.25, 200, 0.5, 3);
        assert!((doubled.aic - found.aic).abs() < 1e-12);
    }

    /// The difference of two and a half times and of fifteen times the error may be uncertain,
    /// small it is not.
    #[test]
    fn a_large_difference_is_never_called_none() {
        assert_eq!(Standing::of(1.05, 1.0, true), Standing::Alike);
        assert_eq!(Standing::of(2.4, 1.0, true), Standing::Undecided);
        assert_eq!(Standing::of(15.0, 1.0, true), Standing::Undecided);
        assert_eq!(Standing::of(15.0, 1.0, false), Standing::Worse);
        assert_eq!(Standing::of(1.05, 1.0, false), Standing::Worse);
        assert_eq!(Standing::of(f64::NAN, 1.0, true), Standing::Undecided);
        assert_eq!(Standing::of(0.0, 0.0, true), Standing::Alike);
    }

    #[test]
    fn kinds_are_weighed_by_their_samples() {
        let of = |mean, standard_error| Difference { mean, standard_error };
        let both = stratified(&[(of(1.0, 0.3), 300), (of(-1.0, 0.4), 100)]);
        assert!((both.mean - 0.5).abs() < 1e-15);
        assert!((both.standard_error - (0.225f64.powi(2) + 0.1f64.powi(2)).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn a_clear_difference_is_told_from_a_tie() {
        let noise =
            |i: usize, seed: usize| ((i * 7919 + seed * 104_729) % 1009) as f64 / 504.5 - 1.0;
        let first: Vec<f64> = (0..2000).map(|i| noise(i, 1)).collect();
        let second: Vec<f64> = (0..2000).map(|i| noise(i, 2)).collect();
        let worse: Vec<f64> = (0..2000).map(|i| 1.3 * noise(i, 3)).collect();
        assert!(paired_difference(&first, &second, 20).is_tie());
        let difference = paired_difference(&worse, &first, 20);
        assert!(!difference.is_tie() && difference.mean > 0.0, "{difference:?}");
        assert!(paired_difference(&first, &second, 1).standard_error.is_infinite());
    }

    /// Three times the error in every block, and in one block a hundred times: the mean is blurred
    /// by that block, the ratio is not.
    #[test]
    fn a_model_that_is_worse_everywhere_is_told_from_another_in_spite_of_one_bad_block() {
        let noise =
            |i: usize, seed: usize| ((i * 7919 + seed * 104_729) % 1009) as f64 / 504.5 - 1.0;
        let best: Vec<f64> = (0..2000).map(|i| noise(i, 1)).collect();
        let worse: Vec<f64> = (0..2000)
            .map(|i| if i < 100 { 100.0 * noise(i, 2) } else { 3.0 * noise(i, 2) })
            .collect();
        assert!(paired_difference(&worse, &best, 20).is_tie());
        let ratio = paired_ratio(&worse, &best, 20);
        assert!(!ratio.is_tie() && ratio.mean > 9f64.ln(), "{ratio:?}");
        let other: Vec<f64> = (0..2000).map(|i| noise(i, 3)).collect();
        assert!(paired_ratio(&other, &best, 20).is_tie());
        assert!(paired_ratio(&best, &best, 20).is_tie());
    }
}
