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
//! What acts beside friction ([`position_load`](crate::position_load)) is linear and may be estimated
//! in the same fit.
//!
//! At rest a model without pre-sliding predicts a range, not a value: it is not fitted to samples
//! that stand still.

use std::ops::ControlFlow;

use friction_model::{AnyModel, FrictionModel, ModelVisitor, Stepper, TimeStep};

use crate::IdentError;
use crate::axis_term::AxisTerm;
use crate::bounded::{Bound, Ending, Minimum, Patience, Residuals, Step, minimise};
use crate::estimate::{Estimates, robust_errors};
use crate::free_parameters::FreeParameters;
use crate::position_load::{self, LoadShape, PositionLoad, Predictor, place, regressor};
use crate::residual_whiteness::effective_share;
use crate::rest::{at_rest, holds};
use crate::steady_point::SteadyPoint;
use crate::stretch::{Before, Stretch};

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
            .flat_map(|stretch| (0..stretch.len()).map(|k| regressor(term, place(stretch, k))));
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
    /// Simulations of the whole data.
    pub evaluations: usize,
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
            restarts: 2,
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
            lower: "the number of free parameters",
        });
    }
    let bounds = problem.bounds();
    let pieces = problem.pieces();
    let starts: Vec<Vec<f64>> = starts
        .iter()
        .map(|start| start.iter().copied().chain(terms.iter().map(|_| 0.0)).collect())
        .collect();
    let mut best: Option<(Minimum, bool)> = None;
    let mut evaluations = 0;
    let rounding = data.square() * f64::EPSILON.powi(2) * 16.0;
    for start in std::iter::once(&own).chain(&starts) {
        let Some(mut found) = minimise(&mut problem, start, &bounds, &options.patience, watch)
        else {
            continue;
        };
        evaluations += found.evaluations;
        let mut settled = found.ending == Ending::Converged;
        // Friction has kinks, at which a search may stall: from where it ended it starts again,
        // with long steps.
        for _ in 0..options.restarts {
            if found.ending == Ending::Stopped || found.sum <= rounding {
                break;
            }
            let Some(next) = minimise(&mut problem, &found.x, &bounds, &options.patience, watch)
            else {
                break;
            };
            evaluations += next.evaluations;
            let fall = 1.0 - next.sum / found.sum;
            settled = next.ending == Ending::Converged || fall < SETTLED;
            found = next;
            if fall.is_nan() || fall < 1e-6 {
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
        robust_errors(&minimum, &pieces, &mut estimates);
    }
    let rms = prediction_rms(&Predictor { model, load }, data);
    Ok(OutputErrorFit { model, load, estimates, rms, ending, settled, evaluations })
}

/// Friction that `model` predicts along a stretch, one value a sample.
pub fn predict(model: &AnyModel, stretch: &Stretch) -> Vec<f64> {
    let mut predicted = vec![0.0; stretch.len()];
    let rest = if holds(model) { at_rest(stretch) } else { Vec::new() };
    model.visit(Along { stretch, rest: &rest, out: &mut predicted });
    predicted
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

/// The fit as a sum of squares.
struct OutputError<'a> {
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
    fn new(free: &'a FreeParameters, start: &[f64], data: &'a Measured<'a>) -> Self {
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
    fn bounds(&self) -> Vec<Bound> {
        let mut bounds = self.free.bounds();
        let size = (self.data.mean_square()).sqrt();
        bounds.extend(self.beside.iter().map(|column| {
            let most = column.iter().fold(0.0f64, |most, value| most.max(value.abs()));
            Bound::free(size.max(f64::MIN_POSITIVE) / most.max(f64::MIN_POSITIVE))
        }));
        bounds
    }

    /// Residuals of the points and of each stretch.
    fn pieces(&self) -> Vec<usize> {
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

/// Runs a model along a stretch.
struct Along<'a> {
    stretch: &'a Stretch,
    /// Samples at which the contact stands still, as far as they are known; a model that predicts
    /// those too does not ask.
    rest: &'a [bool],
    out: &'a mut [f64],
}

/// Longest period of a fixed-step model \[s\].
const LONGEST_STEP: f64 = 0.01;
/// Steps within which a contact that slides at a constant velocity is taken to be steady, at most.
const SETTLING: usize = 4_000;

impl ModelVisitor for Along<'_> {
    type Output = ();

    fn visit<M: FrictionModel>(self, model: M) {
        let Self { stretch, rest, out } = self;
        let substeps = (stretch.time_step / LONGEST_STEP).ceil().max(1.0);
        let Ok(dt) = TimeStep::new(stretch.time_step / substeps) else {
            out.fill(f64::NAN);
            return;
        };
        let mut stepper = Stepper::new(model, dt);
        if stretch.before == Before::Slid {
            slide(&mut stepper, stretch.velocity[0]);
        }
        let last = stretch.len() - 1;
        for (k, out) in out.iter_mut().enumerate() {
            let velocity = stretch.velocity[k];
            let state = stepper.state();
            let still = velocity == 0.0 || rest.get(k).copied().unwrap_or(false);
            *out = if still && stepper.model().holding(0.0).is_some() {
                // Models without pre-sliding say nothing about rest: they hold whatever is applied.
                let holding = stepper.model().holding(0.0);
                holding.map_or(0.0, |holding| holding.force(stretch.friction[k]))
            } else {
                stepper.model().evaluate(&state.continuous, &state.memory, velocity).force
            };
            if k < last {
                let mean = stretch.between(k);
                for _ in 0..substeps as usize {
                    stepper.step(mean);
                }
            }
        }
    }
}

/// Slides at `velocity` until the friction no longer changes.
fn slide<M: FrictionModel>(stepper: &mut Stepper<M>, velocity: f64) {
    if velocity == 0.0 {
        return;
    }
    let steady = stepper.model().steady_state(velocity);
    let mut quiet = 0;
    for _ in 0..SETTLING {
        let force = stepper.step(velocity);
        quiet = if (force - steady).abs() <= 1e-13 * steady.abs() { quiet + 1 } else { 0 };
        if quiet > 3 {
            break;
        }
    }
}

#[cfg(test)]
mod tests {
    use friction_model::ModelName;

    use super::*;

    const DT: f64 = 1e-3;

    /// Six seconds with reversals, slow and fast, small and large.
    fn motion() -> Vec<f64> {
        (0..6000)
            .map(|k| {
                let t = f64::from(k) * DT;
                0.4 * (1.3 * t).sin() * (0.37 * t).cos() + 0.03 * (11.0 * t).sin()
            })
            .collect()
    }

    fn data(truth: &AnyModel) -> Stretch {
        let velocity = motion();
        let mut stretch = Stretch::new(DT, velocity, None, vec![0.0; 6000]).unwrap();
        stretch.friction = predict(truth, &stretch);
        stretch
    }

    /// Every free coordinate moved by up to `most`, up and down by turns.
    fn moved(free: &FreeParameters, most: f64) -> Vec<f64> {
        let turns = [1.0, -0.75, 0.8, -1.0, 0.5, -0.5];
        free.start()
            .iter()
            .zip(turns.iter().cycle())
            .map(|(x, turn)| x * (1.0 + turn * most))
            .collect()
    }

    fn fit(truth: &AnyModel, most: f64) -> (FreeParameters, OutputErrorFit) {
        let stretch = data(truth);
        let free = FreeParameters::usual(truth);
        let away = FreeParameters::usual(&free.model(&moved(&free, most)).unwrap());
        let measured =
            Measured { stretches: std::slice::from_ref(&stretch), ..Measured::default() };
        let go = &mut |_: &Step| ControlFlow::Continue(());
        (free, fit_output_error(&away, &measured, &[], &OutputErrorOptions::default(), go).unwrap())
    }

    #[test]
    fn exact_data_give_the_parameters_back() {
        for name in [
            ModelName::CoulombViscous,
            ModelName::Stribeck,
            ModelName::Dahl,
            ModelName::LuGre,
            ModelName::ElastoPlastic,
            ModelName::Proposed,
        ] {
            let (free, fit) = fit(&AnyModel::test_bed(name), 0.25);
            for (estimate, truth) in fit.estimates.parameters.iter().zip(free.values()) {
                let off = (estimate.value / truth - 1.0).abs();
                assert!(
                    off < 1e-9,
                    "{name} {}: {} not {truth}, {:?}",
                    estimate.id,
                    estimate.value,
                    fit.ending
                );
                assert!(estimate.is_identified(), "{name} {estimate:?}");
            }
        }
    }

    /// Models with elements have many minima: from nearby Xiong's is found again. In GMS the
    /// damping force of an element jumps by 0.01 N m at the sample at which it begins to slip; no
    /// derivative sees such a jump move to the next sample, so some of them stay misplaced.
    #[test]
    fn elements_are_found_again_from_nearby() {
        for (name, limit) in [(ModelName::Xiong, 1e-6), (ModelName::Gms, 1e-3)] {
            let (_, fit) = fit(&AnyModel::test_bed(name), 0.01);
            assert!(fit.rms < limit, "{name}: rms {:.1e}, {:?}", fit.rms, fit.ending);
        }
    }

    #[test]
    fn a_search_that_is_stopped_keeps_the_best() {
        let stretch = data(&AnyModel::test_bed(ModelName::LuGre));
        let free = FreeParameters::usual(
            &AnyModel::test_bed(ModelName::LuGre).scaled("sigma0", 1.5).unwrap(),
        );
        let measured =
            Measured { stretches: std::slice::from_ref(&stretch), ..Measured::default() };
        let mut seen = Vec::new();
        let fit = fit_output_error(
            &free,
            &measured,
            &[],
            &OutputErrorOptions::default(),
            &mut |step: &Step| {
                seen.push(step.sum);
                if seen.len() == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            },
        )
        .unwrap();
        assert_eq!(fit.ending, Ending::Stopped);
        assert!((fit.rms * fit.rms * 6000.0 / seen[2] - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_motion_that_does_not_show_a_parameter_says_so() {
        // Always sliding fast: neither the dip nor the stiffness is there to be seen.
        let velocity: Vec<f64> = (0..3000).map(|k| 2.0 + (0.004 * f64::from(k)).sin()).collect();
        let truth = AnyModel::test_bed(ModelName::LuGre);
        let mut stretch = Stretch::new(DT, velocity, None, vec![0.0; 3000]).unwrap();
        stretch.friction = predict(&truth, &stretch);
        for (k, friction) in stretch.friction.iter_mut().enumerate() {
            *friction += 1e-3 * ((k * 7919 % 1009) as f64 / 504.5 - 1.0);
        }
        let measured =
            Measured { stretches: std::slice::from_ref(&stretch), ..Measured::default() };
        let go = &mut |_: &Step| ControlFlow::Continue(());
        let fit = fit_output_error(
            &FreeParameters::usual(&truth),
            &measured,
            &[],
            &OutputErrorOptions::default(),
            go,
        )
        .unwrap();
        let verdict = |name: &'static str| fit.estimates.get(name).unwrap().is_identified();
        assert!(verdict("f_c") && verdict("f_v"), "{:?}", fit.estimates);
        assert!(!verdict("sigma0") && !verdict("v_s") && !verdict("f_s"), "{:?}", fit.estimates);
    }
}
