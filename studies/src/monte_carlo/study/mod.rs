//! All runs of a study.

use std::sync::atomic::AtomicBool;

use experiment_runner::compensation::Arm;
use friction_model::ModelName;
use serde::Serialize;

use super::{BeliefErrors, Setting, StudyError, StudyOptions, Task, Trial};
use work::progress::Progress;
use work::sequencer::{Completion, run_in_order};

/// One task on one plant.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cell {
    /// The task.
    pub task: Task,
    /// Friction of the plant.
    pub plant: ModelName,
    /// The linear controller alone on a plant without friction: the floor.
    pub floor: Trial,
    /// For each draw the figures of each arm, in the order of [`Study::arms`].
    pub draws: Vec<Vec<Trial>>,
}

/// All that was run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Study {
    /// Version of the program.
    pub program_version: &'static str,
    /// What was compared; the first is the linear controller alone.
    pub arms: Vec<Arm>,
    /// Draws asked for.
    pub draws: u32,
    /// Errors of the beliefs.
    pub errors: BeliefErrors,
    /// Units and sensors.
    pub setting: Setting,
    /// One for each task and plant.
    pub cells: Vec<Cell>,
    /// Whether the work was stopped before the last draw.
    pub stopped: bool,
}

impl Study {
    /// Runs that were made.
    #[must_use]
    pub fn runs(&self) -> usize {
        self.cells.iter().map(|cell| cell.draws.len()).sum::<usize>() * self.arms.len()
    }
}

impl StudyOptions {
    /// How many pieces of work a progress bar should count.
    #[must_use]
    pub fn length(&self) -> u64 {
        u64::from(self.draws) * (self.tasks.len() * self.plants.len()) as u64
    }

    /// Makes the study. Once `cancel` is set no further draw is begun; what was done is kept.
    ///
    /// # Errors
    /// The first [`StudyError`] in the order of the draws.
    pub fn make(&self, progress: &Progress, cancel: &AtomicBool) -> Result<Study, StudyError> {
        let mut cells = Vec::with_capacity(self.tasks.len() * self.plants.len());
        for &task in &self.tasks {
            let floor = self.without_friction(task, 0)?;
            cells.extend(self.plants.iter().map(|&plant| Cell {
                task,
                plant,
                floor,
                draws: Vec::new(),
            }));
        }
        let places: Vec<(Task, ModelName)> =
            cells.iter().map(|cell| (cell.task, cell.plant)).collect();
        // All cells of a draw before the next draw: a study that is stopped has as many of each.
        let jobs: Vec<(u32, usize)> = (0..self.draws)
            .flat_map(|draw| (0..places.len()).map(move |cell| (draw, cell)))
            .collect();
        let work = |&(draw, cell): &(u32, usize)| {
            let (task, plant) = places[cell];
            self.arms
                .iter()
                .map(|&arm| self.trial(task, plant, arm, draw))
                .collect::<Result<Vec<_>, _>>()
        };
        let completion = run_in_order(&jobs, self.workers, cancel, work, |&(_, cell), trials| {
            cells[cell].draws.push(trials);
            progress.advance(1.0);
            Ok(())
        })?;
        Ok(Study {
            program_version: env!("CARGO_PKG_VERSION"),
            arms: self.arms.clone(),
            draws: self.draws,
            errors: self.errors,
            setting: self.setting,
            cells,
            stopped: completion != Completion::All,
        })
    }
}

#[cfg(test)]
mod tests;
