//! Plant by observer: what a ranking of observers says once the plant is known.

use std::sync::atomic::AtomicBool;

use friction_model::{AnyModel, ModelName};
use serde::Serialize;

use crate::rig::ThesisTask;
use experiment_runner::run::RunError;
use work::progress::Progress;
use work::sequencer::run_in_order;

/// The models that the thesis compares, in its order.
pub const MODELS: [ModelName; 4] =
    [ModelName::Proposed, ModelName::LuGre, ModelName::Gms, ModelName::Xiong];

/// One plant of one task.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MatrixRow {
    /// The task.
    pub task: ThesisTask,
    /// Friction of the plant.
    pub plant: ModelName,
    /// Mean square error of the linear controller alone [(rad/s)^2 or rad^2].
    pub none: f64,
    /// Largest error of the linear controller alone [rad/s or rad].
    pub none_max: f64,
    /// Mean square error with each observer over that of none, in the order of [`MODELS`].
    pub relative: Vec<f64>,
    /// Largest error with each observer [rad/s or rad].
    pub max_error: Vec<f64>,
}

impl MatrixRow {
    /// The observer with the smallest error.
    #[must_use]
    pub fn best(&self) -> Option<ModelName> {
        let best = self.relative.iter().zip(MODELS).min_by(|a, b| a.0.total_cmp(b.0))?;
        Some(best.1)
    }

    /// Relative mean square error with the observer `model`.
    #[must_use]
    pub fn relative(&self, model: ModelName) -> Option<f64> {
        let index = MODELS.iter().position(|&name| name == model)?;
        self.relative.get(index).copied()
    }

    /// Largest error with the observer `model` [rad/s or rad].
    #[must_use]
    pub fn max_error(&self, model: ModelName) -> Option<f64> {
        let index = MODELS.iter().position(|&name| name == model)?;
        self.max_error.get(index).copied()
    }
}

/// Time that the matrix of `tasks` would take on a rig \[s\].
#[must_use]
pub fn rig_seconds(tasks: &[ThesisTask]) -> f64 {
    let each = tasks.iter().map(|task| task.protocol().duration).sum::<f64>();
    each * (MODELS.len() * (1 + MODELS.len())) as f64
}

/// Every model as plant under every model as observer, each with the parameters of the thesis's
/// test bed, in the thesis's units without noise. Rows that were not reached before `cancel` are
/// missing.
///
/// # Errors
/// [`RunError`] if a loop cannot be put together.
pub fn compute(
    tasks: &[ThesisTask],
    workers: usize,
    progress: &Progress,
    cancel: &AtomicBool,
) -> Result<Vec<MatrixRow>, RunError> {
    let rows: Vec<(ThesisTask, ModelName)> =
        tasks.iter().flat_map(|&task| MODELS.map(|plant| (task, plant))).collect();
    let mut found = Vec::with_capacity(rows.len());
    progress.stage("plant by observer");
    let work = |&(task, plant): &(ThesisTask, ModelName)| {
        let friction = AnyModel::test_bed(plant);
        let none = task.run(&friction, None)?;
        let mut row = MatrixRow {
            task,
            plant,
            none: none.mse,
            none_max: none.max_error,
            relative: Vec::with_capacity(MODELS.len()),
            max_error: Vec::with_capacity(MODELS.len()),
        };
        for observer in MODELS {
            let run = task.run(&friction, Some(&AnyModel::test_bed(observer)))?;
            row.relative.push(run.mse / none.mse);
            row.max_error.push(run.max_error);
        }
        Ok::<_, RunError>(row)
    };
    run_in_order(&rows, workers, cancel, work, |(task, _), row| {
        progress.advance(task.protocol().duration * (1 + MODELS.len()) as f64);
        found.push(row);
        Ok(())
    })?;
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In tracking the plant's own model is the best observer or within 3 % of it, and every
    /// observer more than halves the error of every plant; in regulation the best observer is the
    /// same for every plant, so that the task says nothing about models.
    #[test]
    fn the_winner_is_the_model_that_the_plant_was_made_of() {
        let rows = compute(ThesisTask::ALL, 2, &Progress::new(1.0, true), &AtomicBool::new(false))
            .unwrap();
        assert_eq!(rows.len(), 12);
        for row in &rows {
            let best = row.best().and_then(|name| row.relative(name)).unwrap();
            match row.task {
                ThesisTask::VelocityRegulation => {
                    assert_eq!(row.best(), Some(ModelName::Gms), "{row:?}")
                }
                _ => {
                    assert!(row.relative.iter().all(|relative| *relative < 0.5), "{row:?}");
                    assert!(row.relative(row.plant).unwrap() < 1.03 * best, "{row:?}");
                }
            }
        }
        // With the proposed model as plant the thesis's order comes out in both tracking tasks.
        for row in rows.iter().filter(|row| {
            row.plant == ModelName::Proposed && row.task != ThesisTask::VelocityRegulation
        }) {
            assert!(row.relative.is_sorted(), "{row:?}");
        }
        // Table 6.5: 165e-4 and 36e-4 rad/s at most, within 15 %.
        let row = &rows[0];
        assert!((row.none_max / 165e-4 - 1.0).abs() < 0.15, "{row:?}");
        assert!(
            (row.max_error(ModelName::Proposed).unwrap() / 36e-4 - 1.0).abs() < 0.15,
            "{row:?}"
        );
        // Table 6.6 by the trapezoidal rule: 0.983e-4 and 0.874e-4.
        let row = &rows[4];
        assert!((row.none / 0.983e-4 - 1.0).abs() < 0.02, "{row:?}");
        assert!((row.none * row.relative[0] / 0.874e-4 - 1.0).abs() < 0.02, "{row:?}");
        // Table 6.7: 2.9779e-4 and 567e-4 rad, 1.4854e-4 and 432e-4 rad, within 15 %.
        let row = &rows[8];
        assert!(
            (row.none / 2.9779e-4 - 1.0).abs() < 0.15 && (row.none_max / 567e-4 - 1.0).abs() < 0.15
        );
        let max_error = row.max_error(ModelName::Proposed).unwrap();
        assert!((row.none * row.relative[0] / 1.4854e-4 - 1.0).abs() < 0.15, "{row:?}");
        assert!((max_error / 432e-4 - 1.0).abs() < 0.15, "{row:?}");
    }
}
