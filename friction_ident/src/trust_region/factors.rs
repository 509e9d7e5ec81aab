//! The linear problem of one step: `J = Q R P^T`, solved for any damping.

use nalgebra::{DMatrix, DVector, DVectorView, DVectorViewMut, Dyn, Storage, Vector};

/// Length of a vector, its squares summed in order; what would overflow or vanish squared is
/// scaled.
pub(super) fn length<S: Storage<f64, Dyn>>(vector: &Vector<f64, Dyn, S>) -> f64 {
    let (tiny, huge) = (f64::MIN_POSITIVE.sqrt(), f64::MAX.sqrt() / vector.len() as f64);
    let mut usual = 0.0;
    // Each the largest value, and the sum of squares in its units.
    let (mut large, mut small) = ((0.0, 0.0), (0.0, 0.0));
    let add = |(most, sum): &mut (f64, f64), value: f64| {
        if value > *most {
            *sum = 1.0 + *sum * (*most / value).powi(2);
            *most = value;
        } else if value != 0.0 {
            *sum += (value / *most).powi(2);
        }
    };
    for value in vector.iter().map(|value| value.abs()) {
        match value {
            _ if value.is_nan() => return value,
            _ if value <= tiny => add(&mut small, value),
            _ if value >= huge => add(&mut large, value),
            _ => usual += value * value,
        }
    }
    if large.1 != 0.0 {
        large.0 * (large.1 + (usual / large.0) / large.0).sqrt()
    } else if usual >= small.0 && usual != 0.0 {
        (usual * (1.0 + (small.0 / usual) * (small.0 * small.1))).sqrt()
    } else if usual != 0.0 {
        (small.0 * ((usual / small.0) + (small.0 * small.1))).sqrt()
    } else {
        small.0 * small.1.sqrt()
    }
}

/// Sum of products in order: nalgebra's own sums four at a time.
fn dot(a: DVectorView<'_, f64>, b: DVectorView<'_, f64>) -> f64 {
    a.iter().zip(b.iter()).fold(0.0, |sum, (a, b)| sum + a * b)
}

/// A Jacobian by Householder reflections with exchange of columns, and the residuals that belong to
/// it.
pub(super) struct Factors {
    /// R above and on the diagonal; below it is room for a damped factor.
    r: DMatrix<f64>,
    /// The first elements of `Q^T residuals`.
    residuals: DVector<f64>,
    /// Lengths of the Jacobian's columns, in their own order.
    pub(super) lengths: DVector<f64>,
    /// The Jacobian's column that stands at each place.
    order: Vec<usize>,
}

/// A triangular factor L with `L L^T = P^T (J^T J + D^2) P`.
pub(super) enum Factor {
    /// R transposed: no damping.
    Plain,
    /// Below the diagonal of R, with this diagonal.
    Damped(DVector<f64>),
}

impl Factors {
    /// Factorises a Jacobian with at least as many rows as columns.
    pub(super) fn of(mut a: DMatrix<f64>, mut residuals: DVector<f64>) -> Self {
        let n = a.ncols();
        let lengths = DVector::from_iterator(n, a.column_iter().map(|c| length(&c)));
        let (mut diagonal, mut exact) = (lengths.clone(), lengths.clone());
        let mut order: Vec<usize> = (0..n).collect();
        for j in 0..n {
            let longest = diagonal.rows_range(j..).imax() + j;
            if longest != j {
                a.swap_columns(j, longest);
                order.swap(j, longest);
                (diagonal[longest], exact[longest]) = (diagonal[j], exact[j]);
            }
            let mut below = a.rows_range_mut(j..);
            let (mut axis, mut right) = below.columns_range_pair_mut(j..j + 1, j + 1..);
            let norm = length(&axis.column(0));
            if norm == 0.0 {
                diagonal[j] = 0.0;
                continue;
            }
            let norm = if axis[0].is_sign_negative() { -norm } else { norm };
            diagonal[j] = -norm;
            axis /= norm;
            axis[0] += 1.0;
            let axis = axis.column(0);
            let reflect = |mut vector: DVectorViewMut<'_, f64>| {
                let along = dot(vector.as_view(), axis.as_view()) / axis[0];
                vector.axpy(-along, &axis, 1.0);
            };
            for (k, mut column) in right.column_iter_mut().enumerate() {
                let k = k + j + 1;
                reflect(column.as_view_mut());
                if diagonal[k] == 0.0 {
                    continue;
                }
                diagonal[k] *= (1.0 - (column[0] / diagonal[k]).powi(2)).max(0.0).sqrt();
                // LAPACK Working Note 176: a length carried on is computed anew in time.
                if 0.05 * (diagonal[k] / exact[k]).powi(2) <= f64::EPSILON {
                    diagonal[k] = length(&column.rows_range(1..));
                    exact[k] = diagonal[k];
                }
            }
            reflect(residuals.rows_range_mut(j..).as_view_mut());
        }
        let mut r = a.rows_range(..n).into_owned();
        r.set_diagonal(&diagonal);
        Self { r, residuals: residuals.rows_range(..n).into_owned(), lengths, order }
    }

    fn n(&self) -> usize {
        self.order.len()
    }

    pub(super) fn is_regular(&self) -> bool {
        self.r.diagonal().iter().all(|d| *d != 0.0)
    }

    /// The largest cosine between the residuals, of this length, and a column; none where it is no
    /// number.
    pub(super) fn cosine(&self, length: f64) -> Option<f64> {
        let direction = &self.residuals / length;
        let mut most = 0.0f64;
        for (j, column) in self.r.column_iter().enumerate() {
            let scale = self.lengths[self.order[j]];
            if scale == 0.0 {
                continue;
            }
            let cosine =
                (dot(column.rows_range(..j + 1), direction.rows_range(..j + 1)) / scale).abs();
            if cosine.is_nan() {
                return None;
            }
            most = most.max(cosine);
        }
        Some(most)
    }

    /// Length of `J x`.
    pub(super) fn length_of_product(&self, x: &DVector<f64>) -> f64 {
        let mut product = DVector::zeros(self.n());
        for (j, (column, &place)) in self.r.column_iter().zip(&self.order).enumerate() {
            product.rows_range_mut(..j + 1).axpy(x[place], &column.rows_range(..j + 1), 1.0);
        }
        length(&product)
    }

    /// A vector from the places of R to those of the unknowns.
    fn put_back(&self, solution: &DVector<f64>) -> DVector<f64> {
        let mut x = DVector::zeros(self.n());
        for (j, &place) in self.order.iter().enumerate() {
            x[place] = solution[j];
        }
        x
    }

    /// The least-squares solution of `J x = residuals`.
    pub(super) fn solve(&self) -> DVector<f64> {
        let zero = self.r.diagonal().iter().position(|d| *d == 0.0);
        let rank = zero.unwrap_or(self.n());
        let mut solution = self.residuals.clone();
        solution.rows_range_mut(rank..).fill(0.0);
        let regular = self.r.view((0, 0), (rank, rank));
        regular.solve_upper_triangular_mut(&mut solution.rows_range_mut(..rank));
        self.put_back(&solution)
    }

    /// The same with the equations `diagonal x = 0` added, by Givens rotations, and the factor.
    pub(super) fn solve_damped(&mut self, diagonal: &DVector<f64>) -> (DVector<f64>, Factor) {
        let n = self.n();
        self.r.fill_lower_triangle_with_upper_triangle();
        let (kept, mut solution) = (self.r.diagonal(), self.residuals.clone());
        let mut factor = DVector::zeros(n);
        for j in 0..n {
            let mut row = DVector::zeros(n);
            row[j] = diagonal[self.order[j]];
            let mut rotated = 0.0;
            for k in j..n {
                if row[k] == 0.0 {
                    continue;
                }
                let r = self.r[(k, k)];
                let (sin, cos) = if r.abs() < row[k].abs() {
                    let cot = r / row[k];
                    let sin = 0.5 / (0.25 + 0.25 * (cot * cot)).sqrt();
                    (sin, sin * cot)
                } else {
                    let tan = row[k] / r;
                    let cos = 0.5 / (0.25 + 0.25 * (tan * tan)).sqrt();
                    (cos * tan, cos)
                };
                let turn = |a: f64, b: f64| (cos * a + sin * b, -sin * a + cos * b);
                self.r[(k, k)] = turn(r, row[k]).0;
                (solution[k], rotated) = turn(solution[k], rotated);
                for i in k + 1..n {
                    (self.r[(i, k)], row[i]) = turn(self.r[(i, k)], row[i]);
                }
            }
            factor[j] = self.r[(j, j)];
            self.r[(j, j)] = kept[j];
        }
        let rank = factor.iter().position(|d| *d == 0.0).unwrap_or(n);
        solution.rows_range_mut(rank..).fill(0.0);
        for j in (0..rank).rev() {
            let known = j + 1..rank;
            let sum = dot(self.r.column(j).rows_range(known.clone()), solution.rows_range(known));
            solution[j] = (solution[j] - sum) / factor[j];
        }
        (self.put_back(&solution), Factor::Damped(factor))
    }

    /// Solves `L x = P^T right`.
    pub(super) fn solve_factor(&self, factor: &Factor, right: &DVector<f64>) -> DVector<f64> {
        let mut x = DVector::from_iterator(self.n(), self.order.iter().map(|&j| right[j]));
        for j in 0..self.n() {
            let column = self.r.column(j);
            match factor {
                Factor::Plain => {
                    let sum = dot(x.rows_range(..j), column.rows_range(..j));
                    x[j] = (x[j] - sum) / column[j];
                }
                Factor::Damped(diagonal) => {
                    x[j] /= diagonal[j];
                    let solved = x[j];
                    x.rows_range_mut(j + 1..).axpy(-solved, &column.rows_range(j + 1..), 1.0);
                }
            }
        }
        x
    }

    /// `P^T J^T residuals / scale`.
    pub(super) fn gradient(&self, scale: &DVector<f64>) -> DVector<f64> {
        DVector::from_fn(self.n(), |j, _| {
            let sum = dot(self.residuals.rows_range(..j + 1), self.r.column(j).rows_range(..j + 1));
            sum / scale[self.order[j]]
        })
    }
}
