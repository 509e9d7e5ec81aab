//! Staged identification: from steady points, pre-sliding, lag and mixed motion to one model with
//! all its parameters.
//!
//! Each stage takes the parameters that its kind of recording shows and leaves the others: the
//! static characteristic from constant velocities, the stiffness from pre-sliding, the
//! micro-damping from a damping ratio and the inertia (thesis eqs. 4.36 to 4.40, corrected), the
//! lag from velocity that varies one way. An output-error fit over everything (the joint stage) may
//! follow; it starts where the stages end, and estimates the micro-damping too where the recordings
//! contradict the computed one.

mod damping;
mod decided;
mod dips;
mod exponent;
mod friction_data;
mod last_word;
mod load_choice;
mod load_rows;
mod options;
mod prediction;
mod stage;
mod starts;
mod viscosity;
mod work;

use std::ops::ControlFlow;

use friction_model::{AnyModel, ModelName};
use serde::Serialize;

use crate::IdentError;
use crate::bounded::Step;
use crate::estimate::Estimates;
use crate::information::Information;
use crate::output_error::Predictor;
use crate::position_load::PositionLoad;
use decided::Damping;
use work::Work;

pub use friction_data::FrictionData;
pub use load_choice::{PositionLoadChoice, choose_position_load};
pub use options::StagedOptions;
pub use prediction::{all_predict, difference, residuals, residuals_of_kind, rms_of_kind};
pub use stage::{Stage, StageResult};

/// A model identified from recordings.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Identified {
    /// Which model.
    pub name: ModelName,
    /// With its parameters.
    pub model: AnyModel,
    /// What acts beside friction; nothing unless it was asked for.
    pub load: PositionLoad,
    /// What each stage found, in order.
    pub stages: Vec<StageResult>,
    /// Every parameter of the model: the last word on each.
    pub estimates: Estimates,
    /// Fit over all points and samples, with information criteria.
    pub information: Information,
    /// Whether it was stopped before its end.
    pub stopped: bool,
    /// Whether the fits that have the last word arrived where nothing is to be gained any more.
    pub converged: bool,
    /// Parameters that were free in the fits, whether or not the data determined them.
    pub free_parameters: usize,
    /// What must be known to read the numbers right.
    pub notes: Vec<String>,
}

impl Identified {
    /// What it predicts of the measured force: friction and what acts beside it.
    #[must_use]
    pub fn predictor(&self) -> Predictor {
        Predictor { model: self.model, load: self.load }
    }
}

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
    let mut work = Work::new(name, data, options);
    let model = work.static_stage(watch)?;
    let model = work.with_a_level(model);
    let model = work.dynamic_stage(Stage::PreSliding, model, watch)?;
    let model = work.micro_damping(model)?;
    let model = work.dynamic_stage(Stage::Lag, model, watch)?;
    let damping = work.damping();
    let model = work.joint(model, &model, damping, watch)?;
    Ok(work.finish(model))
}

/// The joint refinement alone, begun at what was `found`: how its parameters answer when the
/// recordings change a little. `by_stages` is what the stages find in `data`; its residuals weigh
/// the recordings, as in [`identify_model`]. What was computed then is computed now, what was
/// estimated is estimated. None where `data` holds no motion.
///
/// # Errors
/// [`IdentError`] for recordings that are not fit for use.
pub fn refine_jointly(
    found: &Identified,
    by_stages: &AnyModel,
    data: &FrictionData,
    options: &StagedOptions,
    watch: &mut dyn FnMut(Stage, &Step) -> ControlFlow<()>,
) -> Result<Option<StageResult>, IdentError> {
    let options = StagedOptions { joint: true, ..*options };
    let mut work = Work::new(found.name, data, &options);
    let computed = found.stages.iter().any(|stage| stage.stage == Stage::MicroDamping);
    let (model, damping) = if computed {
        (work.micro_damping(found.model)?, Damping::Computed)
    } else {
        (found.model, Damping::Estimated)
    };
    work.joint(model, by_stages, damping, watch)?;
    Ok(work.last().filter(|last| last.stage == Stage::Joint))
}

#[cfg(test)]
mod damping_tests;
#[cfg(test)]
mod load_tests;
#[cfg(test)]
mod tests;
