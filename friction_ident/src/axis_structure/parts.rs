//! Whether a recording asks for the same parameters from its beginning to its end.
//!
//! Two recordings with different loads, or an axis that was changed in between, are fitted together
//! by a mean that is true of neither. What such a fit leaves falls by much where both parts have
//! linear parameters of their own (Chow 1960, Econometrica 28, 591).

use nalgebra::{DMatrix, DVector};

use super::fit::StructureFit;
use super::naming::{AxisUnits, unknowns};
use super::projection::Projection;
use super::regressors::Regressors;
use super::stability::variances;
use crate::adequacy::FitDoubt;
use crate::conditioning::Conditioned;

/// Where the recording is divided, in eighths.
const DIVISIONS: [usize; 5] = [2, 3, 4, 5, 6];
/// Share of what one fit leaves that two leave at most where the parts are not of one axis.
const APART: f64 = 0.5;
/// What one fit leaves, as a share of the force, below which nobody would notice.
const NOTICED: f64 = 0.02;
/// Rows for each parameter that a fit needs.
const ROWS_EACH: usize = 10;

/// The linear parameters of one part, with their variances where white noise is all that is left.
struct Part {
    values: DVector<f64>,
    variances: Vec<f64>,
    squares: f64,
}

impl Part {
    fn of(matrix: DMatrix<f64>, force: &DVector<f64>) -> Option<Self> {
        let (rows, columns) = matrix.shape();
        if rows < ROWS_EACH * columns {
            return None;
        }
        let variances = variances(&matrix)?;
        let (values, rest) = Projection::new(matrix)?.rest(force);
        let squares = rest.norm_squared();
        let white = squares / (rows - columns) as f64;
        let variances = variances.into_iter().map(|variance| white * variance).collect();
        Some(Self { values, variances, squares })
    }

    /// How far a parameter is from that of another part, in errors.
    fn off(&self, other: &Self, j: usize) -> f64 {
        let variance = self.variances[j] + other.variances[j];
        (self.values[j] - other.values[j]).abs() / variance.sqrt()
    }
}

impl StructureFit {
    /// That the beginning of the recording it was fitted to asks for other linear parameters than the
    /// rest, by so much that both parts by themselves leave less than half.
    pub fn parts(&self, recording: &Conditioned) -> Option<FitDoubt> {
        let mut regressors =
            Regressors::new(recording, self.structure, self.position_scale).ok()?;
        let mut matrix = regressors.matrix(&self.shape).ok()?;
        let starts = regressors.starts(&self.shape, None).ok()?;
        let mut force = regressors.force.clone();
        let size = force.norm();
        starts.leave_out_of(&mut matrix);
        starts.leave_out(force.as_mut_slice());
        let rows = matrix.nrows();
        let divided = |eighths: usize| {
            let first = eighths * rows / 8;
            let part = |from: usize, count: usize| {
                Part::of(
                    matrix.rows(from, count).into_owned(),
                    &force.rows(from, count).into_owned(),
                )
            };
            Some((first, part(0, first)?, part(first, rows - first)?))
        };
        let all = DIVISIONS.into_iter().filter_map(divided);
        let sum = |(_, a, b): &(usize, Part, Part)| a.squares + b.squares;
        let least = all.min_by(|a, b| sum(a).total_cmp(&sum(b)))?;
        let (together, apart) = (self.relative_error / 100.0, sum(&least).sqrt() / size);
        if together < NOTICED || apart > APART * together {
            return None;
        }
        let (first, a, b) = least;
        let names = unknowns(&self.structure, &AxisUnits::LINEAR);
        let linear = names.into_iter().take(a.values.len()).enumerate();
        let (j, most) = linear.max_by(|(j, _), (k, _)| a.off(&b, *j).total_cmp(&a.off(&b, *k)))?;
        Some(FitDoubt::Parts {
            together: 100.0 * together,
            apart: 100.0 * apart,
            share: first as f64 / rows as f64,
            id: most.id,
            first: a.values[j],
            second: b.values[j],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::three_tones;
    use super::super::{AxisStructure, AxisUnits, fit_structure};
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    /// What is said of an axis of which the inertia is another in the second half.
    fn said(seed: u64, inertias: [f64; 2]) -> Option<FitDoubt> {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
        let recording = three_tones(40_000, |k, v, a| {
            let inertia = inertias[usize::from(k >= 20_000)];
            let noise = 0.02 * rng.sample::<f64, _>(StandardNormal);
            inertia * a + 0.2 * v + 0.5 * v.signum() + noise
        });
        let fit = fit_structure(&recording, AxisStructure::SYMMETRIC, &AxisUnits::ROTARY).unwrap();
        fit.parts(&recording)
    }

    /// Two recordings with different loads gave a mean of both inertias, and no word.
    #[test]
    fn another_load_in_the_second_half_is_told() {
        let found = said(1, [0.3, 0.5]);
        let Some(FitDoubt::Parts { share, id, first, second, .. }) = found else {
            panic!("{found:?}");
        };
        assert_eq!(id, "inertia".into());
        assert!((share - 0.5).abs() < 0.01, "{share}");
        assert!((first - 0.3).abs() < 0.01 && (second - 0.5).abs() < 0.01, "{first} {second}");
    }

    #[test]
    fn an_axis_that_stays_as_it_is_has_one_set_of_parameters() {
        for seed in 0..5 {
            assert_eq!(said(seed, [0.3, 0.3]), None);
        }
    }
}
