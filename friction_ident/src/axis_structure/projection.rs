//! Linear least squares by normal equations of columns scaled to unit length: quick enough to be done
//! for every trial of a search. The final parameters come from the factorisation of the columns
//! themselves.

use std::ops::Range;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::finite::finite;

/// Columns that a force can be projected on.
pub(super) struct Projection {
    scaled: DMatrix<f64>,
    scale: DVector<f64>,
    factor: Cholesky<f64, Dyn>,
    /// How many linear parameters there are, and which of them the columns belong to.
    count: usize,
    taken: Vec<usize>,
    /// Parameters that are so many times those before them, as many as they.
    tied: Option<(Range<usize>, f64)>,
}

impl Projection {
    /// None for columns that depend on one another.
    pub fn new(mut matrix: DMatrix<f64>) -> Option<Self> {
        let scale = DVector::from_iterator(
            matrix.ncols(),
            matrix.column_iter().map(|column| column.norm()),
        );
        if scale.iter().any(|norm| *norm == 0.0) {
            return None;
        }
        matrix.column_iter_mut().zip(scale.iter()).for_each(|(mut column, norm)| column /= *norm);
        let factor = finite(matrix.tr_mul(&matrix))?.cholesky()?;
        let count = matrix.ncols();
        Some(Self { scaled: matrix, scale, factor, count, taken: (0..count).collect(), tied: None })
    }

    /// The same where the parameters in `not_below_zero` may not be: those that `force` would push
    /// there stay at zero. No friction drives.
    pub fn bounded(
        matrix: DMatrix<f64>,
        force: &DVector<f64>,
        not_below_zero: Range<usize>,
    ) -> Option<Self> {
        let mut left = Self::new(matrix)?;
        while !not_below_zero.is_empty() {
            let weights = left.factor.solve(&left.scaled.tr_mul(force));
            let away = below_zero(&weights, &left.taken, &not_below_zero);
            if away.is_empty() {
                return Some(left);
            }
            let scaled = left.scaled.remove_columns_at(&away);
            let factor = finite(scaled.tr_mul(&scaled))?.cholesky()?;
            let scale = left.scale.remove_rows_at(&away);
            let taken = without(&left.taken, &away);
            left = Self { scaled, scale, factor, taken, ..left };
        }
        Some(left)
    }

    /// The same where the parameters in `tied`, levels at rest, are `ratio` times those before them,
    /// the kinetic ones.
    pub fn tied(mut matrix: DMatrix<f64>, tied: Range<usize>, ratio: f64) -> Option<Self> {
        let count = matrix.ncols();
        for j in tied.clone() {
            let both = matrix.column(j - tied.len()) + ratio * matrix.column(j);
            matrix.set_column(j - tied.len(), &both);
        }
        let away: Vec<usize> = tied.clone().collect();
        let few = Self::new(matrix.remove_columns_at(&away))?;
        let taken = (0..count).filter(|j| !tied.contains(j)).collect();
        Some(Self { count, taken, tied: Some((tied, ratio)), ..few })
    }

    /// The linear parameters for `y` and what they leave of it.
    pub fn rest(&self, y: &DVector<f64>) -> (DVector<f64>, DVector<f64>) {
        let weights = self.factor.solve(&self.scaled.tr_mul(y));
        let rest = y - &self.scaled * &weights;
        let mut linear = DVector::zeros(self.count);
        for (&j, (weight, scale)) in self.taken.iter().zip(weights.iter().zip(self.scale.iter())) {
            linear[j] = weight / scale;
        }
        if let Some((tied, ratio)) = &self.tied {
            tied.clone().for_each(|j| linear[j] = ratio * linear[j - tied.len()]);
        }
        (linear, rest)
    }
}

/// Places of the values that lie below zero, of parameters `taken` that may not: those in `range`.
pub(super) fn below_zero(
    values: &DVector<f64>,
    taken: &[usize],
    range: &Range<usize>,
) -> Vec<usize> {
    let all = taken.iter().zip(values.iter()).enumerate();
    let below = all.filter(|(_, (j, value))| range.contains(j) && **value < 0.0);
    below.map(|(place, _)| place).collect()
}

/// The parameters `taken` but for those at the places `away`.
pub(super) fn without(taken: &[usize], away: &[usize]) -> Vec<usize> {
    let all = taken.iter().enumerate().filter(|(place, _)| !away.contains(place));
    all.map(|(_, &j)| j).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of `y = 2 a - b` with columns at right angles: `b` at zero leaves the whole of `-b` over.
    #[test]
    fn a_parameter_that_may_not_be_below_zero_stays_there() {
        let a = DMatrix::from_row_slice(4, 2, &[1.0, 1.0, 1.0, -1.0, 1.0, 1.0, 1.0, -1.0]);
        let y = DVector::from_row_slice(&[1.0, 3.0, 1.0, 3.0]);
        let free = Projection::new(a.clone()).unwrap().rest(&y);
        assert!((free.0[0] - 2.0).abs() < 1e-12 && (free.0[1] + 1.0).abs() < 1e-12);
        assert!(free.1.norm() < 1e-12);
        let bounded = Projection::bounded(a.clone(), &y, 1..2).unwrap().rest(&y);
        assert!((bounded.0[0] - 2.0).abs() < 1e-12 && bounded.0[1] == 0.0, "{}", bounded.0);
        assert!((bounded.1 - DVector::from_row_slice(&[-1.0, 1.0, -1.0, 1.0])).norm() < 1e-12);
        // The other way `b` is above zero, and nothing holds it.
        let free = Projection::bounded(a, &(-&y), 1..2).unwrap().rest(&-y);
        assert!((free.0[1] - 1.0).abs() < 1e-12 && free.1.norm() < 1e-12, "{}", free.0);
    }

    /// Of `y = 2 a - 3 b + 0.5 c` with `b` and `c` alike: without `b`, `c` goes below zero too.
    #[test]
    fn one_that_is_let_go_may_push_another_below_zero() {
        let a = DMatrix::from_row_slice(3, 3, &[1.0, 0.0, 0.0, 0.0, 1.0, 0.8, 0.0, 0.0, 0.6]);
        let y = DVector::from_row_slice(&[2.0, -2.6, 0.3]);
        let free = Projection::new(a.clone()).unwrap().rest(&y).0;
        assert!((free - DVector::from_row_slice(&[2.0, -3.0, 0.5])).norm() < 1e-12);
        let (x, rest) = Projection::bounded(a, &y, 1..3).unwrap().rest(&y);
        assert_eq!((x[1], x[2]), (0.0, 0.0));
        assert!((x[0] - 2.0).abs() < 1e-12 && (rest.norm() - 2.6f64.hypot(0.3)).abs() < 1e-12);
    }

    /// Three times the first column and six times the second.
    #[test]
    fn a_tied_parameter_follows() {
        let a = DMatrix::from_row_slice(3, 2, &[1.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
        let y = DVector::from_row_slice(&[3.0, 6.0, 9.0]);
        let (x, rest) = Projection::tied(a.clone(), 1..2, 2.0).unwrap().rest(&y);
        assert!((x - DVector::from_row_slice(&[3.0, 6.0])).norm() < 1e-12 && rest.norm() < 1e-12);
        let (x, rest) = Projection::tied(a, 1..2, 1.0).unwrap().rest(&y);
        assert!((x[0] - 4.5).abs() < 1e-12 && x[0] == x[1] && rest.norm() > 1.0);
    }
}
