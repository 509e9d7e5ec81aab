//! Truth by model: identification tried on the friction of every model, over several seeds, in
//! parallel.

mod joined;
mod page;
mod terminal;

use std::ops::Range;
use std::sync::atomic::AtomicBool;

use friction_ident::information::Standing;
use friction_ident::starting_model::breakaway_reach;
use friction_ident::truth_matrix::{MODELS, Trial, try_models};
use friction_ident::{IdentError, StagedOptions};
use friction_model::{AnyModel, ModelName};
use serde::{Deserialize, Serialize};

pub use page::page;
pub use terminal::summary;

use work::progress::Progress;
use work::sequencer::{Completion, run_in_order};

/// What to try.
#[derive(Debug, Clone)]
pub struct MatrixOptions {
    /// Truths, and the models fitted to each.
    pub models: Vec<ModelName>,
    /// Standard deviation of the friction's noise [N m].
    pub noise: f64,
    /// Noise seeds, 1 to this.
    pub seeds: u32,
    /// Threads; the figures do not depend on it.
    pub workers: usize,
}

/// One truth under every seed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The model that made the data.
    pub truth: ModelName,
    /// One list of trials a seed, the best first.
    pub trials: Vec<Vec<Trial>>,
}

/// Everything that was tried.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Matrix {
    /// Version of the program.
    pub program_version: String,
    /// The models, in the order of rows and columns.
    pub models: Vec<ModelName>,
    /// Noise [N m].
    pub noise: f64,
    /// Seeds.
    pub seeds: u32,
    /// One row a truth; fewer than models where the work was stopped.
    pub rows: Vec<Row>,
    /// Whether the work was stopped.
    pub stopped: bool,
}

/// One cell of the matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// Lowest, median and highest held-out error over the seeds [N m].
    pub held_out: [f64; 3],
    /// Seeds under which the model was the best.
    pub first: usize,
    /// Seeds under which it could not be told from the best, the first places included.
    pub tied: usize,
}

impl Row {
    /// The cell of a model; none if it was not tried.
    #[must_use]
    pub fn cell(&self, model: ModelName) -> Option<Cell> {
        let of_model: Vec<(usize, &Trial)> = self
            .trials
            .iter()
            .filter_map(|trials| trials.iter().enumerate().find(|(_, trial)| trial.model == model))
            .collect();
        let mut errors: Vec<f64> = of_model.iter().map(|(_, trial)| trial.held_out).collect();
        errors.sort_by(f64::total_cmp);
        Some(Cell {
            held_out: [*errors.first()?, errors[errors.len() / 2], *errors.last()?],
            first: of_model.iter().filter(|(place, _)| *place == 0).count(),
            tied: self.trials.iter().filter(|trials| tied(trials, model)).count(),
        })
    }
}

/// Whether a model is the best of these trials or cannot be told from it.
fn tied(trials: &[Trial], model: ModelName) -> bool {
    let (Some(best), Some(own)) =
        (trials.first(), trials.iter().find(|trial| trial.model == model))
    else {
        return false;
    };
    Standing::of(own.held_out, best.held_out, own.behind.is_tie()) == Standing::Alike
}

impl MatrixOptions {
    /// Truths and seeds to try: what the work is cut into.
    #[must_use]
    pub fn pieces(&self) -> u32 {
        self.seeds.saturating_mul(u32::try_from(self.ordered().len()).unwrap_or(u32::MAX))
    }

    /// The models in the order of rows and columns.
    fn ordered(&self) -> Vec<ModelName> {
        MODELS.into_iter().filter(|name| self.models.contains(name)).collect()
    }

    /// Each truth under each seed.
    fn jobs(&self) -> impl Iterator<Item = (ModelName, u32)> + '_ {
        let of = |truth| (1..=self.seeds).map(move |seed| (truth, seed));
        self.ordered().into_iter().flat_map(of)
    }
}

/// How far the test bed's contact bends \[rad\], for truths without pre-sliding.
const REACH: f64 = 0.006;

/// Tries some of the pieces; what was done before `cancel` was set is kept.
///
/// # Errors
/// [`IdentError`] where a model cannot be identified at all.
pub fn compute(
    options: &MatrixOptions,
    pieces: Range<u32>,
    progress: &Progress,
    cancel: &AtomicBool,
) -> Result<Matrix, IdentError> {
    let models = options.ordered();
    let jobs: Vec<(ModelName, u32)> =
        options.jobs().skip(pieces.start as usize).take(pieces.len()).collect();
    let mut rows: Vec<Row> = Vec::new();
    let work = |&(truth, seed): &(ModelName, u32)| {
        progress.stage(format!("truth {}, seed {seed}", truth.title()));
        let truth = visible(truth);
        let reach = breakaway_reach(&truth).unwrap_or(REACH);
        try_models(
            &truth,
            reach,
            &models,
            options.noise,
            u64::from(seed),
            &StagedOptions::default(),
        )
    };
    let completion = run_in_order(&jobs, options.workers, cancel, work, |&(truth, _), trials| {
        joined::add(&mut rows, truth, trials);
        progress.advance(1.0);
        Ok(())
    })?;
    Ok(Matrix {
        program_version: env!("CARGO_PKG_VERSION").to_owned(),
        models,
        noise: options.noise,
        seeds: options.seeds,
        rows,
        stopped: completion != Completion::All,
    })
}

/// The test bed's model with the lag of the thesis's Table 4.8, 0.0111 s, where it has one: that of
/// Table 4.13 is shorter than the sampling period.
fn visible(name: ModelName) -> AnyModel {
    let model = AnyModel::test_bed(name);
    let mut parameters = model.parameters();
    parameters.set("tau", 0.0111);
    parameters.try_into().unwrap_or(model)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_matrix_does_not_depend_on_the_number_of_threads() {
        let options = |workers| MatrixOptions {
            models: vec![ModelName::Stribeck, ModelName::LuGre],
            noise: 1e-3,
            seeds: 2,
            workers,
        };
        let run = |workers| {
            compute(
                &options(workers),
                0..4,
                &Progress::counting(4, "fits", true),
                &AtomicBool::new(false),
            )
            .unwrap()
        };
        let matrix = run(2);
        assert_eq!(
            serde_json::to_string(&matrix).unwrap(),
            serde_json::to_string(&run(1)).unwrap()
        );
        assert_eq!(matrix.rows.len(), 2);
        let own = matrix.rows[1].cell(ModelName::LuGre).unwrap();
        assert_eq!((own.first, own.tied), (2, 2));
        let other = matrix.rows[1].cell(ModelName::Stribeck).unwrap();
        assert!(other.held_out[0] > 2.0 * own.held_out[2] && other.tied == 0, "{other:?}");
        let html = report::render_page(&page(&matrix));
        assert!(html.contains("LuGre") && summary(&matrix).contains("LuGre"));
    }

    #[test]
    fn a_matrix_that_is_stopped_keeps_what_was_done() {
        let options =
            MatrixOptions { models: vec![ModelName::Stribeck], noise: 1e-3, seeds: 2, workers: 1 };
        let matrix =
            compute(&options, 0..2, &Progress::counting(2, "fits", true), &AtomicBool::new(true))
                .unwrap();
        assert!(matrix.stopped && matrix.rows.is_empty());
    }
}
