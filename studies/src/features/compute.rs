//! The features of several models, in parallel.

use std::sync::atomic::AtomicBool;

use friction_features::describing_function::HarmonicError;
use friction_features::limit_cycle::{self, LimitCycleStudy};
use friction_features::{FeatureSettings, Features, features};
use friction_model::{AnyModel, ModelName};
use serde::Serialize;

use super::describing::{Describing, describe};
use work::progress::Progress;
use work::sequencer::run_in_order;

/// What to compute.
#[derive(Debug, Clone)]
pub struct FeaturesOptions {
    /// The models.
    pub models: Vec<ModelName>,
    /// Threads; the figures do not depend on it.
    pub workers: usize,
}

/// One model.
#[derive(Debug, Clone, Serialize)]
pub struct ModelFeatures {
    /// Its features.
    pub features: Features,
    /// Its describing function.
    pub describing: Describing,
}

/// Everything that was computed.
#[derive(Debug, Clone, Serialize)]
pub struct FeaturesResults {
    /// One entry a model, in the order of the catalogue.
    pub models: Vec<ModelFeatures>,
    /// The thesis's example of a position loop that hunts.
    pub limit_cycle: LimitCycleStudy,
}

/// One piece of work: a model, or the limit cycle.
enum Job {
    Model(ModelName),
    LimitCycle,
}

enum Done {
    Model(Box<ModelFeatures>),
    LimitCycle(Box<LimitCycleStudy>),
}

/// Computes the features; `None` if cancelled. Each model counts as one on the progress bar.
///
/// # Errors
/// [`HarmonicError`] for an impossible loop, which the built-in example is not.
pub fn compute(
    options: &FeaturesOptions,
    progress: &Progress,
    cancel: &AtomicBool,
) -> Result<Option<FeaturesResults>, HarmonicError> {
    let mut jobs = vec![Job::LimitCycle];
    jobs.extend(options.models.iter().map(|&name| Job::Model(name)));
    let mut models = Vec::new();
    let mut limit_cycle = None;
    let work = |job: &Job| -> Result<Done, HarmonicError> {
        Ok(match *job {
            Job::LimitCycle => Done::LimitCycle(Box::new(limit_cycle_of_the_thesis()?)),
            Job::Model(name) => {
                progress.stage(name.title());
                Done::Model(Box::new(of_model(name)))
            }
        })
    };
    run_in_order(&jobs, options.workers, cancel, work, |_, done| {
        match done {
            Done::Model(model) => models.push(*model),
            Done::LimitCycle(study) => limit_cycle = Some(*study),
        }
        progress.advance(1.0);
        Ok(())
    })?;
    let complete = models.len() == options.models.len();
    Ok(limit_cycle.filter(|_| complete).map(|limit_cycle| FeaturesResults { models, limit_cycle }))
}

/// The example of the thesis's section 3.4.2.
fn limit_cycle_of_the_thesis() -> Result<LimitCycleStudy, HarmonicError> {
    use limit_cycle::{Grid, PidLoop, Schedule, Span, study, thesis_contact};
    let grid = Grid {
        amplitude: Span { from: 1e-5, to: 10.0, points: 400 },
        angular_frequency: Span { from: 0.01, to: 100.0, points: 400 },
    };
    study(&thesis_contact(), &PidLoop::thesis(), &grid, &Schedule::default())
}

fn of_model(name: ModelName) -> ModelFeatures {
    let (chapter_3, test_bed) = (AnyModel::chapter_3(name), AnyModel::test_bed(name));
    ModelFeatures {
        features: features(&chapter_3, &test_bed, &FeatureSettings::default()),
        describing: describe(&chapter_3),
    }
}
