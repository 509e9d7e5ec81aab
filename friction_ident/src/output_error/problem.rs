//! The fit as a sum of squares.

use super::Measured;
use super::along::Along;
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
        Self { free, data, rest, beside, predicted, ran_at: Vec::new() }
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

    /// Residuals of the points and of each stretch.
    pub fn pieces(&self) -> Vec<usize> {
        let resting = |rest: &Vec<bool>| rest.iter().filter(|rest| **rest).count();
        let samples = self.data.stretches.iter().zip(&self.rest);
        let points = (!self.data.points.is_empty()).then_some(self.data.points.len());
        points.into_iter().chain(samples.map(|(s, rest)| s.len() - resting(rest))).collect()
    }

    /// Runs the model with these numbers; false where there is no such model.
    fn run(&mut self, numbers: &[f64]) -> bool {
        if self.ran_at == numbers {
            return true;
        }
        self.ran_at.clear();
        let Some(model) = self.free.model(numbers) else { return false };
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
        let beside = |row: usize| -> f64 {
            self.beside.iter().zip(values).map(|(column, value)| value * column[row]).sum()
        };
        let points = self.data.points.iter().map(|point| (point.torque, point.deviation, false));
        let samples = self.data.stretches.iter().zip(&self.rest).flat_map(|(stretch, rest)| {
            let at_rest = |k: usize| rest.get(k).copied().unwrap_or(false);
            let friction = stretch.friction.iter().enumerate();
            friction.map(move |(k, &friction)| (friction, stretch.deviation, at_rest(k)))
        });
        let measured = points.chain(samples).zip(&self.predicted).enumerate();
        let counted = measured.filter(|(_, ((_, _, rests), _))| !rests);
        for (r, (row, ((measured, deviation, _), predicted))) in out.iter_mut().zip(counted) {
            *r = (predicted + beside(row) - measured) / deviation.unwrap_or(1.0);
        }
        true
    }
}
