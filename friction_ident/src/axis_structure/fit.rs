//! Separable least squares: the linear parameters by QR for every trial of the nonlinear ones
//! (Golub and Pereyra 1973).

use std::ops::ControlFlow;

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use super::naming::{AxisUnits, unknowns};
use super::profile;
use super::regressors::Regressors;
use super::shape::{Limits, PositionScale, Shape, ShapeTerm};
use super::{AxisStructure, doubts};
use crate::bounded::{Minimum, Patience, Residuals, minimise};
use crate::conditioning::Conditioned;
use crate::estimate::Estimates;
use crate::finite::finite;
use crate::least_squares::{self, Solution};
use crate::parameter_id::{ParameterId, Side};
use crate::residual_whiteness::effective_share;
use crate::rigid_axis::Prediction;
use crate::{Ending, IdentError};

/// A structure fitted to a recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StructureFit {
    /// Which terms it has.
    pub structure: AxisStructure,
    /// The parameters with errors that count the residual as worth
    /// [`effective_share`](Self::effective_share) of its samples; the intervals of the nonlinear
    /// ones are those of the profile.
    pub estimates: Estimates,
    /// The nonlinear parameters.
    pub shape: Shape,
    /// How positions are scaled in the polynomials.
    pub position_scale: PositionScale,
    /// `100 |residual| / |force|` \[%\].
    pub relative_error: f64,
    /// Root mean square of the residual \[N or N m\].
    pub residual_rms: f64,
    /// Decimated samples that were fitted.
    pub samples: usize,
    /// Share of the residual's samples that count as independent.
    pub effective_share: f64,
    linear: Vec<f64>,
}

impl StructureFit {
    /// Applies the fit to a recording, the same one or another: the cross-test.
    ///
    /// # Errors
    /// [`IdentError`] for a recording too short to decimate, without force, or without the position
    /// that the structure needs.
    pub fn predict(&self, recording: &Conditioned) -> Result<Prediction, IdentError> {
        let mut regressors = Regressors::new(recording, self.structure, self.position_scale)?;
        let matrix = regressors.matrix(&self.shape)?;
        let predicted = &matrix * DVector::from_column_slice(&self.linear);
        let friction = &regressors.force - matrix.column(0) * self.linear[0];
        let residual = (&regressors.force - &predicted).norm();
        Ok(Prediction {
            time: regressors.time(),
            velocity: regressors.velocity(&self.shape),
            measured: regressors.force.as_slice().to_vec(),
            predicted: predicted.as_slice().to_vec(),
            friction: friction.as_slice().to_vec(),
            relative_error: 100.0 * residual / regressors.force.norm(),
        })
    }

    /// What must be known to read the parameters right.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        for side in [Side::Both, Side::Forward, Side::Backward] {
            let [f_s, f_c] = ["f_s", "f_c"].map(|name| ParameterId::new(name).side(side));
            let Some((effect, error)) = doubts::difference(&self.estimates, f_s, f_c) else {
                continue;
            };
            if effect < -2.0 * error {
                notes.push(format!(
                    "{f_s} lies below {f_c}: friction rises over the first speeds instead of falling. That is no Stribeck dip; it describes how \
                     friction builds up around a reversal. Pre-sliding and a rising curve cannot be told apart without slow steady motion."
                ));
            }
        }
        if self.structure.delay {
            notes.push(
                "The delay is that of the force against the motion: an input that is held over a sample contributes half a sample, and a \
                 delay of the force cannot be told from a lead of the position."
                    .to_owned(),
            );
        }
        notes
    }

    /// Steady friction at a velocity \[N or N m\], the offset included; at the middle of the axis,
    /// without the harmonic.
    pub fn steady_friction(&self, velocity: f64) -> f64 {
        let side = Side::of_velocity(velocity);
        let value = |name: &'static str| {
            let estimates = &self.estimates;
            estimates
                .value(ParameterId::new(name).side(side))
                .or_else(|| estimates.value(name))
                .unwrap_or(0.0)
        };
        let near = if self.structure.stribeck {
            (-(velocity / self.shape.v_s).powi(2)).exp()
        } else {
            0.0
        };
        let level = value("f_c") * (1.0 - near) + value("f_s") * near;
        let direction = if velocity.is_sign_negative() { -1.0 } else { 1.0 };
        direction * level + value("f_v") * velocity + value("offset")
    }
}

/// Fits `structure` to the whole recording.
///
/// The delay, the Stribeck velocity, the bristle's displacement and the period are searched within
/// bounds that the recording sets (delay up to ten samples, Stribeck velocity up to a quarter of
/// the largest speed, beyond which the curve cannot be told from viscous friction, displacement up
/// to a tenth of the travel, period from a 200th to twice the travel).
///
/// # Errors
/// [`IdentError::Columns`] where the recording cannot tell terms apart,
/// [`IdentError::NegativeInertia`], [`IdentError::ZeroForce`], [`IdentError::TooFewSamples`],
/// [`IdentError::NoPosition`].
pub fn fit_structure(
    recording: &Conditioned,
    structure: AxisStructure,
    units: &AxisUnits,
) -> Result<StructureFit, IdentError> {
    let scale = PositionScale::of(recording);
    let mut search = Search::new(recording, structure, scale)?;
    let best = search.whole()?;
    let Best { solution, .. } = &best;
    let terms = ShapeTerm::of(&structure);
    let names = unknowns(&structure, units);
    let samples = solution.residual.len();
    let share = effective_share(solution.residual.as_slice());
    let minimum = search.linearise(&best, &terms)?;
    let mut estimates = Estimates::linearised(&minimum, &names, share);
    profile::intervals(&mut search, &best, &mut estimates);
    doubts::judge(&structure, &mut estimates);
    if let Some(inertia) = estimates.parameters.first().filter(|inertia| inertia.value <= 0.0) {
        return Err(IdentError::NegativeInertia {
            value: inertia.value,
            standard_error: inertia.standard_error.unwrap_or(f64::NAN),
        });
    }
    let squares = solution.residual.norm_squared();
    Ok(StructureFit {
        structure,
        estimates,
        shape: best.shape,
        position_scale: scale,
        relative_error: 100.0 * squares.sqrt() / search.regressors.force.norm(),
        residual_rms: (squares / samples as f64).sqrt(),
        samples,
        effective_share: share,
        linear: solution.x.as_slice().to_vec(),
    })
}

/// The nonlinear parameters found and the linear fit that belongs to them.
pub(super) struct Best {
    pub shape: Shape,
    pub solution: Solution,
}

/// The search for the nonlinear parameters on some rows of a recording.
pub(super) struct Search<'a> {
    pub regressors: Regressors<'a>,
    pub limits: Limits,
    pub structure: AxisStructure,
    /// The rows that count; none for all.
    pub rows: Option<Vec<usize>>,
}

impl<'a> Search<'a> {
    pub fn new(
        recording: &'a Conditioned,
        structure: AxisStructure,
        scale: PositionScale,
    ) -> Result<Self, IdentError> {
        let regressors = Regressors::new(recording, structure, scale)?;
        Ok(Self { regressors, limits: Limits::of(recording), structure, rows: None })
    }

    /// The best fit without a starting point: grids one after the other, then all together.
    pub fn whole(&mut self) -> Result<Best, IdentError> {
        let mut start = self.limits.start();
        for term in ShapeTerm::of(&self.structure) {
            // The delay's well is wide: it needs no grid. That of a period is narrow.
            let count = match term {
                ShapeTerm::Delay => continue,
                ShapeTerm::Period => 400,
                _ => 9,
            };
            let mut best = f64::INFINITY;
            let mut chosen = start;
            for value in self.limits.grid(term, count) {
                let mut trial = start;
                term.set(&mut trial, value);
                let (matrix, force) = self.system(&trial)?;
                let sum = Projection::new(matrix)
                    .map(|projection| projection.rest(&force).1.norm_squared());
                if let Some(sum) = sum.filter(|sum| *sum < best) {
                    (best, chosen) = (sum, trial);
                }
            }
            start = chosen;
        }
        self.from(start, &[])
    }

    /// The best fit from a starting point, with some nonlinear parameters kept at it.
    pub fn from(&mut self, start: Shape, kept: &[ShapeTerm]) -> Result<Best, IdentError> {
        let terms: Vec<ShapeTerm> = ShapeTerm::of(&self.structure)
            .into_iter()
            .filter(|term| !kept.contains(term))
            .collect();
        let mut shape = start;
        if !terms.is_empty() {
            let bounds: Vec<_> = terms.iter().map(|&term| self.limits.bound(term)).collect();
            let from: Vec<f64> =
                terms.iter().map(|&term| term.unknown(term.value(&start))).collect();
            let patience = Patience { sum: 1e-8, step: 1e-5, iterations: 30, broyden: false };
            let mut problem = Separable { search: self, terms: &terms, start };
            let watch = &mut |_: &_| ControlFlow::Continue(());
            if let Some(minimum) = minimise(&mut problem, &from, &bounds, &patience, watch) {
                shape = problem.shape(&minimum.x);
            }
        }
        let solution = self.solve(&shape)?;
        Ok(Best { shape, solution })
    }

    /// The linear parameters for given nonlinear ones.
    pub fn solve(&mut self, shape: &Shape) -> Result<Solution, IdentError> {
        let (matrix, force) = self.system(shape)?;
        self.solved(&matrix, &force)
    }

    fn solved(&self, matrix: &DMatrix<f64>, force: &DVector<f64>) -> Result<Solution, IdentError> {
        least_squares::solve(matrix, force).map_err(|degenerate| {
            let names = unknowns(&self.structure, &AxisUnits::LINEAR);
            let columns = degenerate.columns.into_iter().filter_map(|column| names.get(column));
            IdentError::Columns { names: columns.map(|unknown| unknown.id.to_string()).collect() }
        })
    }

    /// Columns and force on the rows that count.
    fn system(&mut self, shape: &Shape) -> Result<(DMatrix<f64>, DVector<f64>), IdentError> {
        let matrix = self.regressors.matrix(shape)?;
        let force = self.values_of(&self.regressors.force);
        Ok((self.rows_of(matrix), force))
    }

    fn values_of(&self, column: &DVector<f64>) -> DVector<f64> {
        match &self.rows {
            None => column.clone(),
            Some(rows) => DVector::from_iterator(rows.len(), rows.iter().map(|&k| column[k])),
        }
    }

    /// The rows that count.
    fn rows_of(&self, matrix: DMatrix<f64>) -> DMatrix<f64> {
        match &self.rows {
            None => matrix,
            Some(rows) => matrix.select_rows(rows),
        }
    }

    /// Derivative of the predicted force with respect to one nonlinear parameter, the linear ones
    /// kept, on all rows; by central differences within the bounds.
    fn slope(
        &mut self,
        shape: &Shape,
        linear: &DVector<f64>,
        term: ShapeTerm,
    ) -> Result<DVector<f64>, IdentError> {
        let value = term.value(shape);
        let (low, high) = (term.value(&self.limits.low), term.value(&self.limits.high));
        let h = 1e-4 * value.max(1e-2 * high);
        let at = |to: f64| {
            let mut moved = *shape;
            term.set(&mut moved, to.clamp(low, high));
            moved
        };
        self.regressors.slope(term, &at(value - h), &at(value + h), linear)
    }

    /// All parameters together, linear ones first, as a minimum of least squares.
    fn linearise(&mut self, best: &Best, terms: &[ShapeTerm]) -> Result<Minimum, IdentError> {
        let linear = best.solution.x.clone();
        let matrix = self.regressors.matrix(&best.shape)?;
        let (rows, columns) = matrix.shape();
        let mut jacobian = DMatrix::zeros(rows, columns + terms.len());
        jacobian.columns_mut(0, columns).copy_from(&-matrix);
        let mut x = linear.as_slice().to_vec();
        let mut held = vec![false; columns];
        for (j, &term) in terms.iter().enumerate() {
            let value = term.value(&best.shape);
            let (low, high) = (term.value(&self.limits.low), term.value(&self.limits.high));
            let slope = self.slope(&best.shape, &linear, term)?;
            jacobian.set_column(columns + j, &-slope);
            x.push(value);
            held.push(value <= low * (1.0 + 1e-9) || value >= high * (1.0 - 1e-9));
        }
        let residuals = best.solution.residual.clone();
        let sum = residuals.norm_squared();
        Ok(Minimum { x, residuals, jacobian, held, sum, evaluations: 0, ending: Ending::Converged })
    }
}

/// The residual of the linear fit as a function of the nonlinear parameters.
struct Separable<'s, 'a> {
    search: &'s mut Search<'a>,
    terms: &'s [ShapeTerm],
    start: Shape,
}

impl Separable<'_, '_> {
    fn shape(&self, x: &[f64]) -> Shape {
        let mut shape = self.start;
        for (term, &value) in self.terms.iter().zip(x) {
            term.set(&mut shape, term.natural(value));
        }
        shape
    }
}

impl Residuals for Separable<'_, '_> {
    fn len(&self) -> usize {
        self.search.rows.as_ref().map_or(self.search.regressors.rows(), Vec::len)
    }

    fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool {
        let Ok((matrix, force)) = self.search.system(&self.shape(x)) else { return false };
        let Some(projection) = Projection::new(matrix) else { return false };
        out.copy_from_slice(projection.rest(&force).1.as_slice());
        true
    }

    /// Kaufman's (1975): the change of the columns, projected off what the linear parameters can
    /// follow.
    fn jacobian(&mut self, x: &[f64], _: &[f64], jacobian: &mut DMatrix<f64>) -> bool {
        let shape = self.shape(x);
        let Ok((matrix, force)) = self.search.system(&shape) else { return false };
        let Some(projection) = Projection::new(matrix) else { return false };
        let (linear, _) = projection.rest(&force);
        for (j, &term) in self.terms.iter().enumerate() {
            let Ok(slope) = self.search.slope(&shape, &linear, term) else { return false };
            let slope = self.search.values_of(&slope) * term.stretch(term.value(&shape));
            jacobian.set_column(j, &-projection.rest(&slope).1);
        }
        true
    }
}

/// Least squares by normal equations of columns scaled to unit length: quick enough to be done for
/// every trial of the search. The final parameters come from the factorisation of the columns
/// themselves.
struct Projection {
    scaled: DMatrix<f64>,
    scale: DVector<f64>,
    factor: nalgebra::Cholesky<f64, nalgebra::Dyn>,
}

impl Projection {
    /// None for columns that depend on one another.
    fn new(mut matrix: DMatrix<f64>) -> Option<Self> {
        let scale = DVector::from_iterator(
            matrix.ncols(),
            matrix.column_iter().map(|column| column.norm()),
        );
        if scale.iter().any(|norm| *norm == 0.0) {
            return None;
        }
        matrix.column_iter_mut().zip(scale.iter()).for_each(|(mut column, norm)| column /= *norm);
        let factor = finite(matrix.tr_mul(&matrix))?.cholesky()?;
        Some(Self { scaled: matrix, scale, factor })
    }

    /// The linear parameters for `y` and what they leave of it.
    fn rest(&self, y: &DVector<f64>) -> (DVector<f64>, DVector<f64>) {
        let weights = self.factor.solve(&self.scaled.tr_mul(y));
        let rest = y - &self.scaled * &weights;
        (weights.component_div(&self.scale), rest)
    }
}
