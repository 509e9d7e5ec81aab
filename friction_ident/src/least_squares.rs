//! Linear least squares with column scaling: QR of the tall matrix, then the singular values of its
//! small factor.

use nalgebra::{DMatrix, DVector};

use crate::finite::{finite, singular_values};

/// The solution of `a x = y` in the least squares sense.
pub(crate) struct Solution {
    /// The unknowns.
    pub x: DVector<f64>,
    /// Inverse of `a^T a`: times the residual variance, the covariance of `x`.
    pub inverse_normal: DMatrix<f64>,
    /// `y - a x`.
    pub residual: DVector<f64>,
}

impl Solution {
    /// The same among `count` unknowns, of which only those in `taken` were solved for: the others are
    /// zero.
    pub fn among(self, taken: &[usize], count: usize) -> Self {
        let mut x = DVector::zeros(count);
        let mut inverse_normal = DMatrix::zeros(count, count);
        for (from, &to) in taken.iter().enumerate() {
            x[to] = self.x[from];
            for (other, &there) in taken.iter().enumerate() {
                inverse_normal[(to, there)] = self.inverse_normal[(from, other)];
            }
        }
        Self { x, inverse_normal, residual: self.residual }
    }
}

/// Columns that the data do not tell apart.
#[derive(Debug, PartialEq)]
pub(crate) struct Degenerate {
    /// Their indices.
    pub columns: Vec<usize>,
}

/// Below this ratio of singular values (of columns scaled to unit length) columns count as
/// dependent.
const DEPENDENT: f64 = 1e-9;

/// Solves `a x = y`; `a` has at least as many rows as columns. Entries that are not finite, or so
/// large that the solution is not, leave all columns untold.
pub(crate) fn solve(a: &DMatrix<f64>, y: &DVector<f64>) -> Result<Solution, Degenerate> {
    let columns = a.ncols();
    let all = || Degenerate { columns: (0..columns).collect() };
    let scale = DVector::from_iterator(columns, a.column_iter().map(|column| column.norm()));
    let empty: Vec<_> = (0..columns).filter(|&j| scale[j] == 0.0).collect();
    if !empty.is_empty() {
        return Err(Degenerate { columns: empty });
    }
    let mut scaled = a.clone();
    for (mut column, factor) in scaled.column_iter_mut().zip(scale.iter()) {
        column /= *factor;
    }
    let qr = finite(scaled).ok_or_else(all)?.qr();
    let mut rotated = y.clone();
    qr.q_tr_mul(&mut rotated);
    let svd = singular_values(qr.unpack_r()).ok_or_else(all)?;
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else { return Err(all()) };
    let largest = svd.singular_values.max();
    let (last, smallest) = svd.singular_values.argmin();
    if smallest <= DEPENDENT * largest || smallest.is_nan() {
        let direction = v_t.row(last);
        let columns =
            (0..columns).filter(|&j| direction[j].abs() >= 0.05 || direction[j].is_nan()).collect();
        return Err(Degenerate { columns });
    }
    let mut weights = u.tr_mul(&rotated.rows(0, columns));
    let mut spread = v_t.transpose();
    for (j, value) in svd.singular_values.iter().enumerate() {
        weights[j] /= *value;
        spread.column_mut(j).scale_mut(1.0 / *value);
    }
    let mut x = v_t.tr_mul(&weights);
    x.component_div_assign(&scale);
    let mut inverse_normal = &spread * spread.transpose();
    for i in 0..columns {
        for j in 0..columns {
            inverse_normal[(i, j)] /= scale[i] * scale[j];
        }
    }
    let x = finite(x).ok_or_else(all)?;
    let residual = finite(y - a * &x).ok_or_else(all)?;
    Ok(Solution { x, inverse_normal, residual })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_and_propagates() {
        // A line through four points; closed form by hand.
        let a = DMatrix::from_row_slice(4, 2, &[1.0, 0.0, 1.0, 1.0, 1.0, 2.0, 1.0, 3.0]);
        let y = DVector::from_row_slice(&[1.0, 3.0, 4.0, 8.0]);
        let solution = solve(&a, &y).ok().unwrap();
        assert!((solution.x[0] - 0.7).abs() < 1e-12 && (solution.x[1] - 2.2).abs() < 1e-12);
        assert!((solution.inverse_normal[(1, 1)] - 0.2).abs() < 1e-12);
        assert!((solution.inverse_normal[(0, 0)] - 0.7).abs() < 1e-12);
        assert!((solution.inverse_normal[(0, 1)] + 0.3).abs() < 1e-12);
    }

    #[test]
    fn names_the_dependent_columns() {
        let mut a = DMatrix::from_fn(20, 4, |i, j| ((i * (j + 2)) as f64).sin());
        let twice = a.column(1) * 2.0;
        a.set_column(3, &twice);
        let y = DVector::from_element(20, 1.0);
        assert_eq!(solve(&a, &y).err(), Some(Degenerate { columns: vec![1, 3] }));
        a.fill_column(0, 0.0);
        assert_eq!(solve(&a, &y).err(), Some(Degenerate { columns: vec![0] }));
    }

    #[test]
    fn extreme_numbers_get_an_answer_or_none() {
        let y = DVector::from_element(20, 1.0);
        for wrong in [f64::NAN, f64::INFINITY, 1e308, -1e308, 1e-320, -0.0, 1e-160] {
            let mut a = DMatrix::from_fn(20, 3, |i, j| ((i * (j + 2)) as f64).sin());
            a[(4, 1)] = wrong;
            if let Ok(solution) = solve(&a, &y) {
                assert!(
                    solution.x.iter().chain(solution.residual.iter()).all(|x| x.is_finite()),
                    "{wrong}"
                );
            } else {
                assert!(!wrong.is_finite() || wrong.abs() > 1e300, "{wrong}");
            }
            let mut high = y.clone();
            high[3] = wrong;
            let a = DMatrix::from_fn(20, 3, |i, j| ((i * (j + 2)) as f64).sin());
            match solve(&a, &high) {
                Ok(solution) => assert!(solution.x.iter().all(|x| x.is_finite()), "{wrong}"),
                Err(_) => assert!(!wrong.is_finite() || wrong.abs() > 1e300, "{wrong}"),
            }
        }
    }
}
