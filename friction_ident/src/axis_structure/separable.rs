//! What the linear parameters leave of the force as a function of the nonlinear ones (variable
//! projection).

use nalgebra::{DMatrix, DVector};

use super::projection::Projection;
use super::search::Search;
use super::shape::{Shape, ShapeTerm};
use crate::bounded::Residuals;

/// The residual of the linear fit as a function of the nonlinear parameters.
pub(super) struct Separable<'s, 'a> {
    pub search: &'s mut Search<'a>,
    pub terms: &'s [ShapeTerm],
    pub start: Shape,
}

impl Separable<'_, '_> {
    fn projection(
        &self,
        shape: &Shape,
        matrix: DMatrix<f64>,
        force: &DVector<f64>,
    ) -> Option<Projection> {
        let tied = self.terms.contains(&ShapeTerm::Ratio).then_some(shape.ratio);
        self.search.projection(matrix, force, tied)
    }

    pub fn shape(&self, x: &[f64]) -> Shape {
        let mut shape = self.start;
        for (term, &value) in self.terms.iter().zip(x) {
            term.set(&mut shape, term.natural(value));
        }
        shape
    }
}

impl Residuals for Separable<'_, '_> {
    fn len(&self) -> usize {
        self.search.rows.as_ref().map_or(self.search.regressors.count(), Vec::len)
    }

    fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool {
        let shape = self.shape(x);
        let Ok((matrix, force)) = self.search.system(&shape) else { return false };
        let Some(projection) = self.projection(&shape, matrix, &force) else { return false };
        out.copy_from_slice(projection.rest(&force).1.as_slice());
        true
    }

    /// Kaufman's (1975): the change of the columns, projected off what the linear parameters can
    /// follow.
    fn jacobian(&mut self, x: &[f64], _: &[f64], jacobian: &mut DMatrix<f64>) -> bool {
        let shape = self.shape(x);
        let Ok((matrix, force)) = self.search.system(&shape) else { return false };
        let Some(projection) = self.projection(&shape, matrix, &force) else { return false };
        let (linear, _) = projection.rest(&force);
        let Ok(slopes) = self.search.slopes(&shape, &linear, self.terms) else { return false };
        let rows = self.search.rows.as_deref();
        let Ok(starts) = self.search.regressors.starts(&shape, rows) else { return false };
        for (j, (&term, slope)) in self.terms.iter().zip(slopes).enumerate() {
            let mut slope = self.search.values_of(&slope) * term.stretch(term.value(&shape));
            starts.leave_out(slope.as_mut_slice());
            jacobian.set_column(j, &-projection.rest(&slope).1);
        }
        true
    }
}
