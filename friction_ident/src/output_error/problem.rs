//! The fit as a sum of squares.

use friction_model::Dual;
use nalgebra::DMatrix;

use super::Measured;
use super::along::Along;
use super::motion::motion;
use super::slopes::{AT_ONCE, Slopes};
use crate::bounded::{Bound, Residuals};
use crate::free_parameters::FreeParameters;
use crate::rest::{at_rest, holds};

/// The fit as a sum of squares.
pub(super) struct OutputError<'a> {
    free: &'a FreeParameters,
    data: &'a Measured<'a>,
    /// Of each stretch the samples at rest; none of a model that predicts those too.
    rest: Vec<Vec<bool>>,
    /// What multiplies each term beside friction, in the order of points and samples.
    beside: Vec<Vec<f64>>,
    /// What the model predicts of all points and samples, and the numbers it has there: a search
    /// that moves only what acts beside friction does not run it again.
    predicted: Vec<f64>,
    ran_at: Vec<f64>,
    /// The derivatives of the residuals, and the numbers that they hold at; none where they are to
    /// be computed.
    slopes: DMatrix<f64>,
    slopes_at: Vec<f64>,
    /// Whether derivatives were asked for at the last point. Then the search goes on from it, the
    /// next point is likely to be taken too, and its derivatives are carried along at once.
    eager: bool,
    /// Runs of the model, with derivatives and without.
    runs: usize,
    /// Usual magnitudes of the unknowns, and the norm of a change of the residuals that is lost in
    /// rounding.
    scales: Vec<f64>,
    rounding: f64,
}

impl<'a> OutputError<'a> {
    pub fn new(free: &'a FreeParameters, start: &[f64], data: &'a Measured<'a>) -> Self {
        let ranges = free.model(start).is_some_and(|model| holds(&model));
        let rest = |stretch| {
            let rest = if ranges { at_rest(stretch) } else { Vec::new() };
            if rest.contains(&true) { rest } else { Vec::new() }
        };
        let rest = data.stretches.iter().map(rest).collect();
        let beside = data.beside.terms().into_iter().map(|term| data.regressors(term)).collect();
        let predicted = vec![0.0; data.len()];
        let rounding = f64::EPSILON * data.square().sqrt();
        let mut problem = Self {
            free,
            data,
            rest,
            beside,
            predicted,
            ran_at: Vec::new(),
            slopes: DMatrix::zeros(0, 0),
            slopes_at: Vec::new(),
            eager: true,
            runs: 0,
            scales: Vec::new(),
            rounding,
        };
        problem.scales = problem.bounds().iter().map(|bound| bound.scale).collect();
        problem
    }

    /// Those of the model's numbers; what acts beside friction has none.
    pub fn bounds(&self) -> Vec<Bound> {
        let mut bounds = self.free.bounds();
        let size = (self.data.mean_square()).sqrt();
        bounds.extend(self.beside.iter().map(|column| {
            let most = column.iter().fold(0.0f64, |most, value| most.max(value.abs()));
            Bound::free(size.max(f64::MIN_POSITIVE) / most.max(f64::MIN_POSITIVE))
        }));
        bounds
    }

    /// How many residuals each stretch has.
    pub fn pieces(&self) -> Vec<usize> {
        let resting = |rest: &Vec<bool>| rest.iter().filter(|rest| **rest).count();
        let samples = self.data.stretches.iter().zip(&self.rest);
        samples.map(|(s, rest)| s.len() - resting(rest)).collect()
    }

    /// What moves at each residual.
    pub fn motion(&self) -> Vec<Vec<f64>> {
        motion(self.data, &self.rest)
    }

    /// Runs of the model over the whole data so far. One that carries derivatives counts as one.
    pub fn runs(&self) -> usize {
        self.runs
    }

    /// Runs the model with these numbers and their derivatives; false where there is no such model.
    fn differentiate(&mut self, numbers: &[f64]) -> bool {
        self.ran_at.clear();
        self.slopes_at.clear();
        let (m, n) = (self.len(), numbers.len() + self.beside.len());
        if self.slopes.shape() != (m, n) {
            self.slopes = DMatrix::zeros(m, n);
        }
        for first in (0..numbers.len()).step_by(AT_ONCE) {
            // Those of other columns are beyond what is carried at once.
            let place = |j: usize| j.checked_sub(first).unwrap_or(usize::MAX);
            let coordinates: Vec<Dual<AT_ONCE>> =
                (0..).zip(numbers).map(|(j, &value)| Dual::variable(value, place(j))).collect();
            let slopes = Slopes {
                data: self.data,
                rest: &self.rest,
                predicted: &mut self.predicted,
                jacobian: &mut self.slopes,
                columns: first..numbers.len().min(first + AT_ONCE),
            };
            if self.free.visit_in(&coordinates, slopes).is_none() {
                return false;
            }
            self.runs += 1;
        }
        self.ran_at.extend_from_slice(numbers);
        self.slopes_at.extend_from_slice(numbers);
        true
    }

    /// Runs the model with these numbers; false where there is no such model.
    fn run(&mut self, numbers: &[f64]) -> bool {
        if self.ran_at == numbers {
            return true;
        }
        let eager = std::mem::take(&mut self.eager) && numbers.len() <= AT_ONCE;
        if eager && self.free.are_smooth() {
            return self.differentiate(numbers);
        }
        self.ran_at.clear();
        let Some(model) = self.free.model(numbers) else { return false };
        self.runs += 1;
        let (points, mut samples) = self.predicted.split_at_mut(self.data.points.len());
        for (point, predicted) in self.data.points.iter().zip(points) {
            *predicted = model.steady_state(point.velocity);
        }
        for (stretch, rest) in self.data.stretches.iter().zip(&self.rest) {
            let (here, others) = samples.split_at_mut(stretch.len());
            samples = others;
            model.visit(Along { stretch, rest, out: here });
        }
        self.ran_at.extend_from_slice(numbers);
        true
    }

    /// Hands all points and samples that have a residual to `f`, in their order: the place among
    /// all, what was measured, and its standard deviation.
    fn each(&self, mut f: impl FnMut(usize, f64, f64)) {
        for (place, point) in self.data.points.iter().enumerate() {
            f(place, point.torque, point.deviation.unwrap_or(1.0));
        }
        let mut first = self.data.points.len();
        for (stretch, rest) in self.data.stretches.iter().zip(&self.rest) {
            let deviation = stretch.deviation.unwrap_or(1.0);
            for (k, &friction) in stretch.friction.iter().enumerate() {
                if !rest.get(k).copied().unwrap_or(false) {
                    f(first + k, friction, deviation);
                }
            }
            first += stretch.len();
        }
    }
}

impl Residuals for OutputError<'_> {
    fn len(&self) -> usize {
        let resting = self.rest.iter().flatten().filter(|rest| **rest).count();
        self.data.len() - resting
    }

    fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool {
        let Some((numbers, values)) = x.split_at_checked(self.free.ids().len()) else {
            return false;
        };
        if !self.run(numbers) {
            return false;
        }
        let mut out = out.iter_mut();
        self.each(|place, measured, deviation| {
            let beside: f64 =
                self.beside.iter().zip(values).map(|(column, value)| value * column[place]).sum();
            if let Some(r) = out.next() {
                *r = (self.predicted[place] + beside - measured) / deviation;
            }
        });
        true
    }

    /// What the model's numbers do is carried along its states; what acts beside is linear.
    fn jacobian(&mut self, x: &[f64], _: &[f64], jacobian: &mut DMatrix<f64>) -> bool {
        let Some((numbers, _)) = x.split_at_checked(self.free.ids().len()) else {
            return false;
        };
        self.eager = true;
        let known = self.slopes_at == numbers;
        if !self.free.are_smooth() || !known && !self.differentiate(numbers) {
            return false;
        }
        std::mem::swap(jacobian, &mut self.slopes);
        self.slopes_at.clear();
        for (j, column) in self.beside.iter().enumerate() {
            let mut out = jacobian.column_mut(numbers.len() + j);
            let mut out = out.iter_mut();
            self.each(|place, _, deviation| {
                if let Some(slope) = out.next() {
                    *slope = column[place] / deviation;
                }
            });
        }
        // An unknown that moves nothing by more than the rounding moves nothing.
        for (mut column, scale) in jacobian.column_iter_mut().zip(&self.scales) {
            let moves = column.norm();
            if !moves.is_finite() {
                return false;
            }
            if moves * scale <= self.rounding {
                column.fill(0.0);
            }
        }
        true
    }
}
