//! Numbers that may be computed with: matrix decompositions run for ever, or panic, on what is
//! none.

use nalgebra::{DMatrix, Dim, Dyn, Matrix, RawStorage, SVD, SymmetricEigen};

/// The largest magnitude of a sample. Nothing that is measured comes near, and its fourth power is
/// still a number.
pub const LARGEST: f64 = 1e50;
/// Steps after which a decomposition is given up; they take a few for each row.
const STEPS: usize = 10_000;

/// Whether a sample may be computed with.
pub(crate) fn usable(value: f64) -> bool {
    value.abs() <= LARGEST
}

/// The matrix, if all its entries are finite.
pub(crate) fn finite<R: Dim, C: Dim, S: RawStorage<f64, R, C>>(
    matrix: Matrix<f64, R, C, S>,
) -> Option<Matrix<f64, R, C, S>> {
    matrix.iter().all(|entry| entry.is_finite()).then_some(matrix)
}

/// Singular values of a finite matrix, with both sides.
pub(crate) fn singular_values(matrix: DMatrix<f64>) -> Option<SVD<f64, Dyn, Dyn>> {
    SVD::try_new(finite(matrix)?, true, true, 5.0 * f64::EPSILON, STEPS)
}

/// Eigenvalues and eigenvectors of a finite symmetric matrix.
pub(crate) fn symmetric_eigen(matrix: DMatrix<f64>) -> Option<SymmetricEigen<f64, Dyn>> {
    SymmetricEigen::try_new(finite(matrix)?, f64::EPSILON, STEPS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_is_not_decomposed() {
        for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut matrix = DMatrix::<f64>::identity(3, 3);
            matrix[(1, 2)] = wrong;
            assert!(singular_values(matrix.clone()).is_none() && symmetric_eigen(matrix).is_none());
            assert!(!usable(wrong));
        }
        for scale in [f64::MAX, f64::MIN_POSITIVE, 5e-324, 0.0, -0.0] {
            let matrix = DMatrix::from_element(3, 3, scale);
            // An answer or none: it ends.
            let _ = (singular_values(matrix.clone()), symmetric_eigen(matrix));
        }
        assert!(usable(1e-320) && usable(-0.0) && !usable(1e51));
    }
}
