//! Staged identification: from steady points, pre-sliding, lag and mixed motion to one model with
//! all its parameters.
//!
//! Each stage takes the parameters that its kind of recording shows and leaves the others: the
//! static characteristic from constant velocities, the stiffness from pre-sliding, the
//! micro-damping from a damping ratio and the inertia (thesis eqs. 4.36 to 4.40, corrected), the
//! lag from velocity that varies one way. An output-error fit over everything (the joint stage) may
//! follow; it starts where the stages end.

use std::ops::ControlFlow;

use friction_model::{AnyModel, ModelName};
use serde::Serialize;

use crate::IdentError;
use crate::bounded::{Ending, Step};
use crate::damped_model::with_computed_damping;
use crate::estimate::{Estimate, Estimates, Interval, IntervalMethod, Verdict};
use crate::free_parameters::{FreeParameters, remedy};
use crate::information::Information;
use crate::micro_damping::THESIS_ZETA;
use crate::output_error::{Measured, OutputErrorFit, OutputErrorOptions, fit_output_error};
use crate::parameter_id::{ParameterId, Side};
use crate::residual_whiteness::effective_share;
use crate::starting_model::{scaled_to, with_elements};
use crate::static_curve::{
    StribeckFit, StribeckOptions, StribeckParameter, StribeckValues, fit_stribeck,
};
use crate::stretch::Stretch;
use crate::uncertain::Uncertain;

mod friction_data;
mod prediction;
mod starts;

pub use friction_data::FrictionData;
use friction_data::{weighted, weighted_points};
pub use prediction::{difference, residuals, residuals_of_kind, rms_of_kind};

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StagedOptions {
    /// Separate parameters for each direction.
    pub asymmetric: bool,
    /// Refine all parameters together over all recordings at the end.
    pub joint: bool,
    /// Elements of models that have any.
    pub elements: usize,
    /// Inertia that moves on the bristles \[kg or kg m^2]; without it the micro-damping is left to
    /// the recordings.
    pub inertia: Option<Uncertain>,
    /// Damping ratio of that motion.
    pub damping_ratio: f64,
    /// How the output-error fits are done.
    pub output_error: OutputErrorOptions,
}

impl Default for StagedOptions {
    /// Symmetric, with the joint stage, four elements, no inertia, the thesis's damping ratio of
    /// 0.7.
    fn default() -> Self {
        Self {
            asymmetric: false,
            joint: true,
            elements: 4,
            inertia: None,
            damping_ratio: THESIS_ZETA,
            output_error: OutputErrorOptions::default(),
        }
    }
}

/// Which stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Static characteristic from constant velocities.
    Static,
    /// Stiffness from pre-sliding.
    PreSliding,
    /// Micro-damping computed from inertia and damping ratio.
    MicroDamping,
    /// Lag from velocity that varies one way.
    Lag,
    /// All parameters together.
    Joint,
}

impl Stage {
    /// In words.
    pub const fn describe(self) -> &'static str {
        match self {
            Self::Static => "static characteristic",
            Self::PreSliding => "pre-sliding",
            Self::MicroDamping => "computed micro-damping",
            Self::Lag => "frictional lag",
            Self::Joint => "joint refinement",
        }
    }
}

/// What a stage found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StageResult {
    /// Which.
    pub stage: Stage,
    /// Points and samples it used; zero for one that computes.
    pub samples: usize,
    /// Root mean square of predicted minus measured friction on them \[N or N m].
    pub rms: f64,
    /// The parameters it estimated.
    pub estimates: Estimates,
}

/// A model identified from recordings.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Identified {
    /// Which model.
    pub name: ModelName,
    /// With its parameters.
    pub model: AnyModel,
    /// What each stage found, in order.
    pub stages: Vec<StageResult>,
    /// Every parameter of the model: the last word on each.
    pub estimates: Estimates,
    /// Fit over all points and samples, with information criteria.
    pub information: Information,
    /// Whether it came to its end.
    pub stopped: bool,
    /// What must be known to read the numbers right.
    pub notes: Vec<String>,
}

/// Parameters of the static characteristic.
const STATIC: [&str; 4] = ["f_s", "f_c", "v_s", "f_v"];
/// Parameters of pre-sliding.
const PRE_SLIDING: [&str; 6] = ["z_b", "sigma0", "k", "alpha", "lambda", "z_ba"];
/// Parameters of the micro-damping.
const DAMPING: [&str; 2] = ["sigma", "sigma1"];
/// Parameters of the lag.
const LAG: [&str; 2] = ["tau", "c"];

/// Identifies the model `name` from `data`. `watch` sees every iteration of every stage and may
/// stop; what is there by then is returned.
///
/// # Errors
/// [`IdentError`] where there is no recording from which the static characteristic can be had, and
/// for recordings that are not fit for use.
pub fn identify_model(
    name: ModelName,
    data: &FrictionData,
    options: &StagedOptions,
    watch: &mut dyn FnMut(Stage, &Step) -> ControlFlow<()>,
) -> Result<Identified, IdentError> {
    let mut work =
        Work { name, data, options, stages: Vec::new(), notes: Vec::new(), stopped: false };
    let model = work.static_stage(watch)?;
    let model = work.dynamic_stage(Stage::PreSliding, model, watch)?;
    let model = work.micro_damping(model)?;
    let model = work.dynamic_stage(Stage::Lag, model, watch)?;
    let model = work.joint(model, &model, watch)?;
    Ok(work.finish(model))
}

/// The joint refinement alone, begun at `model`: how its parameters answer when the recordings
/// change a little. `by_stages` is what the stages find in `data`; its residuals weigh the
/// recordings, as in [`identify_model`]. None where `data` holds no motion.
///
/// # Errors
/// [`IdentError`] for recordings that are not fit for use.
pub fn refine_jointly(
    model: &AnyModel,
    by_stages: &AnyModel,
    data: &FrictionData,
    options: &StagedOptions,
    watch: &mut dyn FnMut(Stage, &Step) -> ControlFlow<()>,
) -> Result<Option<StageResult>, IdentError> {
    let options = StagedOptions { joint: true, ..*options };
    let name = model.name();
    let mut work = Work {
        name,
        data,
        options: &options,
        stages: Vec::new(),
        notes: Vec::new(),
        stopped: false,
    };
    let model = work.micro_damping(*model)?;
    work.joint(model, by_stages, watch)?;
    Ok(work.stages.pop().filter(|last| last.stage == Stage::Joint && !work.stopped))
}

/// What the stages share.
struct Work<'a> {
    name: ModelName,
    data: &'a FrictionData,
    options: &'a StagedOptions,
    stages: Vec<StageResult>,
    notes: Vec<String>,
    stopped: bool,
}

type Watch<'w> = &'w mut dyn FnMut(Stage, &Step) -> ControlFlow<()>;

impl Work<'_> {
    fn static_stage(&mut self, watch: Watch) -> Result<AnyModel, IdentError> {
        let points = self.data.static_points();
        let model = with_elements(self.name, self.options.elements)?;
        let reach = self.reach();
        let start = |fit: &StribeckFit| {
            Ok::<_, IdentError>(scaled_to(&model, &with_dip(&fit.parameters), reach)?)
        };
        let (start, fits) = if self.options.asymmetric {
            let side = |sign: f64| {
                let side: Vec<_> =
                    points.iter().copied().filter(|point| point.velocity * sign > 0.0).collect();
                fit_stribeck(&side, &StribeckOptions::default())
            };
            let (forward, backward) = (side(1.0)?, side(-1.0)?);
            let both = AnyModel::asymmetric(&start(&forward)?, &start(&backward)?)?;
            (both, vec![(Side::Forward, forward), (Side::Backward, backward)])
        } else {
            let fit = fit_stribeck(&points, &StribeckOptions::default())?;
            (start(&fit)?, vec![(Side::Both, fit)])
        };
        let free = FreeParameters::new(&start, |row| STATIC.contains(&row.name));
        let measured = Measured { points: &points, stretches: &[] };
        let mut fit = self.fit(Stage::Static, &free, &measured, watch)?;
        for (side, curve) in fits {
            take_over(&mut fit.estimates, side, &curve);
        }
        if points.len() != self.data.points.len() {
            self.notes.push(
                "There are too few constant velocities: the static characteristic comes from sliding at changing velocity, in bins, \
                 and contains some of the lag."
                    .to_owned(),
            );
        }
        Ok(self.keep(Stage::Static, points.len(), fit))
    }

    /// How far the contact bends, from half the range of the pre-sliding recordings.
    fn reach(&self) -> Option<f64> {
        let hint = self.data.reach_hint();
        (hint > 0.0).then_some(0.5 * hint)
    }

    /// A stage that runs the model along the recordings of its kind.
    fn dynamic_stage(
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
        let measured = Measured { points: &[], stretches };
        let samples = measured.len();
        let fit = self.fit(stage, &free, &measured, watch)?;
        Ok(self.keep(stage, samples, fit))
    }

    /// `sigma = 2 zeta sqrt(J k) - f_v`, of each element its own.
    fn micro_damping(&mut self, model: AnyModel) -> Result<AnyModel, IdentError> {
        let Some(inertia) = self.options.inertia else { return Ok(model) };
        let free = FreeParameters::new(&model, |row| DAMPING.contains(&row.name));
        if free.ids().is_empty() {
            return Ok(model);
        }
        let rotary = self.options.output_error.rotary;
        let (model, estimates) =
            with_computed_damping(&model, inertia, self.options.damping_ratio, rotary)?;
        self.stages.push(StageResult {
            stage: Stage::MicroDamping,
            samples: 0,
            rms: 0.0,
            estimates,
        });
        Ok(model)
    }

    /// Everything free, over everything, each recording as heavy as the residuals of `by_stages` on
    /// it are small.
    fn joint(
        &mut self,
        model: AnyModel,
        by_stages: &AnyModel,
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
        let computed = self.stages.iter().any(|stage| stage.stage == Stage::MicroDamping);
        let shown = |name: &str| {
            STATIC.contains(&name)
                || PRE_SLIDING.contains(&name)
                || LAG.contains(&name)
                || (DAMPING.contains(&name) && !computed)
        };
        let free = FreeParameters::new(&model, |row| shown(row.name));
        let points = weighted_points(&self.data.points, by_stages);
        let measured = Measured { points: &points, stretches: &stretches };
        let fit = self.fit(Stage::Joint, &free, &measured, watch)?;
        Ok(self.keep(Stage::Joint, measured.len(), fit))
    }

    fn fit(
        &mut self,
        stage: Stage,
        free: &FreeParameters,
        measured: &Measured,
        watch: Watch,
    ) -> Result<OutputErrorFit, IdentError> {
        let mut see = |step: &Step| watch(stage, step);
        let fit = fit_output_error(free, measured, &[], &self.options.output_error, &mut see)?;
        self.stopped |= fit.ending == Ending::Stopped;
        Ok(fit)
    }

    fn keep(&mut self, stage: Stage, samples: usize, fit: OutputErrorFit) -> AnyModel {
        self.stages.push(StageResult { stage, samples, rms: fit.rms, estimates: fit.estimates });
        fit.model
    }

    fn finish(self, model: AnyModel) -> Identified {
        let residuals = residuals(&model, self.data);
        let mse = residuals.iter().map(|r| r * r).sum::<f64>() / residuals.len().max(1) as f64;
        let estimates = last_word(&model, &self.stages, self.options.output_error.rotary);
        let estimated = estimates
            .parameters
            .iter()
            .filter(|estimate| estimate.standard_error.is_some())
            .count();
        let information =
            Information::new(mse, residuals.len(), effective_share(&residuals), estimated);
        let Self { name, stages, notes, stopped, .. } = self;
        Identified { name, model, stages, estimates, information, stopped, notes }
    }
}

/// A curve that shows no dip gets a small one, so that a search can find it in other recordings.
fn with_dip(values: &StribeckValues) -> StribeckValues {
    StribeckValues { f_s: values.f_s.max(1.001 * values.f_c), ..*values }
}

/// The scan over all Stribeck velocities knows better than a local fit whether there is a dip, and
/// its profile where the intervals end.
fn take_over(estimates: &mut Estimates, side: Side, curve: &StribeckFit) {
    let has_dip = estimates.get(ParameterId::new("v_s").side(side)).is_some();
    for (parameter, why) in StribeckParameter::ALL.into_iter().zip(curve.unidentifiable) {
        let profile = curve.estimate(parameter).interval;
        let id = ParameterId::new(parameter.name()).side(side);
        let Some(estimate) = estimates.get_mut(id) else { continue };
        if let (Some((low, high)), true) = (profile, has_dip) {
            estimate.interval = Some(Interval { low, high, method: IntervalMethod::Profile });
        }
        if let Some(why) = why {
            let remedy = remedy(id.name);
            estimate.verdict = Verdict::NotIdentifiable { doubt: why.into(), remedy };
        }
    }
}

/// Every number of the model with what the last stage that estimated it says.
fn last_word(model: &AnyModel, stages: &[StageResult], rotary: bool) -> Estimates {
    let all = FreeParameters::new(model, |_| true);
    let parameters = all
        .unknowns(rotary)
        .into_iter()
        .zip(all.values())
        .map(|(unknown, value)| {
            let found = stages.iter().rev().find_map(|stage| stage.estimates.get(unknown.id));
            match found {
                Some(found) => Estimate { value, ..found.clone() },
                None => Estimate::given(
                    unknown.id,
                    unknown.unit,
                    value,
                    "no recording shows it: the value it started with",
                ),
            }
        })
        .collect();
    // Correlations are those of the last fit, where it covers everything it estimated.
    let last = stages.last().map(|stage| stage.estimates.clone()).unwrap_or_default();
    Estimates { parameters, ..last }
}

#[cfg(test)]
mod tests;
