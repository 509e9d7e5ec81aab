//! `report.html` as data.

use friction_ident::stretch::StretchKind;
use friction_model::ModelName;

use super::{Matrix, Row};
use report::figure::{Block, Figure, Mark, Page, Panel, Table, Trace};
use report::numbers;

/// The page.
#[must_use]
pub fn page(matrix: &Matrix) -> Page {
    let mut blocks = vec![
        Block::Heading("Held-out error".to_owned()),
        Block::Text(
            "Each row is a truth: its experiments (80 constant velocities each way, a nested pre-sliding path, a chirp one way, reversals) were simulated, every model was \
             identified from them, and each was tried on other motions that no fit had seen."
                .to_owned(),
        ),
    ];
    if matrix.stopped {
        blocks.push(Block::Note(
            "Stopped before the end: rows are missing or rest on fewer seeds.".to_owned(),
        ));
    }
    blocks.push(Block::Table(held_out(matrix)));
    blocks.push(Block::Figure(picture(matrix)));
    blocks.push(Block::Heading("By kind of recording".to_owned()));
    blocks.extend(matrix.rows.iter().map(|row| Block::Table(by_kind(matrix, row))));
    Page {
        title: "Truth by model".to_owned(),
        subtitle: format!(
            "noise {} N m, {}; frictionlab {}",
            matrix.noise,
            numbers::count(matrix.seeds as usize, "seed"),
            matrix.program_version
        ),
        blocks,
    }
}

fn held_out(matrix: &Matrix) -> Table {
    let mut columns = vec!["truth".to_owned()];
    columns.extend(matrix.models.iter().map(|name| name.title().to_owned()));
    let rows = matrix
        .rows
        .iter()
        .map(|row| {
            let mut cells = vec![row.truth.title().to_owned()];
            cells.extend(matrix.models.iter().map(|&model| text(row, model)));
            cells
        })
        .collect();
    Table {
        title: "Held-out error, rms [1e-3 N m]".to_owned(),
        caption: "Median over the seeds, lowest and highest in brackets. A star marks the model that was best under most seeds, a tilde one that could not be told from the \
                  best under at least half of them (an error at most a fifth larger, and a difference within two standard errors, paired over blocks)."
            .to_owned(),
        columns,
        rows,
        highlight: None,
    }
}

/// A cell as text.
pub(super) fn text(row: &Row, model: ModelName) -> String {
    let Some(cell) = row.cell(model) else { return "–".to_owned() };
    let [low, median, high] = cell.held_out.map(|error| 1e3 * error);
    let seeds = row.trials.len();
    let mark = match (2 * cell.first > seeds, 2 * cell.tied >= seeds) {
        (true, _) => " *",
        (false, true) => " ~",
        _ => "",
    };
    if seeds > 1 {
        format!("{median:.3} ({low:.3} to {high:.3}){mark}")
    } else {
        format!("{median:.3}{mark}")
    }
}

fn picture(matrix: &Matrix) -> Figure {
    let traces = matrix
        .models
        .iter()
        .map(|&model| {
            let cells: Vec<_> = matrix.rows.iter().map(|row| row.cell(model)).collect();
            Trace::Categories {
                name: model.title().to_owned(),
                x: matrix.rows.iter().map(|row| row.truth.title().to_owned()).collect(),
                y: cells
                    .iter()
                    .map(|cell| cell.map_or(f64::NAN, |cell| (1e3 * cell.held_out[1]).log10()))
                    .collect(),
                mark: Mark::Marker,
            }
        })
        .collect();
    Figure {
        title: "Which model fits the friction of which".to_owned(),
        caption: "The lowest point above each truth should be the truth itself.".to_owned(),
        x_label: "truth".to_owned(),
        log_x: false,
        panels: vec![Panel { y_label: "log10 of the held-out rms [1e-3 N m]".to_owned(), traces }],
    }
}

fn by_kind(matrix: &Matrix, row: &Row) -> Table {
    let mut columns = vec!["model".to_owned()];
    columns.extend(StretchKind::ALL.map(|kind| kind.describe().to_owned()));
    columns.extend(["AIC beyond the least", "BIC beyond the least"].map(str::to_owned));
    let first = row.trials.first().map(Vec::as_slice).unwrap_or_default();
    let least = |of: fn(&friction_ident::truth_matrix::Trial) -> f64| {
        first.iter().map(of).fold(f64::INFINITY, f64::min)
    };
    let (aic, bic) = (least(|trial| trial.aic), least(|trial| trial.bic));
    let rows = first
        .iter()
        .filter(|trial| matrix.models.contains(&trial.model))
        .map(|trial| {
            let mut cells = vec![trial.model.title().to_owned()];
            cells.extend(
                trial
                    .by_kind
                    .iter()
                    .map(|rms| rms.map_or("–".to_owned(), |rms| format!("{:.3}", 1e3 * rms))),
            );
            cells.extend([format!("{:.0}", trial.aic - aic), format!("{:.0}", trial.bic - bic)]);
            cells
        })
        .collect();
    Table {
        title: format!("Truth {}: held-out rms of each kind [1e-3 N m], first seed", row.truth.title()),
        caption: "Best model first. AIC and BIC are of the data that was fitted, over samples that count as independent.".to_owned(),
        columns,
        rows,
        highlight: (!first.is_empty()).then_some(0),
    }
}
