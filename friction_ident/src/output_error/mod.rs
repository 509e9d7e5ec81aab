//! Output-error fit: the parameters with which a model, driven along the measured motion, gives the
//! measured friction.
//!
//! Works for every model and any motion, and refines what the stages found from one kind of
//! recording each. The model runs in its fixed-step form: the force is that of the state at a
//! sample and the velocity there; the state then advances under the mean velocity up to the next
//! sample, so that the lag of half a sample which a held velocity would have does not end up in the
//! time constants. Steady points count through the steady state. All residuals are divided by their
//! standard deviation where that is known.
//!
//! What acts beside friction ([`position_load`]) is linear and may be estimated
//! in the same fit.
//!
//! The derivatives of the residuals are carried along with the states of the model. Only where a
//! shape exponent is free they are forward differences.
//!
//! At rest a model without pre-sliding predicts a range, not a value: it is not fitted to samples
//! that stand still.

mod along;
mod far_from_rest;
mod motion;
mod predictor;
mod problem;
mod slopes;
#[cfg(test)]
mod tests;

use std::ops::ControlFlow;

use friction_model::AnyModel;

use crate::IdentError;
use crate::axis_term::AxisTerm;
use crate::bounded::{Ending, Minimum, Patience, Residuals, Step, minimise};
use crate::estimate::{Estimates, robust_errors};
use crate::free_parameters::FreeParameters;
use crate::near_rest::{LeftNearRest, left_near_rest};
use crate::place::regressor;
use crate::position_load::{self, LoadShape, PositionLoad};
use crate::residual_whiteness::effective_share;
use crate::robust_covariance::Course;
use crate::steady_point::SteadyPoint;
use crate::stretch::Stretch;
use far_from_rest::{heed_sliding, is_far_from_rest};
use problem::OutputError;

pub use along::predict;
pub use predictor::Predictor;

/// What a model is fitted to.
#[derive(Debug, Clone, Copy, Default)]
pub struct Measured<'a> {
    /// Steady points, if any.
    pub points: &'a [SteadyPoint],
    /// Stretches, if any.
    pub stretches: &'a [Stretch],
    /// What acts beside friction in them, and is estimated with it.
    pub beside: LoadShape,
}

impl Measured<'_> {
    /// Residuals it gives.
    pub fn len(&self) -> usize {
        self.points.len() + self.stretches.iter().map(Stretch::len).sum::<usize>()
    }

    /// Whether there is nothing.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// What multiplies a term in each point and sample, in the order of the residuals.
    fn regressors(&self, term: AxisTerm) -> Vec<f64> {
        let points = self.points.iter().map(|point| regressor(term, point.place));
        let samples = self
            .stretches
            .iter()
            .flat_map(|stretch| (0..stretch.len()).map(|k| regressor(term, stretch.place(k))));
        points.chain(samples).collect()
    }

    /// Mean square of what was measured.
    fn mean_square(&self) -> f64 {
        let points = self.points.iter().map(|point| point.torque);
        let samples = self.stretches.iter().flat_map(|stretch| &stretch.friction).copied();
        points.chain(samples).map(|f| f * f).sum::<f64>() / self.len().max(1) as f64
    }

    /// Sum of the squares of all weighted measurements.
    fn square(&self) -> f64 {
        let weight = |deviation: Option<f64>| deviation.unwrap_or(1.0).powi(-2);
        let points = self.points.iter().map(|point| point.torque.powi(2) * weight(point.deviation));
        let stretches = self.stretches.iter().map(|stretch| {
            stretch.friction.iter().map(|f| f * f).sum::<f64>() * weight(stretch.deviation)
        });
        points.chain(stretches).sum()
    }
}

/// A fitted model.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputErrorFit {
    /// The model with the best parameters.
    pub model: AnyModel,
    /// What acts beside it.
    pub load: PositionLoad,
    /// The free parameters with their uncertainty, then those of what acts beside.
    pub estimates: Estimates,
    /// Root mean square of predicted minus measured friction over all points and samples
    /// \[N or N m\].
    pub rms: f64,
    /// Why the search ended.
    pub ending: Ending,
    /// Whether it ended where nothing is to be gained any more: not where it was stopped, nor where
    /// the last round of a search without patience still went down.
    pub settled: bool,
    /// Simulations of the whole data. One that carries up to eight derivatives counts as one.
    pub evaluations: usize,
    /// What it leaves near rest, where the model lacks something there.
    pub left: Option<LeftNearRest>,
}

/// How the fit is done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutputErrorOptions {
    /// When a search ends.
    pub patience: Patience,
    /// How often a search that ended starts again from where it ended, at most.
    pub restarts: usize,
    /// Whether the axis turns; decides the units.
    pub rotary: bool,
}

impl Default for OutputErrorOptions {
    fn default() -> Self {
        Self {
            patience: Patience { sum: 1e-9, step: 1e-9, iterations: 30, broyden: false },
            restarts: 5,
            rotary: true,
        }
    }
}

/// Share of the residuals that count as independent from which they are white.
const WHITE: f64 = 0.5;
/// Sum of squares over that of what was measured, below which a fit is exact.
const EXACT: f64 = 1e-20;
/// Relative fall of the sum of squares over a whole round of a search below which it has arrived.
const SETTLED: f64 = 1e-4;
/// Restarts that a search makes even where it has arrived.
const FOR_KINKS: usize = 2;

/// Fits the free parameters, from each of `starts` (coordinates of `free`; its own values are tried
/// first) and keeps the best.
///
/// # Errors
/// [`IdentError`] for data that is not fit for use, and [`IdentError::NoConvergence`] if no start
/// is allowed by the model.
pub fn fit_output_error(
    free: &FreeParameters,
    data: &Measured,
    starts: &[Vec<f64>],
    options: &OutputErrorOptions,
    watch: &mut dyn FnMut(&Step) -> ControlFlow<()>,
) -> Result<OutputErrorFit, IdentError> {
    for stretch in data.stretches {
        stretch.check()?;
    }
    let terms = data.beside.terms();
    let n = free.ids().len() + terms.len();
    let own: Vec<f64> = free.start().into_iter().chain(terms.iter().map(|_| 0.0)).collect();
    let mut problem = OutputError::new(free, &own, data);
    if problem.len() <= n {
        return Err(IdentError::TooFewSamples {
            what: "an output-error fit",
            needed: n + 1,
            found: problem.len(),
            lower: Some("the number of free parameters"),
        });
    }
    let bounds = problem.bounds();
    let pieces = problem.pieces();
    let starts: Vec<Vec<f64>> = starts
        .iter()
        .map(|start| start.iter().copied().chain(terms.iter().map(|_| 0.0)).collect())
        .collect();
    let mut best: Option<(Minimum, bool)> = None;
    let rounding = data.square() * f64::EPSILON.powi(2) * 16.0;
    for start in std::iter::once(&own).chain(&starts) {
        let Some(mut found) = minimise(&mut problem, start, &bounds, &options.patience, watch)
        else {
            continue;
        };
        let mut settled = found.ending == Ending::Converged;
        // Friction has kinks, at which a search may stall: from where it ended it starts again,
        // with long steps.
        for round in 1..=options.restarts {
            if found.ending == Ending::Stopped || found.sum <= rounding {
                break;
            }
            let Some(next) = minimise(&mut problem, &found.x, &bounds, &options.patience, watch)
            else {
                break;
            };
            let fall = 1.0 - next.sum / found.sum;
            settled = next.ending == Ending::Converged || fall < SETTLED;
            found = next;
            // The first few are for kinks; what is not settled by then may just be a long way.
            if fall.is_nan() || fall < 1e-6 || (settled && round >= FOR_KINKS) {
                break;
            }
        }
        let stopped = found.ending == Ending::Stopped;
        settled &= !stopped;
        if best.as_ref().is_none_or(|(best, _)| found.sum < best.sum) {
            best = Some((found, settled));
        }
        if stopped {
            break;
        }
    }
    let refused = || {
        IdentError::NoConvergence("the model does not accept any of the start values".to_owned())
    };
    let (minimum, settled) = best.ok_or_else(refused)?;
    let ending = minimum.ending;
    let (numbers, values) = minimum.x.split_at(free.ids().len());
    let model = free.model(numbers).ok_or_else(refused)?;
    let load = PositionLoad::of(&terms, values);
    let share = effective_share(minimum.residuals.as_slice());
    let minimum = free.in_parameters(minimum).ok_or_else(refused)?;
    let mut unknowns = free.unknowns(options.rotary);
    unknowns.extend(position_load::unknowns(&terms, options.rotary));
    let mut estimates = Estimates::linearised(&minimum, &unknowns, share);
    // Errors of white residuals are known better without; exact data leave nothing but rounding.
    let exact = minimum.sum <= EXACT * data.square();
    if share < WHITE && !exact && !data.stretches.is_empty() {
        let points = data.points.len();
        let course = Course { points, pieces: &pieces, motion: &problem.motion() };
        robust_errors(&minimum, &course, &mut estimates);
    }
    let left = if exact { None } else { left(&problem, minimum.residuals.as_slice(), data) };
    if let Some(left) = &left {
        heed_sliding(&minimum, &problem.motion(), left, &mut estimates);
        distrust_near_rest(&mut estimates, left);
    }
    let rms = prediction_rms(&Predictor { model, load }, data);
    let evaluations = problem.runs();
    Ok(OutputErrorFit { model, load, estimates, rms, ending, settled, evaluations, left })
}

/// What the residuals (predicted less measured) repeat near rest.
fn left(problem: &OutputError, residuals: &[f64], data: &Measured) -> Option<LeftNearRest> {
    let points = data.points.len();
    let motion = problem.motion();
    let [velocity, _, way] = [0, 1, 2].map(|of| motion.get(of).and_then(|all| all.get(points..)));
    let left: Vec<f64> = residuals.get(points..)?.iter().map(|r| -r).collect();
    let size = (data.square() / data.len().max(1) as f64).sqrt();
    left_near_rest(&left, size, velocity?, way?)
}

/// Says of the parameters that act near rest that something else has taken part in them.
fn distrust_near_rest(estimates: &mut Estimates, left: &LeftNearRest) {
    let remedy = "a model that has it, or slow motion in which both show apart";
    estimates.distrust_but(is_far_from_rest, &left.to_string(), remedy);
}

/// Root mean square of predicted minus measured force over all points and samples.
pub fn prediction_rms(by: &Predictor, data: &Measured) -> f64 {
    let points = data.points.iter().map(|point| (by.steady(point) - point.torque).powi(2));
    let stretches = data.stretches.iter().flat_map(|stretch| {
        by.along(stretch)
            .into_iter()
            .zip(&stretch.friction)
            .map(|(p, f)| (p - f).powi(2))
            .collect::<Vec<_>>()
    });
    (points.chain(stretches).sum::<f64>() / data.len().max(1) as f64).sqrt()
}
