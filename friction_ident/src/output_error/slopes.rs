//! The derivatives of the residuals, carried along with the states of the model.

use friction_model::{Dual, FrictionModel, Real, VisitorIn};
use nalgebra::DMatrix;
use pulp::{Arch, Simd, WithSimd};

use super::Measured;
use super::along::run;

/// Derivatives carried at once: as many as most models have numbers to be found.
pub(super) const AT_ONCE: usize = 8;

/// Runs a model whose numbers carry derivatives along all that was measured, and writes those of
/// the residuals.
pub(super) struct Slopes<'a> {
    pub data: &'a Measured<'a>,
    /// Of each stretch the samples at rest, which have no residual.
    pub rest: &'a [Vec<bool>],
    /// What is predicted, those samples included.
    pub predicted: &'a mut [f64],
    /// One row a residual.
    pub jacobian: &'a mut DMatrix<f64>,
    /// The columns that are written: as many as the numbers carry derivatives, or fewer.
    pub columns: std::ops::Range<usize>,
}

impl VisitorIn<Dual<AT_ONCE>> for Slopes<'_> {
    type Output = ();

    fn visit<M: FrictionModel<Dual<AT_ONCE>>>(self, model: M) {
        Arch::new().dispatch(Run { model, slopes: self });
    }
}

/// A run by whatever the processor has: derivatives lie side by side.
struct Run<'a, M> {
    model: M,
    slopes: Slopes<'a>,
}

impl<M: FrictionModel<Dual<AT_ONCE>>> WithSimd for Run<'_, M> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { model, slopes: Slopes { data, rest, predicted, jacobian, columns } } = self;
        let rows = jacobian.nrows();
        let all = jacobian.as_mut_slice().chunks_exact_mut(rows.max(1));
        let mut columns: Vec<&mut [f64]> = all.skip(columns.start).take(columns.len()).collect();
        let mut row = 0;
        let mut write = |force: Dual<AT_ONCE>, weight: f64| {
            for (column, slope) in columns.iter_mut().zip(force.slopes()) {
                column[row] = weight * slope;
            }
            row += 1;
        };
        let (points, mut samples) = predicted.split_at_mut(data.points.len());
        for (point, predicted) in data.points.iter().zip(points) {
            let force = model.steady_state(Dual::of(point.velocity));
            *predicted = force.value();
            write(force, 1.0 / point.deviation.unwrap_or(1.0));
        }
        for (stretch, rest) in data.stretches.iter().zip(rest) {
            let weight = 1.0 / stretch.deviation.unwrap_or(1.0);
            let (here, others) = samples.split_at_mut(stretch.len());
            samples = others;
            run(&model, stretch, rest, |k, force| {
                here[k] = force.value();
                if !rest.get(k).copied().unwrap_or(false) {
                    write(force, weight);
                }
            });
        }
    }
}
