//! The thesis's tables of compensation, 5.1, 5.2 and 6.2 to 6.7: its printed figures beside ours.
//!
//! * [`printed`]: what it prints.
//! * [`rig_rows`]: the simulated rig in physical units, beside what was measured on the real one.
//! * [`notes`]: what can be reproduced, what cannot, and why.
//! * [`page`]: tables and pictures for the report, and the text for the terminal.

mod notes;
pub mod page;
pub mod printed;
mod rig_rows;

use std::sync::atomic::AtomicBool;

use friction_model::ModelName;
use serde::Serialize;

use crate::example_5_4::{Example, ExampleModel, ExampleOptions, PositionCase, VelocityCase};
use crate::matrix::{self, MatrixRow};
use crate::rig::ThesisTask;
use experiment_runner::run::{Appended, RunError};
use printed::{PRINTED, PrintedTable, Scheme};
use work::progress::Progress;

/// Noise seeds of the example's velocity task.
const SEEDS: u32 = 8;

/// One figure of ours, in SI units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Cell {
    /// Mean square error [(rad/s)^2 or rad^2].
    pub mse: f64,
    /// Largest error [rad/s or rad].
    pub max_error: f64,
}

/// Our figures beside the printed ones, by one way of computing them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Column {
    /// How they were computed, in a few words.
    pub title: String,
    /// One for each printed row; `None` where there is none.
    pub cells: Vec<Option<Cell>>,
}

/// A printed table with our columns.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FilledTable {
    /// What the thesis prints.
    pub printed: PrintedTable,
    /// Ours.
    pub columns: Vec<Column>,
}

/// Everything that the tables rest on.
#[derive(Debug, Clone, Serialize)]
pub struct ThesisTables {
    /// The tables, in the thesis's order.
    pub tables: Vec<FilledTable>,
    /// Plant by observer, of the simulations of section 6.5.
    pub matrix: Vec<MatrixRow>,
    /// The example of section 5.4.
    pub example: Example,
    /// Whether everything was computed; otherwise cells are missing.
    pub complete: bool,
}

/// Time that the simulations would take on a rig \[s\].
#[must_use]
pub fn rig_seconds() -> f64 {
    matrix::rig_seconds(ThesisTask::ALL) + rig_rows::rig_seconds() + example(1).rig_seconds()
}

const fn example(workers: usize) -> ExampleOptions {
    ExampleOptions { seeds: SEEDS, workers }
}

/// Computes all of our columns; `seed` is that of the sensors' noise beside the measured tables.
///
/// # Errors
/// [`RunError`] if a loop cannot be put together.
pub fn compute(
    seed: u64,
    workers: usize,
    progress: &Progress,
    cancel: &AtomicBool,
) -> Result<ThesisTables, RunError> {
    let example = Example::compute(&example(workers), progress, cancel)?;
    let matrix = matrix::compute(ThesisTask::ALL, workers, progress, cancel)?;
    let measured = rig_rows::compute(seed, workers, progress, cancel)?;
    let tables: Vec<FilledTable> = PRINTED
        .iter()
        .map(|printed| {
            let columns = match printed.number {
                "5.1" => velocity_columns(&example, printed),
                "5.2" => position_columns(&example, printed),
                "6.5" => vec![simulated(&matrix, ThesisTask::VelocityTracking, printed)],
                "6.6" => vec![simulated(&matrix, ThesisTask::VelocityRegulation, printed)],
                "6.7" => vec![simulated(&matrix, ThesisTask::PositionTracking, printed)],
                number => {
                    vec![column(printed, "simulated rig, physical units, with noise", |scheme| {
                        measured.cell(number, scheme)
                    })]
                }
            };
            FilledTable { printed: *printed, columns }
        })
        .collect();
    let whole = |table: &FilledTable| {
        table.columns.iter().all(|column| column.cells.iter().any(Option::is_some))
    };
    let complete =
        tables.iter().all(whole) && matrix.len() == ThesisTask::ALL.len() * matrix::MODELS.len();
    Ok(ThesisTables { tables, matrix, example, complete })
}

/// The same as the appendix of a run.
///
/// # Errors
/// As for [`compute`].
pub fn appended(
    seed: u64,
    workers: usize,
    progress: &Progress,
    cancel: &AtomicBool,
) -> Result<Appended, RunError> {
    let found = compute(seed, workers, progress, cancel)?;
    let record = serde_json::to_value(&found)
        .map_err(|error| RunError::Describe { what: "JSON", detail: error.to_string() })?;
    Ok(Appended {
        record,
        blocks: page::blocks(&found),
        text: page::text(&found),
        complete: found.complete,
    })
}

fn column(printed: &PrintedTable, title: &str, cell: impl Fn(Scheme) -> Option<Cell>) -> Column {
    Column {
        title: title.to_owned(),
        cells: printed.rows.iter().map(|row| cell(row.scheme)).collect(),
    }
}

/// The example's parameters of a model that the thesis compares.
fn example_model(name: ModelName) -> Option<ExampleModel> {
    ExampleModel::PRINTED.into_iter().find(|model| model.name() == name)
}

fn velocity_columns(example: &Example, printed: &PrintedTable) -> Vec<Column> {
    let cell = |case: VelocityCase| {
        let runs = example.velocity(&case)?;
        let mean = |of: fn(&super::example_5_4::ExampleRun) -> f64| {
            runs.iter().map(of).sum::<f64>() / runs.len() as f64
        };
        Some(Cell { mse: mean(|run| run.mse), max_error: mean(|run| run.max_error) })
    };
    let of = |own: bool| {
        move |scheme: Scheme| match scheme {
            Scheme::NoFriction => cell(VelocityCase::NO_FRICTION),
            Scheme::Linear => cell(VelocityCase::on_proposed(None)),
            Scheme::Observer(name) => {
                let model = example_model(name)?;
                cell(if own {
                    VelocityCase::on_its_own(model)
                } else {
                    VelocityCase::on_proposed(Some(model))
                })
            }
        }
    };
    vec![
        column(printed, "plant: proposed, k = 0", of(false)),
        column(printed, "plant: the observer's own model, k = 0.035", of(true)),
    ]
}

fn position_columns(example: &Example, printed: &PrintedTable) -> Vec<Column> {
    let of = |own: bool, duration: f64| {
        move |scheme: Scheme| {
            let case = match scheme {
                Scheme::NoFriction => PositionCase::no_friction(duration),
                Scheme::Linear => PositionCase::on_proposed(None, duration),
                Scheme::Observer(name) if own => {
                    PositionCase::on_its_own(example_model(name)?, duration)
                }
                Scheme::Observer(name) => PositionCase::on_proposed(example_model(name), duration),
            };
            let (run, _) = example.position(&case)?;
            Some(Cell { mse: run.mse, max_error: run.max_error })
        }
    };
    vec![
        column(printed, "plant: proposed, k = 0, 20 s", of(false, 20.0)),
        column(printed, "plant: the observer's own model, k = 0.002, 50 s", of(true, 50.0)),
    ]
}

fn simulated(matrix: &[MatrixRow], task: ThesisTask, printed: &PrintedTable) -> Column {
    let row = matrix.iter().find(|row| row.task == task && row.plant == ModelName::Proposed);
    column(printed, "simulated in the thesis's units", |scheme| {
        let row = row?;
        match scheme {
            Scheme::NoFriction => None,
            Scheme::Linear => Some(Cell { mse: row.none, max_error: row.none_max }),
            Scheme::Observer(name) => {
                Some(Cell { mse: row.none * row.relative(name)?, max_error: row.max_error(name)? })
            }
        }
    })
}
