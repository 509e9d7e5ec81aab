//! The best sum of many stops: a convex problem, so its solution is global.
//!
//! A torque that obeys Masing's rules is a Prandtl-Ishlinskii operator, `F = sum_j k_j s_j(x)` with
//! stops `s_j` of width `w_j` and `k_j >= 0`. With the widths on a fine grid only the stiffnesses
//! are unknown, and non-negative least squares (Lawson and Hanson 1974, chapter 23) finds the best
//! of all such operators. Few elements are then made of it: neighbouring stops are merged so that
//! the virgin curve, and with it every branch, changes least.

use nalgebra::{DMatrix, DVector};

use crate::finite::finite;

use super::{Paths, stops::stops};

/// Stops side by side.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Spectrum {
    /// Widths \[rad or m\], growing.
    pub widths: Vec<f64>,
    /// Stiffnesses \[N m/rad or N/m\], zero or more.
    pub stiffnesses: Vec<f64>,
}

/// Widths of the grid.
const GRID: usize = 48;
/// Narrowest width over the largest displacement.
const NARROWEST: f64 = 0.01;

/// The best stops on a grid of widths up to the largest displacement, the last of which hardly
/// slips.
pub(super) fn spectrum(data: &Paths) -> Spectrum {
    let widths: Vec<f64> = (0..GRID)
        .map(|i| data.reach * NARROWEST * (1.05 / NARROWEST).powf(i as f64 / (GRID - 1) as f64))
        .collect();
    let mut columns = vec![vec![0.0; data.torque.len()]; GRID];
    for (&width, column) in widths.iter().zip(&mut columns) {
        for (start, end) in data.ranges() {
            if let (Some(path), Some(out)) =
                (data.displacement.get(start..end), column.get_mut(start..end))
            {
                stops(width, path, out);
            }
        }
    }
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut normal = DMatrix::zeros(GRID, GRID);
    for i in 0..GRID {
        for j in 0..=i {
            normal[(i, j)] = dot(&columns[i], &columns[j]);
            normal[(j, i)] = normal[(i, j)];
        }
    }
    let right =
        DVector::from_iterator(GRID, columns.iter().map(|column| dot(column, &data.torque)));
    Spectrum { widths, stiffnesses: non_negative(&normal, &right) }
}

/// The best stops on the grid of widths that the displacements suggest, for paths from the unloaded
/// contact.
///
/// # Errors
/// As [`fit_pre_sliding`](super::fit_pre_sliding).
pub fn stop_spectrum(paths: &[super::PreSlidingPath]) -> Result<Spectrum, crate::IdentError> {
    Ok(spectrum(&Paths::new(paths)?))
}

/// Minimises `x^T A x / 2 - b^T x` over `x >= 0`, by the active set of Lawson and Hanson.
fn non_negative(a: &DMatrix<f64>, b: &DVector<f64>) -> Vec<f64> {
    let n = b.len();
    let mut x = DVector::zeros(n);
    let mut free = vec![false; n];
    let enough = 1e-10 * b.amax();
    for _ in 0..3 * n {
        let pull = b - a * &x;
        let next = (0..n).filter(|&j| !free[j]).max_by(|&i, &j| pull[i].total_cmp(&pull[j]));
        let Some(next) = next.filter(|&j| pull[j] > enough) else { break };
        free[next] = true;
        loop {
            let indices: Vec<usize> = (0..n).filter(|&j| free[j]).collect();
            let part =
                DMatrix::from_fn(indices.len(), indices.len(), |i, j| a[(indices[i], indices[j])]);
            let right = DVector::from_iterator(indices.len(), indices.iter().map(|&j| b[j]));
            let Some(solution) =
                finite(part).and_then(|part| part.cholesky()).map(|factor| factor.solve(&right))
            else {
                // Dependent on the others in floating point: it adds nothing.
                free[next] = false;
                x[next] = 0.0;
                return x.iter().copied().collect();
            };
            // As far towards the solution as all stay positive.
            let mut share = 1.0f64;
            for (&j, &target) in indices.iter().zip(solution.iter()) {
                if target <= 0.0 {
                    share = share.min(x[j] / (x[j] - target).max(f64::MIN_POSITIVE));
                }
            }
            for (&j, &target) in indices.iter().zip(solution.iter()) {
                x[j] += share * (target - x[j]);
            }
            if share == 1.0 {
                break;
            }
            let small = 1e-12 * x.amax();
            for &j in &indices {
                if x[j] <= small {
                    (x[j], free[j]) = (0.0, false);
                }
            }
            if !free.iter().any(|&free| free) {
                break;
            }
        }
    }
    x.iter().copied().collect()
}

impl Spectrum {
    /// At most `elements` stops, made of neighbours: stiffness `sum k` and width `sum k w / sum k`,
    /// which keeps both ends of the virgin curve. The partition is the best one (dynamic
    /// programming over `sum k (w - mean)^2`, twice the area between the virgin curves).
    pub(super) fn merged(&self, elements: usize) -> Self {
        let present: Vec<(f64, f64)> = self
            .widths
            .iter()
            .zip(&self.stiffnesses)
            .filter(|(_, k)| **k > 0.0)
            .map(|(&w, &k)| (w, k))
            .collect();
        let n = present.len();
        let cluster = |from: usize, to: usize| {
            let [k, kw, kww] = present
                .get(from..to)
                .unwrap_or(&[])
                .iter()
                .fold([0.0; 3], |[a, b, c], (w, k)| [a + k, b + k * w, c + k * w * w]);
            (k, kw / k, kww - kw * kw / k)
        };
        if n <= elements {
            return Self {
                widths: present.iter().map(|(w, _)| *w).collect(),
                stiffnesses: present.iter().map(|(_, k)| *k).collect(),
            };
        }
        // cost[e][to]: the first `to` stops in e + 1 clusters, and where the last one begins.
        let mut cost: Vec<Vec<(f64, usize)>> =
            vec![(0..=n).map(|to| (cluster(0, to).2, 0)).collect()];
        for e in 1..elements {
            let row = (0..=n)
                .map(|to| {
                    (e..to)
                        .map(|from| (cost[e - 1][from].0 + cluster(from, to).2, from))
                        .min_by(|a, b| a.0.total_cmp(&b.0))
                        .unwrap_or((f64::INFINITY, 0))
                })
                .collect();
            cost.push(row);
        }
        let mut merged = Self::default();
        let mut to = n;
        for row in cost.iter().rev() {
            let from = row[to].1;
            let (k, w, _) = cluster(from, to);
            merged.widths.insert(0, w);
            merged.stiffnesses.insert(0, k);
            to = from;
        }
        merged
    }
}
