//! Polynomials and rational transfer functions with real coefficients.

use nalgebra::{Complex, DMatrix, Schur};

/// A polynomial; coefficients ascending, the last not zero but for the zero polynomial, which has
/// none.
#[derive(Debug, Clone, PartialEq)]
pub struct Polynomial(Vec<f64>);

impl Polynomial {
    /// From the coefficients of `1, s, s^2, ...`; zeros at the end are dropped.
    #[must_use]
    pub fn new(mut coefficients: Vec<f64>) -> Self {
        while coefficients.last() == Some(&0.0) {
            coefficients.pop();
        }
        Self(coefficients)
    }

    /// The coefficients, ascending.
    #[must_use]
    pub fn coefficients(&self) -> &[f64] {
        &self.0
    }

    /// The degree; that of the zero polynomial is taken as zero.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.0.len().saturating_sub(1)
    }

    /// The coefficient of the highest power.
    #[must_use]
    pub fn leading(&self) -> f64 {
        self.0.last().copied().unwrap_or(0.0)
    }

    /// Value at `x`.
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, c| sum * x + c)
    }

    /// Value at `s`.
    #[must_use]
    pub fn at_complex(&self, s: Complex<f64>) -> Complex<f64> {
        self.0.iter().rev().fold(Complex::new(0.0, 0.0), |sum, c| sum * s + c)
    }

    /// Sum of the magnitudes of the terms at `x`: what a rounding error of [`at`](Self::at) is
    /// measured by.
    #[must_use]
    pub fn magnitude_at(&self, x: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, c| sum * x.abs() + c.abs())
    }

    /// `self + factor other`.
    #[must_use]
    pub fn plus(&self, factor: f64, other: &Self) -> Self {
        let at = |p: &Self, k: usize| p.0.get(k).copied().unwrap_or(0.0);
        Self::new(
            (0..self.0.len().max(other.0.len()))
                .map(|k| at(self, k) + factor * at(other, k))
                .collect(),
        )
    }

    /// `self other`.
    #[must_use]
    pub fn times(&self, other: &Self) -> Self {
        if self.0.is_empty() || other.0.is_empty() {
            return Self(Vec::new());
        }
        let mut product = vec![0.0; self.0.len() + other.0.len() - 1];
        for (i, a) in self.0.iter().enumerate() {
            for (sum, b) in product[i..].iter_mut().zip(&other.0) {
                *sum += a * b;
            }
        }
        Self::new(product)
    }

    /// The derivative.
    #[must_use]
    pub fn derivative(&self) -> Self {
        Self::new(self.0.iter().enumerate().skip(1).map(|(k, c)| k as f64 * c).collect())
    }

    /// Even and odd part as polynomials in `s^2`: `p(s) = even(s^2) + s odd(s^2)`.
    #[must_use]
    pub fn even_and_odd(&self) -> (Self, Self) {
        let every_other =
            |from: usize| Self::new(self.0.iter().skip(from).step_by(2).copied().collect());
        (every_other(0), every_other(1))
    }

    /// `p(-x)`.
    #[must_use]
    pub fn reflected(&self) -> Self {
        Self::new(
            self.0.iter().enumerate().map(|(k, c)| if k % 2 == 0 { *c } else { -c }).collect(),
        )
    }

    /// All roots: the eigenvalues of the companion matrix, scaled so that its entries are of one
    /// size, each improved by Newton's method.
    ///
    /// `None` if the eigenvalues do not converge or a coefficient is not finite.
    #[must_use]
    pub fn roots(&self) -> Option<Vec<Complex<f64>>> {
        let zeros = self.0.iter().take_while(|c| **c == 0.0).count();
        let rest = &self.0[zeros.min(self.0.len())..];
        let mut roots = vec![Complex::new(0.0, 0.0); if rest.is_empty() { 0 } else { zeros }];
        let n = rest.len().saturating_sub(1);
        if n == 0 {
            return Some(roots);
        }
        // With x = size y all coefficients of y are of comparable size.
        let size = (rest[0] / rest[n]).abs().powf(1.0 / n as f64);
        if !(size.is_finite() && size > 0.0 && rest.iter().all(|c| c.is_finite())) {
            return None;
        }
        let scaled: Vec<f64> = rest
            .iter()
            .enumerate()
            .map(|(k, c)| c / rest[n] * size.powi(k as i32 - n as i32))
            .collect();
        // Coefficients of very different size leave the range of numbers; a decomposition of what
        // is none would not end.
        if !scaled.iter().all(|c| c.is_finite()) {
            return None;
        }
        let companion = DMatrix::from_fn(n, n, |i, j| {
            if j == n - 1 {
                -scaled[i]
            } else if i == j + 1 {
                1.0
            } else {
                0.0
            }
        });
        let schur = Schur::try_new(companion, f64::EPSILON, 10_000)?;
        let derivative = self.derivative();
        for y in schur.complex_eigenvalues().iter() {
            let mut x = y * size;
            for _ in 0..3 {
                let step = self.at_complex(x) / derivative.at_complex(x);
                // At a multiple root the step may lead away: only one that helps is taken.
                if !step.is_finite()
                    || self.at_complex(x - step).norm() >= self.at_complex(x).norm()
                {
                    break;
                }
                x -= step;
            }
            roots.push(x);
        }
        Some(roots)
    }

    /// Real roots above zero, ascending: those whose imaginary part is no more than rounding, or a
    /// double root pulled apart by it.
    #[must_use]
    pub fn positive_roots(&self) -> Option<Vec<f64>> {
        let mut real: Vec<f64> = self
            .roots()?
            .into_iter()
            .filter(|root| root.re > 0.0 && root.im.abs() <= 1e-6 * root.norm())
            .map(|root| root.re)
            .collect();
        real.sort_by(f64::total_cmp);
        Some(real)
    }

    /// Whether all roots have a negative real part (Routh's criterion, no tolerance).
    #[must_use]
    pub fn is_hurwitz(&self) -> bool {
        let n = self.degree();
        if self.0.is_empty() || !self.0.iter().all(|c| c * self.leading() > 0.0) {
            return false;
        }
        let descending = |from: usize| -> Vec<f64> {
            self.0.iter().rev().skip(from).step_by(2).copied().collect()
        };
        let (mut upper, mut lower) = (descending(0), descending(1));
        for _ in 1..n {
            let Some((&top, &pivot)) = upper.first().zip(lower.first()) else { return false };
            let at = |row: &[f64], k: usize| row.get(k).copied().unwrap_or(0.0);
            let next: Vec<f64> =
                (1..upper.len()).map(|k| at(&upper, k) - top / pivot * at(&lower, k)).collect();
            let first = next.first().copied().unwrap_or(0.0) * self.leading();
            if first <= 0.0 || first.is_nan() {
                return false;
            }
            (upper, lower) = (lower, next);
        }
        true
    }
}

/// A rational transfer function.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferFunction {
    /// Numerator.
    pub numerator: Polynomial,
    /// Denominator.
    pub denominator: Polynomial,
}

impl TransferFunction {
    /// From ascending coefficients.
    #[must_use]
    pub fn new(numerator: Vec<f64>, denominator: Vec<f64>) -> Self {
        Self { numerator: Polynomial::new(numerator), denominator: Polynomial::new(denominator) }
    }

    /// Value at `s`.
    #[must_use]
    pub fn at(&self, s: Complex<f64>) -> Complex<f64> {
        self.numerator.at_complex(s) / self.denominator.at_complex(s)
    }

    /// Value at the frequency `w` \[rad/s\].
    #[must_use]
    pub fn at_frequency(&self, w: f64) -> Complex<f64> {
        self.at(Complex::new(0.0, w))
    }

    /// The real part of numerator times conjugate denominator at the frequency w, as a polynomial
    /// in `x = w^2`: its sign is that of the real part.
    #[must_use]
    pub fn real_part(&self) -> Polynomial {
        let (n_even, n_odd) = self.numerator.even_and_odd();
        let (d_even, d_odd) = self.denominator.even_and_odd();
        // With y = s^2 = -w^2 the real part is n_even d_even - y n_odd d_odd.
        let odd = n_odd.times(&d_odd).times(&Polynomial::new(vec![0.0, 1.0]));
        n_even.times(&d_even).plus(-1.0, &odd).reflected()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn from_roots(roots: &[f64]) -> Polynomial {
        roots
            .iter()
            .fold(Polynomial::new(vec![1.0]), |p, root| p.times(&Polynomial::new(vec![-root, 1.0])))
    }

    #[test]
    fn roots_of_very_different_size_are_found() {
        let expected = [1e-3, 0.5, 40.0, 1e4];
        let found = from_roots(&expected).positive_roots().unwrap();
        for (found, expected) in found.iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
        }
        assert_eq!(found.len(), 4);
    }

    #[test]
    fn the_zero_polynomial_and_constants_have_no_roots() {
        assert_eq!(Polynomial::new(vec![0.0, 0.0]).roots(), Some(vec![]));
        assert_eq!(Polynomial::new(vec![3.0]).roots(), Some(vec![]));
        assert_eq!(Polynomial::new(vec![0.0, 0.0, 2.0]).roots().unwrap().len(), 2);
    }

    proptest! {
        /// Routh's criterion agrees with the roots themselves.
        #[test]
        fn routh_agrees_with_the_roots(coefficients in prop::collection::vec(-1.0f64..5.0, 2..7)) {
            let p = Polynomial::new(coefficients);
            prop_assume!(p.degree() > 0 && p.leading().abs() > 1e-3);
            let largest = p.roots().unwrap().iter().map(|root| root.re).fold(f64::NEG_INFINITY, f64::max);
            prop_assume!(largest.abs() > 1e-6);
            prop_assert_eq!(p.is_hurwitz(), largest < 0.0);
        }

        #[test]
        fn the_real_part_is_that_of_the_value(
            numerator in prop::collection::vec(-3.0f64..3.0, 1..5),
            denominator in prop::collection::vec(0.1f64..3.0, 1..5),
            w in 0.0f64..5.0,
        ) {
            let g = TransferFunction::new(numerator, denominator);
            let s = Complex::new(0.0, w);
            let expected = (g.numerator.at_complex(s) * g.denominator.at_complex(s).conj()).re;
            prop_assert!((g.real_part().at(w * w) - expected).abs() < 1e-9 * (1.0 + g.real_part().magnitude_at(w * w)));
        }
    }
}
