//! The stages, one after the other.

use std::borrow::Cow;
use std::ops::ControlFlow;

use friction_model::{AnyModel, ModelName};

use super::decided::{Damping, Exponent};
use super::friction_data::{weighted, weighted_points};
use super::last_word::{last_word, take_over};
use super::load_choice::first_values;
use super::prediction::residuals_that_count;
use super::stage::{DAMPING, LAG, PRE_SLIDING, STATIC};
use super::viscosity::with_some_viscosity;
use super::{FrictionData, Identified, Stage, StageResult, StagedOptions};
use crate::IdentError;
use crate::axis_term::AxisTerm;
use crate::bounded::{Ending, Step};
use crate::estimate::{Doubt, Estimates, Verdict};
use crate::free_parameters::FreeParameters;
use crate::information::Information;
use crate::output_error::{Measured, OutputErrorFit, Predictor, fit_output_error};
use crate::parameter_id::{ParameterId, Side};
use crate::position_load::{LoadShape, PositionLoad};
use crate::residual_whiteness::effective_share;
use crate::rigid_axis::Load;
use crate::starting_model::{scaled_to, with_elements};
use crate::static_curve::{StribeckFit, StribeckValues};
use crate::steady_point::SteadyPoint;
use crate::stretch::Stretch;

/// What the stages share.
pub(super) struct Work<'a> {
    pub(super) name: ModelName,
    /// The recordings without what acts beside friction, as far as it was known at first.
    pub(super) data: Cow<'a, FrictionData>,
    /// The recordings as they are.
    measured: &'a FrictionData,
    pub(super) options: &'a StagedOptions,
    /// What was taken out of `data`.
    taken: PositionLoad,
    /// What acts beside friction, by the last fit that estimated it.
    pub(super) load: PositionLoad,
    pub(super) stages: Vec<StageResult>,
    pub(super) notes: Vec<String>,
    pub(super) exponent: Exponent,
    pub(super) stopped: bool,
    pub(super) converged: bool,
}

pub(super) type Watch<'w> = &'w mut dyn FnMut(Stage, &Step) -> ControlFlow<()>;

impl<'a> Work<'a> {
    pub fn new(name: ModelName, measured: &'a FrictionData, options: &'a StagedOptions) -> Self {
        let beside = options.beside;
        let taken = first_values(measured, beside, options.asymmetric);
        let data = if beside == LoadShape::NONE {
            Cow::Borrowed(measured)
        } else {
            Cow::Owned(measured.without(&taken))
        };
        Self {
            name,
            data,
            measured,
            options,
            taken,
            load: taken,
            stages: Vec::new(),
            notes: Vec::new(),
            exponent: Exponent::NotAsked,
            stopped: false,
            converged: true,
        }
    }

    /// The last stage's result, unless it was stopped.
    pub fn last(mut self) -> Option<StageResult> {
        self.stages.pop().filter(|_| !self.stopped)
    }

    pub fn static_stage(&mut self, watch: Watch) -> Result<AnyModel, IdentError> {
        let points = self.data.static_points();
        let model = with_elements(self.name, self.options.elements)?;
        let reach = self.reach();
        let start = |fit: &StribeckFit| {
            Ok::<_, IdentError>(scaled_to(&model, &with_dip(&fit.parameters), reach)?)
        };
        let steady = points.len() == self.data.points.len();
        let (start, fits) = if self.options.asymmetric {
            let mut side = |sign: f64| {
                let side: Vec<_> =
                    points.iter().copied().filter(|point| point.velocity * sign > 0.0).collect();
                self.curve(&side, steady)
            };
            let (forward, backward) = (side(1.0)?, side(-1.0)?);
            let both = AnyModel::asymmetric(&start(&forward)?, &start(&backward)?)?;
            (both, vec![(Side::Forward, forward), (Side::Backward, backward)])
        } else {
            let fit = self.curve(&points, steady)?;
            (start(&fit)?, vec![(Side::Both, fit)])
        };
        let measured = Measured {
            points: &points,
            beside: self.beside_points(&points),
            ..Measured::default()
        };
        let start = with_some_viscosity(&start, &measured);
        let free = FreeParameters::new(&start, |row| STATIC.contains(&row.name));
        let mut fit = self.fit(Stage::Static, &free, &measured, watch)?;
        for (side, curve) in fits {
            take_over(&mut fit.estimates, side, &curve);
        }
        if !steady {
            self.notes.push(
                "There are too few constant velocities: the static characteristic comes from sliding at changing velocity, in bins, \
                 and contains some of the lag."
                    .to_owned(),
            );
        }
        Ok(self.keep(Stage::Static, points.len(), fit))
    }

    /// What steady points alone can show beside friction.
    fn beside_points(&self, points: &[SteadyPoint]) -> LoadShape {
        let LoadShape { offset, position } = self.options.beside;
        let placed = points.iter().all(|point| point.place.is_some());
        LoadShape { offset, position: if placed { position } else { Load::None } }
    }

    /// How far the contact bends, from half the range of the pre-sliding recordings.
    pub fn reach(&self) -> Option<f64> {
        let hint = self.data.reach_hint();
        (hint > 0.0).then_some(0.5 * hint)
    }

    /// A stage that runs the model along the recordings of its kind.
    pub fn dynamic_stage(
        &mut self,
        stage: Stage,
        model: AnyModel,
        watch: Watch,
    ) -> Result<AnyModel, IdentError> {
        let stretches =
            if stage == Stage::PreSliding { &self.data.pre_sliding } else { &self.data.lag };
        if self.stopped || stretches.is_empty() {
            return Ok(model);
        }
        let model = if stage == Stage::PreSliding {
            self.best_operator(model)
        } else {
            self.best_lag(model)
        };
        let damping = self.options.inertia.is_none();
        let free = FreeParameters::new(&model, |row| match stage {
            Stage::PreSliding => {
                PRE_SLIDING.contains(&row.name) || (damping && DAMPING.contains(&row.name))
            }
            _ => LAG.contains(&row.name),
        });
        if free.ids().is_empty() {
            return Ok(model);
        }
        let stretches = stretches.clone();
        let measured = Measured { stretches: &stretches, ..Measured::default() };
        let samples = measured.len();
        let fit = self.fit(stage, &free, &measured, watch)?;
        Ok(self.keep(stage, samples, fit))
    }

    /// Everything free, over everything, each recording as heavy as the residuals of `by_stages` on
    /// it are small.
    pub fn joint(
        &mut self,
        model: AnyModel,
        by_stages: &AnyModel,
        damping: Damping,
        watch: Watch,
    ) -> Result<AnyModel, IdentError> {
        let stretches: Vec<Stretch> = [&self.data.pre_sliding, &self.data.lag, &self.data.mixed]
            .into_iter()
            .flatten()
            .map(|stretch| weighted(stretch, by_stages))
            .collect();
        if self.stopped || !self.options.joint || stretches.is_empty() {
            return Ok(model);
        }
        let points = weighted_points(&self.data.points, by_stages);
        let measured =
            Measured { points: &points, stretches: &stretches, beside: self.options.beside };
        let fit = match damping {
            Damping::Computed => self.refine(&model, false, &measured, watch)?,
            Damping::Estimated => self.refine(&model, true, &measured, watch)?,
            Damping::Either => self.refine_either(&model, &measured, watch)?,
        };
        let fit = self.with_a_dip(fit, damping, &measured, watch);
        let again = self.may_begin_again(&fit);
        let fit = match again.then(|| self.with_a_reach(by_stages)).flatten() {
            Some(start) => self.better_from(&start, fit, damping, &measured, watch),
            None => fit,
        };
        Ok(self.keep(Stage::Joint, measured.len(), fit))
    }

    pub(super) fn fit(
        &mut self,
        stage: Stage,
        free: &FreeParameters,
        measured: &Measured,
        watch: Watch,
    ) -> Result<OutputErrorFit, IdentError> {
        let mut see = |step: &Step| watch(stage, step);
        let mut fit = fit_output_error(free, measured, &[], &self.options.output_error, &mut see)?;
        let terms = measured.beside.terms();
        if !terms.is_empty() {
            self.load = self.taken.plus(fit.load);
            terms.into_iter().for_each(|term| move_by(&mut fit.estimates, term, self.taken));
        }
        self.stopped |= fit.ending == Ending::Stopped;
        // The joint stage moves everything that the others found.
        self.converged = fit.settled && (self.converged || stage == Stage::Joint);
        Ok(fit)
    }

    fn keep(&mut self, stage: Stage, samples: usize, fit: OutputErrorFit) -> AnyModel {
        let OutputErrorFit { rms, estimates, left, .. } = fit;
        self.stages.push(StageResult { stage, samples, rms, estimates, left });
        fit.model
    }

    /// How many of the model's numbers any fit was free to move. One that a bound held in the end,
    /// or whose error came out infinite, was free all the same.
    fn free_parameters(&self, estimates: &Estimates) -> usize {
        let fitted = |id| {
            let fits = self.stages.iter().filter(|stage| stage.stage != Stage::MicroDamping);
            fits.into_iter().any(|stage| stage.estimates.get(id).is_some())
        };
        estimates.parameters.iter().filter(|estimate| fitted(estimate.id)).count()
    }

    pub fn finish(self, model: AnyModel) -> Identified {
        let residuals = residuals_that_count(&Predictor { model, load: self.load }, self.measured);
        let mse = residuals.iter().map(|r| r * r).sum::<f64>() / residuals.len().max(1) as f64;
        let estimates = last_word(
            &model,
            &self.stages,
            &self.options.beside.terms(),
            self.load,
            self.exponent,
            self.options.output_error.rotary,
        );
        let free_parameters = self.free_parameters(&estimates);
        let information =
            Information::new(mse, residuals.len(), effective_share(&residuals), free_parameters);
        let Self { name, load, stages, notes, stopped, converged, .. } = self;
        Identified {
            name,
            model,
            load,
            stages,
            estimates,
            information,
            stopped,
            converged,
            free_parameters,
            notes,
        }
    }
}

/// The estimate of a term as a whole, from that of what was left of it.
fn move_by(estimates: &mut Estimates, term: AxisTerm, taken: PositionLoad) {
    let Some(estimate) = estimates.get_mut(ParameterId::new(term.name())) else { return };
    let by = taken.value(term);
    estimate.value += by;
    if let Some(interval) = &mut estimate.interval {
        (interval.low, interval.high) = (interval.low + by, interval.high + by);
    }
    // Nothing is doubtful about an offset of zero: what counts is whether its error is known.
    if estimate.standard_error.is_some_and(f64::is_finite) {
        estimate.verdict = match &estimate.verdict {
            Verdict::NotIdentifiable { doubt: Doubt::LargeError { .. }, .. } => Verdict::Identified,
            other => other.clone(),
        };
    }
}

/// A curve that shows no dip gets a small one, so that a search can find it in other recordings.
fn with_dip(values: &StribeckValues) -> StribeckValues {
    StribeckValues { f_s: values.f_s.max(1.001 * values.f_c), ..*values }
}
