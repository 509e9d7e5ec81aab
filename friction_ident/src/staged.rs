//! Staged identification: from steady points, pre-sliding, lag and mixed motion to one model with all its parameters.
//!
//! Each stage takes the parameters that its kind of recording shows and leaves the others: the static characteristic from constant velocities, the
//! stiffness from pre-sliding, the micro-damping from a damping ratio and the inertia (thesis eqs. 4.36 to 4.40, corrected), the lag from velocity
//! that varies one way. An output-error fit over everything (the joint stage) may follow; it starts where the stages end.

use std::ops::ControlFlow;

use friction_model::{AnyModel, ModelName};
use serde::Serialize;

use crate::IdentError;
use crate::bounded::{Ending, Step};
use crate::damped_model::with_computed_damping;
use crate::estimate::{Doubt, Estimate, Estimates, Interval, IntervalMethod, Verdict};
use crate::free_parameters::{FreeParameters, remedy};
use crate::frictional_lag::{LagOptions, LagRecording, fit_lag};
use crate::information::{Difference, Information, paired_difference, stratified};
use crate::micro_damping::THESIS_ZETA;
use crate::output_error::{
    Measured, OutputErrorFit, OutputErrorOptions, fit_output_error, predict, prediction_rms,
};
use crate::pre_sliding::{PreSlidingModel, PreSlidingPath, fit_pre_sliding};
use crate::residual_whiteness::effective_share;
use crate::starting_model::{breakaway_reach, scaled_to, with_elements};
use crate::static_curve::{StribeckFit, StribeckOptions, StribeckParameter, StribeckValues, fit_stribeck};
use crate::steady_point::SteadyPoint;
use crate::stretch::{Stretch, StretchKind};
use crate::uncertain::Uncertain;

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StagedOptions {
    /// Separate parameters for each direction.
    pub asymmetric: bool,
    /// Refine all parameters together over all recordings at the end.
    pub joint: bool,
    /// Elements of models that have any.
    pub elements: usize,
    /// Inertia that moves on the bristles [kg or kg m^2]; without it the micro-damping is left to the recordings.
    pub inertia: Option<Uncertain>,
    /// Damping ratio of that motion.
    pub damping_ratio: f64,
    /// How the output-error fits are done.
    pub output_error: OutputErrorOptions,
}

impl Default for StagedOptions {
    /// Symmetric, with the joint stage, four elements, no inertia, the thesis's damping ratio of .7.
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

/// Recordings of friction, sorted by what they show.
#[derive(Debug, Clone, Default)]
pub struct FrictionData {
    /// Steady points: those given, and one for each stretch at constant velocity.
    pub points: Vec<SteadyPoint>,
    /// Pre-sliding.
    pub pre_sliding: Vec<Stretch>,
    /// Velocity that varies one way.
    pub lag: Vec<Stretch>,
    /// Everything else.
    pub mixed: Vec<Stretch>,
}

impl FrictionData {
    /// Sorts. `reach` is how far the contact bends before it slides [m or rad], if that is known; otherwise a stretch that moves less than a thousandth
    /// of the longest one counts as pre-sliding.
    pub fn sort(points: Vec<SteadyPoint>, stretches: Vec<Stretch>, reach: Option<f64>) -> Self {
        let range = |stretch: &Stretch| {
            let travel = stretch.travel();
            travel.iter().copied().fold(f64::NEG_INFINITY, f64::max)
                - travel.iter().copied().fold(f64::INFINITY, f64::min)
        };
        let longest = stretches.iter().map(range).fold(0.0, f64::max);
        let reach = reach.unwrap_or(0.5e-3 * longest);
        let mut data = Self { points, ..Self::default() };
        for stretch in stretches {
            match stretch.kind(Some(reach)) {
                StretchKind::Steady => data.points.push(stretch.steady_point()),
                StretchKind::PreSliding => data.pre_sliding.push(stretch),
                StretchKind::Lag => data.lag.push(stretch),
                StretchKind::Mixed => data.mixed.push(stretch),
            }
        }
        // Either all points have a deviation of their own or none.
        if data.points.iter().any(|point| point.deviation.is_none()) {
            data.points.iter_mut().for_each(|point| point.deviation = None);
        }
        data
    }

    /// The stretches of a kind.
    pub fn stretches(&self, kind: StretchKind) -> &[Stretch] {
        match kind {
            StretchKind::Steady => &[],
            StretchKind::PreSliding => &self.pre_sliding,
            StretchKind::Lag => &self.lag,
            StretchKind::Mixed => &self.mixed,
        }
    }

    /// Whether there is nothing.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty() && self.pre_sliding.is_empty() && self.lag.is_empty() && self.mixed.is_empty()
    }

    /// Steady points for the static stage: those of constant velocities, or where they are too few, what slow enough sliding shows.
    fn static_points(&self) -> Vec<SteadyPoint> {
        if self.points.len() >= FEWEST_POINTS {
            return self.points.clone();
        }
        let mut points: Vec<SteadyPoint> =
            self.points.iter().map(|point| SteadyPoint { deviation: None, ..*point }).collect();
        points.extend(
            self.lag.iter().chain(&self.mixed).flat_map(|stretch| binned(stretch, self.reach_hint())),
        );
        points
    }

    fn reach_hint(&self) -> f64 {
        let range = |stretch: &Stretch| {
            let travel = stretch.travel();
            travel.iter().copied().fold(f64::NEG_INFINITY, f64::max)
                - travel.iter().copied().fold(f64::INFINITY, f64::min)
        };
        self.pre_sliding.iter().map(range).fold(0.0, f64::max)
    }
}

/// Points below which sliding that is not steady is used for the static characteristic too.
const FEWEST_POINTS: usize = 8;

/// Mean friction over velocity in bins, from samples that slid since the last reversal by more than `reach`.
fn binned(stretch: &Stretch, reach: f64) -> Vec<SteadyPoint> {
    const BINS: usize = 40;
    let fastest = stretch.velocity.iter().fold(0.0f64, |fastest, v| fastest.max(v.abs()));
    let mut sums = vec![(0.0, 0.0, 0usize); 2 * BINS];
    let travel = stretch.travel();
    let mut turned = travel.first().copied().unwrap_or(0.0);
    let mut before = 0.0;
    for ((&v, &friction), &at) in stretch.velocity.iter().zip(&stretch.friction).zip(&travel) {
        if v * before <= 0.0 {
            turned = at;
        }
        before = v;
        let slid = (at - turned).abs() > reach;
        if slid && v.abs() > 0.01 * fastest {
            let bin =
                ((v.abs() / fastest * BINS as f64) as usize).min(BINS - 1) + if v > 0.0 { BINS } else { 0 };
            let (velocities, frictions, count) = &mut sums[bin];
            (*velocities, *frictions, *count) = (*velocities + v, *frictions + friction, *count + 1);
        }
    }
    let mean = |&(v, f, n): &(f64, f64, usize)| SteadyPoint::new(v / n as f64, f / n as f64);
    sums.iter().filter(|(_, _, n)| *n >= 5).map(mean).collect()
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
    /// Root mean square of predicted minus measured friction on them [N or N m].
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

/// Identifies the model `name` from `data`. `watch` sees every iteration of every stage and may stop; what is there by then is returned.
///
/// # Errors
/// [`IdentError`] where there is no recording from which the static characteristic can be had, and for recordings that are not fit for use.
pub fn identify_model(
    name: ModelName,
    data: &FrictionData,
    options: &StagedOptions,
    watch: &mut dyn FnMut(Stage, &Step) -> ControlFlow<()>,
) -> Result<Identified, IdentError> {
    let mut work = Work { name, data, options, stages: Vec::new(), notes: Vec::new(), stopped: false };
    let model = work.static_stage(watch)?;
    let model = work.dynamic_stage(Stage::PreSliding, model, watch)?;
    let model = work.micro_damping(model)?;
    let model = work.dynamic_stage(Stage::Lag, model, watch)?;
    let model = work.joint(model, watch)?;
    Ok(work.finish(model))
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
        let start =
            |fit: &StribeckFit| Ok::<_, IdentError>(scaled_to(&model, &with_dip(&fit.parameters), reach)?);
        let (start, fits) = if self.options.asymmetric {
            let side = |sign: f64| {
                let side: Vec<_> =
                    points.iter().copied().filter(|point| point.velocity * sign > 0.0).collect();
                fit_stribeck(&side, &StribeckOptions::default())
            };
            let (forward, backward) = (side(1.0)?, side(-1.0)?);
            let both = AnyModel::asymmetric(&start(&forward)?, &start(&backward)?)?;
            (both, vec![(".forward", forward), (".backward", backward)])
        } else {
            let fit = fit_stribeck(&points, &StribeckOptions::default())?;
            (start(&fit)?, vec![("", fit)])
        };
        let free = FreeParameters::new(&start, |row| STATIC.contains(&row.name));
        let measured = Measured { points: &points, stretches: &[] };
        let mut fit = self.fit(Stage::Static, &free, &measured, watch)?;
        for (side, curve) in &fits {
            take_over(&mut fit.estimates, side, curve);
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
    fn dynamic_stage(&mut self, stage: Stage, model: AnyModel, watch: Watch) -> Result<AnyModel, IdentError> {
        let stretches = if stage == Stage::PreSliding { &self.data.pre_sliding } else { &self.data.lag };
        if self.stopped || stretches.is_empty() {
            return Ok(model);
        }
        let model = if stage == Stage::PreSliding { self.best_operator(model) } else { self.best_lag(model) };
        let damping = self.options.inertia.is_none();
        let free = FreeParameters::new(&model, |row| match stage {
            Stage::PreSliding => PRE_SLIDING.contains(&row.name) || (damping && DAMPING.contains(&row.name)),
            _ => LAG.contains(&row.name),
        });
        if free.handles().is_empty() {
            return Ok(model);
        }
        let measured = Measured { points: &[], stretches };
        let samples = measured.len();
        let fit = self.fit(stage, &free, &measured, watch)?;
        Ok(self.keep(stage, samples, fit))
    }

    /// The model with the lengths, stiffnesses and shares of the best hysteresis operator, found by a scan over all of them, where that is
    /// nearer to the recordings. A path that cannot be fitted so leaves the model as it is: the search that follows may still do better.
    fn best_operator(&self, model: AnyModel) -> AnyModel {
        let operator = match self.name {
            ModelName::Proposed => PreSlidingModel::Proposed,
            ModelName::LuGre => PreSlidingModel::LuGre,
            ModelName::Dahl => PreSlidingModel::Dahl { delta: model.parameter("delta").unwrap_or(1.0) },
            ModelName::ElastoPlastic => PreSlidingModel::ElastoPlastic,
            ModelName::Gms => PreSlidingModel::Gms { elements: self.options.elements },
            ModelName::Xiong => PreSlidingModel::Xiong { elements: self.options.elements },
            _ => return model,
        };
        let travels: Vec<Vec<f64>> = self
            .data
            .pre_sliding
            .iter()
            .map(|stretch| {
                let travel = stretch.travel();
                let start = travel.first().copied().unwrap_or(0.0);
                travel.into_iter().map(|x| x - start).collect()
            })
            .collect();
        let paths: Vec<PreSlidingPath> = travels
            .iter()
            .zip(&self.data.pre_sliding)
            .map(|(displacement, stretch)| PreSlidingPath { displacement, torque: &stretch.friction })
            .collect();
        let Ok(found) = fit_pre_sliding(&paths, operator) else { return model };
        let mut parameters = model.parameters();
        for estimate in &found.estimates.parameters {
            let (name, element) = match estimate.name.split_once('[') {
                Some((name, rest)) => (name, rest.trim_end_matches(']').parse().unwrap_or(usize::MAX)),
                None => (estimate.name.as_str(), 0),
            };
            if PRE_SLIDING.contains(&name) {
                parameters.set_at(name, element, estimate.value);
            }
        }
        // An element that never slipped on these paths is as soft as the fit likes: no softer than one that slips at eight times their end.
        let level = model.parameter("f_s").unwrap_or(f64::INFINITY);
        for (share, stiffness) in [("alpha", "sigma0"), ("lambda", "k")] {
            let softest = level / (8.0 * self.reach().unwrap_or(f64::INFINITY));
            let pairs = parameters.values(share).into_iter().zip(parameters.values(stiffness));
            for (element, (share, k)) in pairs.enumerate() {
                parameters.set_at(stiffness, element, k.max(share * softest));
            }
        }
        let measured = Measured { points: &[], stretches: &self.data.pre_sliding };
        let nearer = |other: &AnyModel| prediction_rms(other, &measured) < prediction_rms(&model, &measured);
        parameters.try_into().ok().filter(nearer).unwrap_or(model)
    }

    /// The model with the time constant of the lag stage's own fit, which scans all of them and needs no start, where that is nearer to the recordings.
    fn best_lag(&self, model: AnyModel) -> AnyModel {
        let recordings: Vec<LagRecording> = self
            .data
            .lag
            .iter()
            .map(|stretch| LagRecording {
                velocity: &stretch.velocity,
                torque: &stretch.friction,
                dt: stretch.time_step,
            })
            .collect();
        // A velocity that noise turns round is left to the search that follows.
        let Ok(found) = fit_lag(&recordings, &LagOptions::default()) else { return model };
        let mut parameters = model.parameters();
        parameters.set("tau", found.values.tau);
        let measured = Measured { points: &[], stretches: &self.data.lag };
        let nearer = |other: &AnyModel| prediction_rms(other, &measured) < prediction_rms(&model, &measured);
        parameters.try_into().ok().filter(nearer).unwrap_or(model)
    }

    /// `sigma = 2 zeta sqrt(J k) - f_v`, of each element its own.
    fn micro_damping(&mut self, model: AnyModel) -> Result<AnyModel, IdentError> {
        let Some(inertia) = self.options.inertia else { return Ok(model) };
        let free = FreeParameters::new(&model, |row| DAMPING.contains(&row.name));
        if free.handles().is_empty() {
            return Ok(model);
        }
        let rotary = self.options.output_error.rotary;
        let (model, estimates) = with_computed_damping(&model, inertia, self.options.damping_ratio, rotary)?;
        self.stages.push(StageResult { stage: Stage::MicroDamping, samples: 0, rms: 0.0, estimates });
        Ok(model)
    }

    /// Everything free, over everything.
    fn joint(&mut self, model: AnyModel, watch: Watch) -> Result<AnyModel, IdentError> {
        let stretches: Vec<Stretch> = [&self.data.pre_sliding, &self.data.lag, &self.data.mixed]
            .into_iter()
            .flatten()
            .map(|stretch| weighted(stretch, &model))
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
        let points = weighted_points(&self.data.points, &model);
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
        let estimated =
            estimates.parameters.iter().filter(|estimate| estimate.standard_error.is_some()).count();
        let information = Information::new(mse, residuals.len(), effective_share(&residuals), estimated);
        let Self { name, stages, notes, stopped, .. } = self;
        Identified { name, model, stages, estimates, information, stopped, notes }
    }
}

/// A curve that shows no dip gets a small one, so that a search can find it in other recordings.
fn with_dip(values: &StribeckValues) -> StribeckValues {
    StribeckValues { f_s: values.f_s.max(1.001 * values.f_c), ..*values }
}

/// The scan over all Stribeck velocities knows better than a local fit whether there is a dip, and its profile where the intervals end.
fn take_over(estimates: &mut Estimates, side: &str, curve: &StribeckFit) {
    use crate::static_curve::Unidentifiable;
    let has_dip = estimates.get(&format!("v_s{side}")).is_some();
    for (parameter, why) in StribeckParameter::ALL.into_iter().zip(curve.unidentifiable) {
        let profile = curve.estimate(parameter).interval;
        let parameter = parameter.name();
        let label = format!("{parameter}{side}");
        if let Some(estimate) = estimates.parameters.iter_mut().find(|estimate| estimate.name == label)
            && let (Some((low, high)), true) = (profile, has_dip)
        {
            estimate.interval = Some(Interval { low, high, method: IntervalMethod::Profile });
        }
        let found = estimates.parameters.iter_mut().find(|estimate| estimate.name == label);
        if let (Some(estimate), Some(why)) = (found, why) {
            let doubt = match why {
                Unidentifiable::LargeError { relative_error } => Doubt::LargeError { relative_error },
                Unidentifiable::NoDip { dip, standard_error } => {
                    Doubt::BelowNoise { effect: dip, standard_error }
                }
                Unidentifiable::OutsideSpeeds { slowest, fastest } => {
                    Doubt::OutsideRange { low: slowest, high: fastest }
                }
                Unidentifiable::AtBound { bound } => Doubt::AtBound { bound },
                Unidentifiable::OpenInterval { .. } => Doubt::OpenInterval,
            };
            estimate.verdict = Verdict::NotIdentifiable { doubt, remedy: remedy(parameter) };
        }
    }
}

/// The stretch with the deviation that the model leaves on it.
fn weighted(stretch: &Stretch, model: &AnyModel) -> Stretch {
    let squares: f64 =
        predict(model, stretch).iter().zip(&stretch.friction).map(|(p, f)| (p - f).powi(2)).sum();
    let largest = stretch.friction.iter().fold(0.0f64, |largest, f| largest.max(f.abs()));
    // Exact data leave nothing: then all count alike.
    let deviation = (squares / stretch.len() as f64).sqrt().max(1e-9 * largest);
    Stretch { deviation: Some(deviation), ..stretch.clone() }
}

/// Points with the deviation that the model leaves on them, so that they weigh rightly beside single samples.
fn weighted_points(points: &[SteadyPoint], model: &AnyModel) -> Vec<SteadyPoint> {
    let off = |point: &SteadyPoint| model.steady_state(point.velocity) - point.torque;
    let largest = points.iter().fold(0.0f64, |largest, point| largest.max(point.torque.abs()));
    let scale = points.iter().map(|point| (off(point) / point.deviation.unwrap_or(1.0)).powi(2)).sum::<f64>();
    let scale = (scale / points.len().max(1) as f64).sqrt();
    points
        .iter()
        .map(|point| {
            let deviation = (scale * point.deviation.unwrap_or(1.0)).max(1e-9 * largest);
            SteadyPoint { deviation: Some(deviation), ..*point }
        })
        .collect()
}

/// Predicted minus measured friction over all points and samples, kind by kind in the order of [`StretchKind::ALL`].
pub fn residuals(model: &AnyModel, data: &FrictionData) -> Vec<f64> {
    StretchKind::ALL.iter().flat_map(|&kind| residuals_of_kind(model, data, kind)).collect()
}

/// Predicted minus measured friction of one kind of recording.
pub fn residuals_of_kind(model: &AnyModel, data: &FrictionData, kind: StretchKind) -> Vec<f64> {
    if kind == StretchKind::Steady {
        return data.points.iter().map(|point| model.steady_state(point.velocity) - point.torque).collect();
    }
    let off = |stretch: &Stretch| -> Vec<f64> {
        predict(model, stretch).iter().zip(&stretch.friction).map(|(p, f)| p - f).collect()
    };
    data.stretches(kind).iter().flat_map(off).collect()
}

/// By how much `first` predicts worse than `second` in mean square, paired over blocks within each kind of recording.
pub fn difference(first: &AnyModel, second: &AnyModel, data: &FrictionData) -> Difference {
    let kinds: Vec<_> = StretchKind::ALL
        .iter()
        .map(|&kind| {
            let [first, second] = [first, second].map(|model| residuals_of_kind(model, data, kind));
            let samples = first.len();
            // Blocks of ten correlation times of what differs, at least five of them.
            let apart: Vec<f64> = first.iter().zip(&second).map(|(a, b)| a * a - b * b).collect();
            let mean = apart.iter().sum::<f64>() / samples.max(1) as f64;
            let centred: Vec<f64> = apart.iter().map(|d| d - mean).collect();
            let blocks = (samples as f64 * effective_share(&centred) / 10.0) as usize;
            (paired_difference(&first, &second, blocks.clamp(5, 50)), samples)
        })
        .filter(|(_, samples)| *samples > 0)
        .collect();
    stratified(&kinds)
}

/// Root mean square of predicted minus measured friction, of one kind of recording; none where there is none.
pub fn rms_of_kind(model: &AnyModel, data: &FrictionData, kind: StretchKind) -> Option<f64> {
    let measured = match kind {
        StretchKind::Steady => Measured { points: &data.points, stretches: &[] },
        _ => Measured { points: &[], stretches: data.stretches(kind) },
    };
    (!measured.is_empty()).then(|| prediction_rms(model, &measured))
}

/// Every number of the model with what the last stage that estimated it says.
fn last_word(model: &AnyModel, stages: &[StageResult], rotary: bool) -> Estimates {
    let all = FreeParameters::new(model, |_| true);
    let parameters = all
        .unknowns(rotary)
        .into_iter()
        .zip(all.values())
        .map(|(unknown, value)| {
            let found = stages.iter().rev().find_map(|stage| stage.estimates.get(&unknown.name));
            match found {
                Some(found) => Estimate { value, ..found.clone() },
                None => Estimate::given(
                    unknown.name,
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

/// How far the identified contact bends before it slides [m or rad], where the model has a stiffness.
pub fn reach(found: &Identified) -> Option<f64> {
    breakaway_reach(&found.model)
}

#[cfg(test)]
mod tests;
