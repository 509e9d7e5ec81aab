//! What nobody recorded: how far a bristle is deflected where a stretch begins.
//!
//! An axis that begins at rest may have its bristle anywhere between its limits. What a wrong
//! beginning adds dies out with the way, `exp(-way / displacement)` for Dahl's bristle, whose force
//! is linear in its deflection: one unknown more for each stretch. It is taken out of columns and
//! force before the least squares, which leaves the other parameters as if it had been fitted too
//! (Frisch and Waugh 1933, Econometrica 1), and out of the error of a prediction, of which it is no
//! part.

use std::ops::Range;

use nalgebra::DMatrix;

/// Share of the limit that a beginning still adds, below which it is forgotten.
pub(super) const FORGOTTEN: f64 = 1e-6;
/// What is believed of a beginning before the first sample: that it lies within the limits, beside a
/// noise of a few hundredths of them, squared.
const BELIEVED: f64 = 1e-3;

/// The beginnings of all stretches, on rows.
#[derive(Debug, Clone, Default)]
pub(super) struct Starts {
    all: Vec<Start>,
}

/// What the beginning of one stretch adds.
#[derive(Debug, Clone)]
struct Start {
    /// Its rows, up to where it is forgotten.
    rows: Range<usize>,
    /// What is left of a deflection by one limit.
    left: Vec<f64>,
    /// The sum of its squares with what is believed.
    square: f64,
    /// How much of `left` is taken off for each unit of a product with it.
    share: f64,
}

impl Starts {
    /// Of what is `left` of a beginning on all rows of `stretches`; `rows` those that count, in their
    /// order.
    pub fn of(left: &[f64], stretches: &[Range<usize>], rows: Option<&[usize]>) -> Self {
        let all = stretches.iter().filter_map(|stretch| match rows {
            None => Start::of(left, stretch.start, stretch.clone()),
            Some(rows) => {
                let place = |row: usize| rows.partition_point(|own| *own < row);
                let first = place(stretch.start);
                let own = rows.get(first..place(stretch.end)).unwrap_or_default();
                Start::of(left, first, own.iter().copied())
            }
        });
        Self { all: all.collect() }
    }

    /// Whether all was forgotten before the first rows.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Takes the beginnings out of a column.
    pub fn leave_out(&self, column: &mut [f64]) {
        for start in &self.all {
            let product = start.product(column);
            let Some(own) = column.get_mut(start.rows.clone()) else { continue };
            let off = start.share * product;
            own.iter_mut().zip(&start.left).for_each(|(x, left)| *x -= off * left);
        }
    }

    /// The same of all columns of a matrix.
    pub fn leave_out_of(&self, matrix: &mut DMatrix<f64>) {
        let rows = matrix.nrows().max(1);
        matrix.as_mut_slice().chunks_mut(rows).for_each(|column| self.leave_out(column));
    }

    /// How much of its beginning `rest` has in each stretch, with the first row of each.
    pub fn amounts(&self, rest: &[f64]) -> Vec<(usize, f64)> {
        let of = |start: &Start| (start.rows.start, start.product(rest) / start.square);
        self.all.iter().map(of).collect()
    }
}

impl Start {
    /// None where it was forgotten before the first row.
    fn of(left: &[f64], first: usize, rows: impl Iterator<Item = usize>) -> Option<Self> {
        let left: Vec<f64> =
            rows.map_while(|row| left.get(row).copied()).take_while(|c| *c > FORGOTTEN).collect();
        let norm: f64 = left.iter().map(|c| c * c).sum();
        let square = norm + BELIEVED;
        let share = (1.0 - (BELIEVED / square).sqrt()) / norm;
        let rows = first..first + left.len();
        (norm > 0.0).then_some(Self { rows, left, square, share })
    }

    fn product(&self, column: &[f64]) -> f64 {
        let own = column.get(self.rows.clone()).unwrap_or_default();
        own.iter().zip(&self.left).map(|(x, left)| x * left).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two stretches: what is left of a column does not depend on how either begins.
    #[test]
    fn a_beginning_is_taken_out_of_each_stretch() {
        let dying = |k: usize| (-(k as f64) / 5.0).exp();
        let left: Vec<f64> = (0..60).map(dying).chain((0..40).map(dying)).collect();
        let stretches = [0..60, 60..100];
        let starts = Starts::of(&left, &stretches, None);
        let plain: Vec<f64> = (0..100).map(|k| (k as f64 * 0.7).cos()).collect();
        let amount = |k: usize| if k < 60 { -1.5 } else { 0.8 };
        let begun: Vec<f64> = (0..100).map(|k| plain[k] + amount(k) * left[k]).collect();
        let (mut one, mut other) = (plain.clone(), begun.clone());
        starts.leave_out(&mut one);
        starts.leave_out(&mut other);
        for (a, b) in one.iter().zip(&other) {
            assert!((a - b).abs() < 0.05, "{a} {b}");
        }
        assert!((one[59] - plain[59]).abs() < 1e-4);
        let alone: Vec<f64> = left.iter().map(|c| 0.7 * c).collect();
        for (stretch, (first, amount)) in stretches.iter().zip(starts.amounts(&alone)) {
            assert_eq!(first, stretch.start);
            assert!((amount - 0.7).abs() < 0.01, "{amount}");
        }
        // Of rows without the beginning of the second stretch only the first one begins.
        let rows: Vec<usize> = (0..50).chain(90..100).collect();
        let some = Starts::of(&left, &stretches, Some(&rows));
        let mut column: Vec<f64> = rows.iter().map(|&k| plain[k]).collect();
        some.leave_out(&mut column);
        for (k, row) in rows.iter().enumerate().skip(3) {
            let near = (column[k] - one[*row]).abs() < 0.05;
            assert!(near || *row >= 60, "{row}: {} {}", column[k], one[*row]);
        }
    }
}
