//! All runs of a study.

use std::ops::Range;
use std::sync::atomic::AtomicBool;

use experiment_runner::compensation::Arm;
use friction_model::ModelName;
use serde::{Deserialize, Serialize};

use super::{BeliefErrors, Setting, StudyError, StudyOptions, Task, Trial};
use work::BadInput;
use work::part::{Found, Parts};
use work::progress::Progress;
use work::sequencer::{Completion, run_in_order};

/// One task on one plant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Study {
    /// Version of the program.
    pub program_version: String,
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
    /// How many pieces of work a progress bar should count for so many draws.
    #[must_use]
    pub fn length(&self, draws: usize) -> u64 {
        (draws * self.tasks.len() * self.plants.len()) as u64
    }

    /// Makes the study of some of the draws. Once `cancel` is set no further draw is begun; what was done is kept.
    ///
    /// # Errors
    /// The first [`StudyError`] in the order of the draws.
    pub fn make(
        &self,
        draws: Range<u32>,
        progress: &Progress,
        cancel: &AtomicBool,
    ) -> Result<Study, StudyError> {
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
        let jobs: Vec<(u32, usize)> =
            draws.flat_map(|draw| (0..places.len()).map(move |cell| (draw, cell))).collect();
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
            program_version: env!("CARGO_PKG_VERSION").to_owned(),
            arms: self.arms.clone(),
            draws: self.draws,
            errors: self.errors,
            setting: self.setting,
            cells,
            stopped: completion != Completion::All,
        })
    }

    /// Joins parts of this study: what comes of all of them is what [`Self::make`] gives of all
    /// draws. Where parts are missing it counts as stopped.
    ///
    /// # Errors
    /// [`BadInput`] for a part of another study, and for one that was stopped.
    pub fn join(&self, parts: &Parts<Study>) -> Result<Study, BadInput> {
        let mut joined: Option<Study> = None;
        for part in &parts.found {
            self.check(part)?;
            let Some(study) = &mut joined else {
                joined = Some(part.result.clone());
                continue;
            };
            for (cell, more) in study.cells.iter_mut().zip(&part.result.cells) {
                if cell.floor != more.floor {
                    return Err(part.refused("it was made by a program that computes differently"));
                }
                cell.draws.extend_from_slice(&more.draws);
            }
        }
        let study = joined.ok_or_else(|| BadInput("there is no part to join".to_owned()))?;
        Ok(Study { stopped: !parts.complete(), ..study })
    }

    /// Whether a part is one of this study, and whole.
    fn check(&self, part: &Found<Study>) -> Result<(), BadInput> {
        let study = &part.result;
        let asked = (&self.arms, self.draws, self.errors, self.setting);
        let places =
            self.tasks.iter().flat_map(|&task| self.plants.iter().map(move |&of| (task, of)));
        let same = (&study.arms, study.draws, study.errors, study.setting) == asked
            && study.cells.iter().map(|cell| (cell.task, cell.plant)).eq(places);
        if !same {
            return Err(part.refused("it is a part of a study with other options; --join needs them as they were with --part"));
        }
        let draws = part.part.range(self.draws).len();
        let whole = |cell: &Cell| {
            cell.draws.len() == draws && cell.draws.iter().all(|arms| arms.len() == self.arms.len())
        };
        if study.stopped || !study.cells.iter().all(whole) {
            let why = format!("part {} was stopped before its end; make it anew", part.part);
            return Err(part.refused(why));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
