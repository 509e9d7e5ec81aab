//! Parameters drawn together, as likely as the recordings leave them.
//!
//! Laplace's approximation: about the estimates the posterior is a normal distribution with the
//! correlations of the fit. Each parameter is drawn in the coordinate, itself or its logarithm, in
//! which its interval is the more even about the value; what is left uneven is told by two half
//! normals (Wallis 2014, The two-piece normal distribution, Statistical Science 29, 106), so that the
//! median is the estimate and 95 % lie within the interval of the report, whatever the profile of
//! the likelihood made of it.
//!
//! ```
//! use friction_ident::posterior::{Marginal, draw};
//!
//! let f_c = Marginal { value: 0.10, standard_error: 0.01, interval: Some([0.08, 0.12]) };
//! let f_v = Marginal { value: 0.04, standard_error: 0.004, interval: Some([0.034, 0.05]) };
//! let drawn = draw(&[f_c, f_v], &[vec![1.0, -0.8], vec![-0.8, 1.0]], 1000, 7, |_| true)?;
//! let above = drawn.rows.iter().filter(|row| row[1] > 0.05).count();
//! assert!((10..40).contains(&above));
//! # Ok::<(), friction_ident::posterior::PosteriorError>(())
//! ```

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// The two-sided 95 % quantile of the normal distribution.
const Z_95: f64 = 1.959_963_984_540_054;
/// Draws a sample may take that is accepted.
const TRIES: usize = 200;

/// What is known of one parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Marginal {
    /// The estimate.
    pub value: f64,
    /// Its standard error; zero for one that is held.
    pub standard_error: f64,
    /// Ends of the 95 % interval, where there is one: the standard error counts where not.
    pub interval: Option<[f64; 2]>,
}

/// Why nothing can be drawn.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PosteriorError {
    /// The correlations are not a square of numbers as large as there are parameters.
    #[error("the correlations are not those of {0} parameters")]
    Correlation(usize),
    /// A value, a standard error or an interval is no number.
    #[error("parameter {0} has no finite value, standard error and interval around the value")]
    Marginal(usize),
    /// Next to nothing is accepted.
    #[error(
        "only {accepted} of {tried} draws are valid: the intervals reach far beyond what the model allows"
    )]
    Refused {
        /// Draws that were.
        accepted: usize,
        /// Draws.
        tried: usize,
    },
}

/// What was drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// A row a sample, in the order of the parameters.
    pub rows: Vec<Vec<f64>>,
    /// Draws that were not valid, beside those that are here.
    pub refused: usize,
}

/// A coordinate, and the half deviations below and above the value in it.
#[derive(Debug, Clone, Copy)]
struct Coordinate {
    logarithm: bool,
    at: f64,
    below: f64,
    above: f64,
}

impl Coordinate {
    /// None for what is no number.
    fn of(marginal: &Marginal) -> Option<Self> {
        let Marginal { value, standard_error, interval } = *marginal;
        let [low, high] =
            interval.unwrap_or([value - Z_95 * standard_error, value + Z_95 * standard_error]);
        let numbers = [value, standard_error, low, high].iter().all(|x| x.is_finite());
        if !numbers || standard_error < 0.0 || low > value || value > high {
            return None;
        }
        let plain = Self { logarithm: false, at: value, below: value - low, above: high - value };
        let uneven = |c: &Self| (c.above.max(c.below) + 1e-300) / (c.above.min(c.below) + 1e-300);
        let mut chosen = plain;
        if low > 0.0 {
            let at = value.ln();
            let logarithm =
                Self { logarithm: true, at, below: at - low.ln(), above: high.ln() - at };
            if uneven(&logarithm) < uneven(&plain) {
                chosen = logarithm;
            }
        }
        if standard_error == 0.0 && interval.is_none() {
            chosen = Self { below: 0.0, above: 0.0, ..plain };
        }
        Some(Self { below: chosen.below / Z_95, above: chosen.above / Z_95, ..chosen })
    }

    fn value(&self, z: f64) -> f64 {
        let moved = self.at + z * if z < 0.0 { self.below } else { self.above };
        if self.logarithm { moved.exp() } else { moved }
    }
}

/// `count` samples of parameters with these correlations, the same for the same seed. A draw that
/// `valid` refuses is drawn again.
///
/// # Errors
/// [`PosteriorError`].
pub fn draw(
    marginals: &[Marginal],
    correlation: &[Vec<f64>],
    count: usize,
    seed: u64,
    mut valid: impl FnMut(&[f64]) -> bool,
) -> Result<Drawn, PosteriorError> {
    let n = marginals.len();
    let coordinates: Vec<Coordinate> = (marginals.iter().enumerate())
        .map(|(i, marginal)| Coordinate::of(marginal).ok_or(PosteriorError::Marginal(i)))
        .collect::<Result<_, _>>()?;
    let root = root(correlation, n).ok_or(PosteriorError::Correlation(n))?;
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let (mut rows, mut refused) = (Vec::with_capacity(count), 0);
    while rows.len() < count {
        let normal = DVector::from_fn(n, |_, _| StandardNormal.sample(&mut rng));
        let z: DVector<f64> = &root * normal;
        let row: Vec<f64> = coordinates.iter().zip(&z).map(|(c, z)| c.value(*z)).collect();
        if valid(&row) {
            rows.push(row);
            continue;
        }
        refused += 1;
        if refused > TRIES * (rows.len() + 1) {
            let accepted = rows.len();
            return Err(PosteriorError::Refused { accepted, tried: accepted + refused });
        }
    }
    Ok(Drawn { rows, refused })
}

/// A root of the correlations, whose rows have length one. What rounding made negative is zero.
fn root(correlation: &[Vec<f64>], n: usize) -> Option<DMatrix<f64>> {
    if correlation.len() != n || correlation.iter().any(|row| row.len() != n) {
        return None;
    }
    let matrix = DMatrix::from_fn(n, n, |i, j| {
        if i == j { 1.0 } else { 0.5 * (correlation[i][j] + correlation[j][i]) }
    });
    if matrix.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let eigen = SymmetricEigen::new(matrix);
    let scale = eigen.eigenvalues.map(|value| value.max(0.0).sqrt());
    let mut root = &eigen.eigenvectors * DMatrix::from_diagonal(&scale);
    for mut row in root.row_iter_mut() {
        let length = row.norm();
        if length > 0.0 {
            row /= length;
        }
    }
    Some(root)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::{quantile, sorted};

    fn column(drawn: &Drawn, at: usize) -> Vec<f64> {
        sorted(drawn.rows.iter().map(|row| row[at]))
    }

    #[test]
    fn the_quantiles_are_those_of_the_report() {
        let even = Marginal { value: 2.0, standard_error: 0.5, interval: None };
        let skewed = Marginal { value: 1.0, standard_error: 0.4, interval: Some([0.5, 2.4]) };
        let held = Marginal { value: 3.0, standard_error: 0.0, interval: None };
        let identity: Vec<Vec<f64>> =
            (0..3).map(|i| (0..3).map(|j| f64::from(u8::from(i == j))).collect()).collect();
        let drawn = draw(&[even, skewed, held], &identity, 40_000, 1, |_| true).unwrap();
        let of = |at: usize, share: f64| quantile(&column(&drawn, at), share).unwrap();
        for (share, expected) in [(0.025, 0.5), (0.5, 1.0), (0.975, 2.4)] {
            assert!((of(1, share) / expected - 1.0).abs() < 0.03, "{share}: {}", of(1, share));
        }
        assert!((of(0, 0.975) - (2.0 + 0.5 * Z_95)).abs() < 0.03);
        assert!(column(&drawn, 2).iter().all(|x| *x == 3.0));
    }

    #[test]
    fn correlations_and_what_is_valid_are_kept() {
        let one = Marginal { value: 1.0, standard_error: 0.2, interval: None };
        let drawn =
            draw(&[one, one], &[vec![1.0, 0.9], vec![0.9, 1.0]], 20_000, 2, |_| true).unwrap();
        let mean = |f: &dyn Fn(&[f64]) -> f64| {
            drawn.rows.iter().map(|row| f(row)).sum::<f64>() / drawn.rows.len() as f64
        };
        let together = mean(&|row| (row[0] - 1.0) * (row[1] - 1.0)) / 0.04;
        assert!((together - 0.9).abs() < 0.03, "{together}");
        let ordered = |row: &[f64]| row[1] <= row[0];
        let some = draw(&[one, one], &[vec![1.0, 0.0], vec![0.0, 1.0]], 500, 3, ordered).unwrap();
        assert!(some.refused > 300 && some.rows.iter().all(|row| ordered(row)));
        let again = draw(&[one, one], &[vec![1.0, 0.0], vec![0.0, 1.0]], 500, 3, ordered).unwrap();
        assert_eq!(some, again);
    }

    #[test]
    fn what_cannot_be_drawn_is_told() {
        let one = Marginal { value: 1.0, standard_error: 0.2, interval: None };
        let refused = draw(&[one], &[vec![1.0]], 5, 1, |_| false).unwrap_err();
        assert!(matches!(refused, PosteriorError::Refused { accepted: 0, .. }));
        assert_eq!(draw(&[one], &[], 5, 1, |_| true).unwrap_err(), PosteriorError::Correlation(1));
        for wrong in [
            Marginal { value: f64::NAN, ..one },
            Marginal { interval: Some([1.1, 1.2]), ..one },
            Marginal { standard_error: -1.0, ..one },
        ] {
            let error = draw(&[wrong], &[vec![1.0]], 5, 1, |_| true).unwrap_err();
            assert_eq!(error, PosteriorError::Marginal(0));
        }
    }
}
