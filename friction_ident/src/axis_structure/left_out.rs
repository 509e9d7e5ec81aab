//! The fit without a part of the recording, from the fit to all of it.
//!
//! Without an eighth of the rows the parameters move by a fraction of their errors. So far the model
//! is straight: one step of Gauss and Newton from the fit to all rows arrives (the one-step
//! jackknife; Fox, Hinkley and Larntz 1980, Technometrics 22). It costs one small system of
//! equations in place of a search in which every trial filters the recording anew. Where the step is
//! longer than the model is straight, there is no answer, and a search has to be made.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::search::{Best, Search};
use super::shape::{LONGEST_DELAY, Shape, ShapeTerm};
use crate::IdentError;
use crate::finite::finite;

/// Change of the logarithm of a velocity or a displacement up to which the model counts as straight.
const STRAIGHT: f64 = 0.1;
/// The same of a delay, in samples.
const STRAIGHT_DELAY: f64 = 0.5;
/// The same of a period, in waves along the travel.
const STRAIGHT_WAVES: f64 = 0.03;
/// How much the nonlinear parameters are held back where a step is too long, at first.
const HOLD: f64 = 1e-4;
/// And at most.
const MOST_HELD: f64 = 1e4;
/// The least that must be left of a column, squared, when the others have been taken off it: less is
/// lost in rounding.
const LEAST_PIVOT: f64 = 1e-8;

/// A fit to all rows with its derivatives.
pub(super) struct Whole {
    /// Derivative of the residual with respect to each parameter, linear ones first.
    pub slopes: DMatrix<f64>,
    residual: DVector<f64>,
    terms: Vec<ShapeTerm>,
    shape: Shape,
    linear: usize,
    /// The linear ones.
    levels: DVector<f64>,
    /// The parameters that no bound holds.
    free: Vec<usize>,
    /// Those that one holds, and whether it is the upper one.
    held: Vec<(usize, bool)>,
    scale: Vec<f64>,
    normal: DMatrix<f64>,
    gradient: DVector<f64>,
}

impl Whole {
    pub fn of(search: &mut Search, best: &Best) -> Result<Self, IdentError> {
        let terms = ShapeTerm::of(&search.structure);
        let minimum = search.linearise(best, &terms)?;
        let levels = best.solution.x.clone();
        let linear = levels.len();
        let (slopes, residual) = (minimum.jacobian, minimum.residuals);
        let scale: Vec<f64> = slopes.column_iter().map(|column| column.norm()).collect();
        let (mut normal, mut gradient) = (slopes.tr_mul(&slopes), slopes.tr_mul(&residual));
        scaled(&mut normal, &mut gradient, &scale);
        let mut held: Vec<(usize, bool)> = terms
            .iter()
            .enumerate()
            .filter(|(j, _)| minimum.held[linear + j])
            .map(|(j, term)| {
                let low = term.value(&search.limits.low);
                let high = term.value(&search.limits.high);
                (linear + j, term.value(&best.shape) > 0.5 * (low + high))
            })
            .collect();
        held.extend((0..linear).filter(|&level| minimum.held[level]).map(|level| (level, false)));
        let free = (0..scale.len()).filter(|&j| !minimum.held[j]).collect();
        let shape = best.shape;
        Ok(Self {
            slopes,
            residual,
            terms,
            shape,
            linear,
            levels,
            free,
            held,
            scale,
            normal,
            gradient,
        })
    }

    /// The change of each parameter, linear ones first, without the rows in `out`; none where the
    /// model is not straight so far, or where what is left does not show a parameter. Along a
    /// valley, where the step is long and gains nothing, a shorter one predicts as well: it may
    /// leave `over` a share of the sum of squares.
    pub fn without(&self, search: &Search, out: Range<usize>, over: f64) -> Option<DVector<f64>> {
        let count = out.len();
        let (slopes, residual) =
            (self.slopes.rows(out.start, count), self.residual.rows(out.start, count));
        let left = self.residual.norm_squared() - residual.norm_squared();
        let (mut normal, mut gradient) = (slopes.tr_mul(&slopes), slopes.tr_mul(&residual));
        scaled(&mut normal, &mut gradient, &self.scale);
        let (normal, gradient) = (&self.normal - normal, &self.gradient - gradient);
        let sum = |change: &DVector<f64>| {
            left + 2.0 * gradient.dot(change) + change.dot(&(&normal * change))
        };
        let longest = self.step(&normal, &gradient, 0.0)?;
        let least = sum(&longest);
        let mut change = longest;
        let mut hold = HOLD;
        while !self.is_straight(search, &change) {
            change = self.step(&normal, &gradient, hold)?;
            hold *= 10.0;
            let as_good = sum(&change) - least <= over * least;
            if !as_good || hold > MOST_HELD {
                return None;
            }
        }
        // A bound that holds with all rows may let go without some.
        let pull = &gradient + &normal * &change;
        if self.held.iter().any(|&(j, upper)| if upper { pull[j] > 0.0 } else { pull[j] < 0.0 }) {
            return None;
        }
        change.iter_mut().zip(&self.scale).for_each(|(change, scale)| *change /= scale);
        // And one that does not hold with all rows may.
        let mut levels = search.regressors.not_below_zero();
        levels.all(|level| self.levels[level] + change[level] >= 0.0).then_some(change)
    }

    /// The step of the free parameters, in units of the scale, with the nonlinear ones held back.
    fn step(
        &self,
        normal: &DMatrix<f64>,
        gradient: &DVector<f64>,
        hold: f64,
    ) -> Option<DVector<f64>> {
        let mut of_free = normal.select_rows(&self.free).select_columns(&self.free);
        for (k, _) in self.free.iter().enumerate().filter(|(_, j)| **j >= self.linear) {
            of_free[(k, k)] += hold;
        }
        let factor = finite(of_free)?.cholesky()?;
        if factor.l_dirty().diagonal().iter().any(|pivot| pivot * pivot < LEAST_PIVOT) {
            return None;
        }
        let step = factor.solve(&-gradient.select_rows(&self.free));
        let mut change = DVector::zeros(self.scale.len());
        for (&j, step) in self.free.iter().zip(step.iter()) {
            change[j] = *step;
        }
        Some(change)
    }

    /// How the unknowns of the other nonlinear parameters follow that of `term`, where the sum of
    /// squares is least; those that a bound holds stay.
    pub fn along(&self, term: ShapeTerm) -> Vec<(ShapeTerm, f64)> {
        let Some(own) = self.terms.iter().position(|other| *other == term) else { return vec![] };
        let own = self.linear + own;
        let others: Vec<usize> = self.free.iter().copied().filter(|&j| j != own).collect();
        let of_others = self.normal.select_rows(&others).select_columns(&others);
        let right = self.normal.column(own).select_rows(&others);
        let Some(factor) = finite(of_others).and_then(DMatrix::cholesky) else { return vec![] };
        let follow = factor.solve(&-right);
        let unknown =
            |j: usize, term: ShapeTerm| self.scale[j] * term.stretch(term.value(&self.shape));
        let nonlinear = others.iter().zip(follow.iter()).filter(|(j, _)| **j >= self.linear);
        nonlinear
            .map(|(&j, follow)| {
                let other = self.terms[j - self.linear];
                (other, follow * unknown(own, term) / unknown(j, other))
            })
            .collect()
    }

    /// What the model leaves of the force on the rows in `range` after a change of its parameters.
    pub fn rest(&self, change: &DVector<f64>, range: Range<usize>) -> DVector<f64> {
        let slopes = self.slopes.rows(range.start, range.len());
        self.residual.rows(range.start, range.len()) + slopes * change
    }

    /// Whether no nonlinear parameter moves further than the model is straight, or out of its limits;
    /// `change` in units of the scale.
    fn is_straight(&self, search: &Search, change: &DVector<f64>) -> bool {
        let limits = &search.limits;
        self.terms.iter().enumerate().all(|(j, term)| {
            let j = self.linear + j;
            let change = change[j] / self.scale[j];
            let value = term.value(&self.shape);
            let to = value + change;
            let within = term.value(&limits.low) <= to && to <= term.value(&limits.high);
            let reach = match term {
                ShapeTerm::Delay => STRAIGHT_DELAY * limits.high.delay / LONGEST_DELAY as f64,
                ShapeTerm::Period => STRAIGHT_WAVES * value * value / (0.5 * limits.high.period),
                _ => STRAIGHT * value,
            };
            change == 0.0 || within && change.abs() <= reach
        })
    }
}

/// Normal equations of columns scaled to unit length.
fn scaled(normal: &mut DMatrix<f64>, gradient: &mut DVector<f64>, scale: &[f64]) {
    for i in 0..scale.len() {
        for j in 0..scale.len() {
            normal[(i, j)] /= scale[i] * scale[j];
        }
        gradient[i] /= scale[i];
    }
}

#[cfg(test)]
mod tests {
    use super::super::shape::PositionScale;
    use super::super::tests::stribeck_axis;
    use super::*;

    /// What a search without an eighth of the rows finds and predicts, block by block.
    #[test]
    fn a_straight_step_arrives_where_a_search_does() {
        let recording = stribeck_axis();
        let scale = PositionScale::of(&recording);
        let structure = "asymmetric+stribeck+delay".parse().unwrap();
        let mut search = Search::new(&recording, structure, scale).unwrap();
        let best = search.whole().unwrap();
        let whole = Whole::of(&mut search, &best).unwrap();
        let rows = search.regressors.count();
        let mut stepped = 0;
        for block in 0..8 {
            let out = block * rows / 8..(block + 1) * rows / 8;
            let Some(change) = whole.without(&search, out.clone(), 0.0) else { continue };
            stepped += 1;
            search.rows = Some((0..rows).filter(|row| !out.contains(row)).collect());
            let found = search.from(best.shape, &[]).unwrap();
            search.rows = None;
            let matrix = search.regressors.matrix(&found.shape).unwrap();
            let predicted = matrix.rows(out.start, out.len()) * &found.solution.x;
            let there = (search.regressors.force.rows(out.start, out.len()) - predicted).norm();
            let here = whole.rest(&change, out.clone()).norm();
            assert!((here / there - 1.0).abs() < 1e-3, "block {block}: {here} {there}");
            // And it is another fit than that to all rows.
            let moved = found.solution.x[0] - best.solution.x[0];
            assert!((change[0] - moved).abs() < 0.05 * moved.abs().max(1e-3), "{change} {moved}");
        }
        assert!(stepped >= 6, "{stepped} blocks by a step");
    }
}
