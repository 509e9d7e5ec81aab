//! Separable least squares: the linear parameters by a fit of their own for every trial of the
//! nonlinear ones (Golub and Pereyra 1973).

use nalgebra::{DMatrix, DVector};

use super::AxisStructure;
use super::naming::{AxisUnits, unknowns};
use super::projection::{Projection, below_zero, without};
use super::regressors::Regressors;
use super::shape::{Limits, PositionScale, Shape, ShapeTerm};
use super::start::Starts;
use super::waves;
use crate::bounded::{Minimum, Patience, Residuals, lowest};
use crate::conditioning::Conditioned;
use crate::finite::finite;
use crate::least_squares::{self, Degenerate, Solution};
use crate::{Ending, IdentError};

/// Share of the sum of squares by which a search for parameters must still fall to go on.
pub(super) const EXACT: f64 = 1e-8;
/// Share of the longest delay below which a delay lies at zero.
const AT_ONCE: f64 = 1e-6;
/// Periods that are looked at, and how many of them are tried.
const PERIODS: usize = 400;
const TRIED: usize = 3;

/// The nonlinear parameters found and the linear fit that belongs to them.
pub(super) struct Best {
    pub shape: Shape,
    pub solution: Solution,
}

impl Best {
    /// The sum of squares that is left.
    pub fn sum(&self) -> f64 {
        self.solution.residual.norm_squared()
    }
}

/// Where a straight step arrives.
pub(super) struct Stepped {
    pub shape: Shape,
    /// The sum of squares there.
    pub sum: f64,
    /// What the step takes off it.
    pub gain: f64,
}

/// The linear problem that nonlinear parameters leave.
pub(super) struct System {
    pub matrix: DMatrix<f64>,
    pub force: DVector<f64>,
    /// How the bristle began in each stretch, which is left out of both.
    pub starts: Starts,
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
        Self::with_power(recording, structure, scale, None)
    }

    /// One that goes on from where another ended. A force that was not recorded late there is not
    /// late here: that has to explain clearly more (see [`late`](Self::late)).
    pub fn resumed(
        recording: &'a Conditioned,
        structure: AxisStructure,
        scale: PositionScale,
        from: &Shape,
    ) -> Result<Self, IdentError> {
        let mut search = Self::new(recording, structure, scale)?;
        search.follows(from);
        Ok(search)
    }

    /// Whether its levels are such as the force of the recording can have overcome.
    ///
    /// # Errors
    /// [`IdentError::LevelBeyond`] where they are not.
    pub fn possible(&self, best: &Best) -> Result<(), IdentError> {
        match self.regressors.level_beyond(&best.solution.x) {
            Some((level, force)) => Err(IdentError::LevelBeyond { level, force }),
            None => Ok(()),
        }
    }

    /// Keeps the delay of a motion that followed its force at `from` from going below zero.
    pub fn follows(&mut self, from: &Shape) {
        if from.delay >= 0.0 {
            self.limits.low.delay = 0.0;
        }
    }

    /// The same with [`Regressors::with_power`].
    pub fn with_power(
        recording: &'a Conditioned,
        structure: AxisStructure,
        scale: PositionScale,
        power: Option<f64>,
    ) -> Result<Self, IdentError> {
        let regressors = Regressors::with_power(recording, structure, scale, power)?;
        regressors.enough()?;
        Ok(Self { regressors, limits: Limits::of(recording), structure, rows: None })
    }

    /// The best fit without a starting point: grids one after the other, then all together.
    pub fn whole(&mut self) -> Result<Best, IdentError> {
        let start = self.limits.start();
        self.grown(&AxisStructure::SYMMETRIC, start, EXACT)
    }

    /// The best fit from that of a structure that has less: grids for what is new, then all
    /// together, until the sum of squares does not fall by more than `enough` of itself.
    ///
    /// The motion follows the force, but where the force was recorded [late](Self::late).
    pub fn grown(
        &mut self,
        from: &AxisStructure,
        mut start: Shape,
        enough: f64,
    ) -> Result<Best, IdentError> {
        let either_way = self.limits;
        self.limits.low.delay = 0.0;
        start.delay = start.delay.max(0.0);
        let prompt = self.grown_within(from, start, enough)?;
        if !self.structure.delay || prompt.shape.delay > AT_ONCE * self.limits.high.delay {
            return Ok(prompt);
        }
        let followed = std::mem::replace(&mut self.limits, either_way);
        if let Some(late) = self.late(&prompt, enough)? {
            return Ok(late);
        }
        self.limits = followed;
        Ok(prompt)
    }

    fn grown_within(
        &mut self,
        from: &AxisStructure,
        mut start: Shape,
        enough: f64,
    ) -> Result<Best, IdentError> {
        let known = ShapeTerm::of(from);
        let new = ShapeTerm::of(&self.structure).into_iter().filter(|term| !known.contains(term));
        for term in new {
            // The delay's well is wide: it needs no grid. That of a period is narrow.
            start = match term {
                ShapeTerm::Delay => continue,
                ShapeTerm::Period => self.other_period(start)?,
                _ => self.best_of(term, self.limits.grid(term, 9), start)?,
            };
        }
        self.closer(start, &[], enough)
    }

    /// `start` with the period that suits it best of all.
    pub fn other_period(&mut self, start: Shape) -> Result<Shape, IdentError> {
        let periods = self.periods(&start)?;
        self.best_of(ShapeTerm::Period, periods, start)
    }

    /// `start` with the best of some values of a nonlinear parameter.
    pub fn best_of(
        &mut self,
        term: ShapeTerm,
        values: Vec<f64>,
        start: Shape,
    ) -> Result<Shape, IdentError> {
        let mut best = f64::INFINITY;
        let mut chosen = start;
        let with = |&value: &f64| {
            let mut trial = start;
            term.set(&mut trial, value);
            trial
        };
        let trials: Vec<Shape> = values.iter().map(with).collect();
        for few in trials.chunks(self.regressors.at_once()) {
            if term != ShapeTerm::Period {
                self.regressors.prepare(few)?;
            }
            for trial in few {
                let System { matrix, force, .. } = self.system(trial)?;
                let sum = self
                    .projection(matrix, &force, None)
                    .map(|projection| projection.rest(&force).1.norm_squared());
                if let Some(sum) = sum.filter(|sum| *sum < best) {
                    (best, chosen) = (sum, *trial);
                }
            }
        }
        Ok(chosen)
    }

    /// The periods that are worth a try with the other nonlinear parameters as they are.
    fn periods(&mut self, start: &Shape) -> Result<Vec<f64>, IdentError> {
        let grid = self.limits.grid(ShapeTerm::Period, PERIODS);
        let System { matrix, force, .. } = self.system(start)?;
        let others = matrix.columns(0, matrix.ncols().saturating_sub(2)).into_owned();
        let places = self.regressors.places(start);
        let places = match &self.rows {
            None => places,
            Some(rows) => rows.iter().filter_map(|&row| places.get(row).copied()).collect(),
        };
        let fastest = self.regressors.rows.fastest_wave();
        Ok(waves::promising(&grid, TRIED, &places, &others, &force, fastest))
    }

    /// The best fit from a starting point, with some nonlinear parameters kept at it.
    pub fn from(&mut self, start: Shape, kept: &[ShapeTerm]) -> Result<Best, IdentError> {
        self.closer(start, kept, EXACT)
    }

    /// The nonlinear parameters that are not kept.
    pub fn moving(&self, kept: &[ShapeTerm]) -> Vec<ShapeTerm> {
        let all = ShapeTerm::of(&self.structure).into_iter();
        all.filter(|term| !kept.contains(term)).collect()
    }

    /// The best fit from a starting point, whose lag is that of the ratio of levels there.
    pub fn closer_at(
        &mut self,
        start: Shape,
        kept: &[ShapeTerm],
        enough: f64,
    ) -> Result<Best, IdentError> {
        let terms = self.moving(kept);
        let shape = self.searched(start, &terms, enough);
        let solution = self.solve(&shape)?;
        Ok(Best { shape, solution })
    }

    /// Where the sum of squares is least, as far as `terms` go.
    pub fn searched(&mut self, start: Shape, terms: &[ShapeTerm], enough: f64) -> Shape {
        let mut shape = start;
        if !terms.is_empty() {
            let bounds: Vec<_> = terms.iter().map(|&term| self.limits.bound(term)).collect();
            let from: Vec<f64> =
                terms.iter().map(|&term| term.unknown(term.value(&start))).collect();
            let patience = Patience { sum: enough, step: 1e-5, iterations: 30, broyden: false };
            let mut problem = Separable { search: self, terms, start, last: None };
            if let Some(x) = lowest(&mut problem, &from, &bounds, &patience) {
                shape = problem.shape(&x);
            }
        }
        shape
    }

    /// The sum of squares that a straight step from `start` would leave, with some nonlinear
    /// parameters kept, where it arrives, and how much it takes off; none where there is no such step.
    pub fn stepped(&mut self, start: Shape, kept: &[ShapeTerm]) -> Option<Stepped> {
        let mut terms = self.moving(kept);
        terms.extend(self.structure.lag.then_some(ShapeTerm::Ratio));
        let limits = self.limits;
        let x: Vec<f64> = terms.iter().map(|term| term.unknown(term.value(&start))).collect();
        let mut problem = Separable { search: self, terms: &terms, start, last: None };
        let mut residual = DVector::zeros(problem.len());
        let mut slopes = DMatrix::zeros(residual.len(), terms.len());
        if !problem.residuals(&x, residual.as_mut_slice())
            || !problem.jacobian(&x, residual.as_slice(), &mut slopes)
        {
            return None;
        }
        let gradient = slopes.tr_mul(&residual);
        let step = if terms.is_empty() {
            DVector::zeros(0)
        } else {
            finite(slopes.tr_mul(&slopes))?.cholesky()?.solve(&-&gradient)
        };
        let gain = -gradient.dot(&step);
        let mut shape = start;
        for (&term, (x, step)) in terms.iter().zip(x.iter().zip(step.iter())) {
            let value = term.natural(x + step);
            term.set(&mut shape, value.clamp(term.value(&limits.low), term.value(&limits.high)));
        }
        let sum = residual.norm_squared() - gain;
        sum.is_finite().then_some(Stepped { shape, sum, gain })
    }

    /// The linear parameters for given nonlinear ones.
    pub fn solve(&mut self, shape: &Shape) -> Result<Solution, IdentError> {
        let System { matrix, force, .. } = self.system(shape)?;
        self.solved(&matrix, &force)
    }

    fn solved(&self, matrix: &DMatrix<f64>, force: &DVector<f64>) -> Result<Solution, IdentError> {
        let mut taken: Vec<usize> = (0..matrix.ncols()).collect();
        loop {
            let fit = least_squares::solve(&matrix.select_columns(&taken), force);
            let fit = fit.map_err(|Degenerate { columns }| {
                let names = unknowns(&self.structure, &AxisUnits::LINEAR);
                let columns = columns.into_iter().filter_map(|column| taken.get(column));
                let names = columns.filter_map(|&column| names.get(column));
                IdentError::Columns { names: names.map(|unknown| unknown.id.to_string()).collect() }
            })?;
            let away = below_zero(&fit.x, &taken, &self.regressors.not_below_zero());
            if away.is_empty() {
                return Ok(fit.among(&taken, matrix.ncols()));
            }
            taken = without(&taken, &away);
        }
    }

    /// What the linear parameters leave of a force: levels at rest are not below zero, or `tied` to
    /// the kinetic ones by a ratio.
    pub fn projection(
        &self,
        matrix: DMatrix<f64>,
        force: &DVector<f64>,
        tied: Option<f64>,
    ) -> Option<Projection> {
        match tied {
            Some(ratio) => Projection::tied(matrix, self.regressors.levels_at_rest(), ratio),
            None => Projection::bounded(matrix, force, self.regressors.not_below_zero()),
        }
    }

    /// Columns and force on the rows that count, without how the bristle began.
    pub fn system(&mut self, shape: &Shape) -> Result<System, IdentError> {
        let matrix = self.regressors.matrix(shape)?;
        let starts = self.regressors.starts(shape, self.rows.as_deref())?;
        let mut matrix = self.rows_of(matrix);
        let mut force = self.values_of(&self.regressors.force);
        starts.leave_out_of(&mut matrix);
        starts.leave_out(force.as_mut_slice());
        Ok(System { matrix, force, starts })
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

    /// Derivatives of the predicted force with respect to nonlinear parameters, the linear ones kept,
    /// on all rows.
    fn slopes(
        &mut self,
        shape: &Shape,
        linear: &DVector<f64>,
        terms: &[ShapeTerm],
    ) -> Result<Vec<DVector<f64>>, IdentError> {
        let (low, high) = (self.limits.low.delay, self.limits.high.delay);
        let h = 1e-4 * shape.delay.abs().max(1e-2 * high);
        let delays = [shape.delay - h, shape.delay + h].map(|delay| delay.clamp(low, high));
        self.regressors.slopes(terms, shape, delays, linear)
    }

    /// All parameters together, linear ones first, as a minimum of least squares.
    pub fn linearise(&mut self, best: &Best, terms: &[ShapeTerm]) -> Result<Minimum, IdentError> {
        let linear = best.solution.x.clone();
        let mut matrix = self.regressors.matrix(&best.shape)?;
        let starts = self.regressors.starts(&best.shape, None)?;
        starts.leave_out_of(&mut matrix);
        let (rows, columns) = matrix.shape();
        let mut jacobian = DMatrix::zeros(rows, columns + terms.len());
        jacobian.columns_mut(0, columns).copy_from(&-matrix);
        let mut x = linear.as_slice().to_vec();
        let mut held = vec![false; columns];
        for at_zero in self.regressors.not_below_zero().filter(|&level| linear[level] == 0.0) {
            held[at_zero] = true;
        }
        let slopes = self.slopes(&best.shape, &linear, terms)?;
        for (j, (&term, mut slope)) in terms.iter().zip(slopes).enumerate() {
            starts.leave_out(slope.as_mut_slice());
            let value = term.value(&best.shape);
            let (low, high) = (term.value(&self.limits.low), term.value(&self.limits.high));
            jacobian.set_column(columns + j, &-slope);
            x.push(value);
            let near = 1e-9 * (high - low);
            held.push(value <= low + near || value >= high - near);
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
    /// The fit that was asked for last: the derivatives are mostly those of the same.
    last: Option<Fitted>,
}

/// The linear fit for nonlinear parameters.
struct Fitted {
    shape: Shape,
    projection: Projection,
    starts: Starts,
    linear: DVector<f64>,
    rest: DVector<f64>,
}

impl Separable<'_, '_> {
    /// The linear fit for `x`.
    fn fitted(&mut self, x: &[f64]) -> Option<Fitted> {
        let shape = self.shape(x);
        if let Some(last) = self.last.take_if(|last| last.shape == shape) {
            return Some(last);
        }
        let System { matrix, force, starts } = self.search.system(&shape).ok()?;
        let tied = self.terms.contains(&ShapeTerm::Ratio).then_some(shape.ratio);
        let projection = self.search.projection(matrix, &force, tied)?;
        let (linear, rest) = projection.rest(&force);
        Some(Fitted { shape, projection, starts, linear, rest })
    }

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
        self.search.rows.as_ref().map_or(self.search.regressors.count(), Vec::len)
    }

    fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool {
        let Some(fitted) = self.fitted(x) else { return false };
        out.copy_from_slice(fitted.rest.as_slice());
        self.last = Some(fitted);
        true
    }

    /// Kaufman's (1975): the change of the columns, projected off what the linear parameters can
    /// follow.
    fn jacobian(&mut self, x: &[f64], _: &[f64], jacobian: &mut DMatrix<f64>) -> bool {
        let Some(fitted) = self.fitted(x) else { return false };
        let Fitted { shape, projection, starts, linear, .. } = &fitted;
        let Ok(slopes) = self.search.slopes(shape, linear, self.terms) else { return false };
        for (j, (&term, slope)) in self.terms.iter().zip(slopes).enumerate() {
            let mut slope = self.search.values_of(&slope) * term.stretch(term.value(shape));
            starts.leave_out(slope.as_mut_slice());
            jacobian.set_column(j, &-projection.rest(&slope).1);
        }
        self.last = Some(fitted);
        true
    }
}
