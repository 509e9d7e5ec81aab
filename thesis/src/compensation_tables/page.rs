//! The tables for the report and for the terminal.

use friction_ident::statistics::Sample;

use super::printed::{ImprovementOf, PrintedRow, Scheme};
use super::{Cell, FilledTable, ThesisTables, notes};
use crate::matrix::{MODELS, MatrixRow};
use crate::rig::ThesisTask;
use report::figure::{Block, Figure, Mark, Panel, Table, Trace};

/// The section of a report.
#[must_use]
pub fn blocks(found: &ThesisTables) -> Vec<Block> {
    let mut blocks = vec![Block::Heading("The thesis's tables".to_owned())];
    if !found.complete {
        let why = "Stopped before the end: figures of ours that are missing were not computed.";
        blocks.push(Block::Note(why.to_owned()));
    }
    blocks.extend(found.tables.iter().map(|table| Block::Table(filled(table))));
    blocks.push(Block::Table(explained(found)));
    blocks.push(Block::Heading("Plant by observer".to_owned()));
    blocks.extend(ThesisTask::ALL.iter().map(|&task| Block::Table(matrix(&found.matrix, task))));
    blocks.push(Block::Figure(matrix_figure(&found.matrix)));
    blocks
}

/// Every table and the matrix as text.
#[must_use]
pub fn text(found: &ThesisTables) -> String {
    let mut text = String::new();
    let tables = found.tables.iter().map(|table| (filled(table), true));
    let matrices = ThesisTask::ALL.iter().map(|&task| (matrix(&found.matrix, task), false));
    for (table, noted) in tables.chain(matrices) {
        text += &format!("\n{}\n", table.title);
        let width = |column: usize| {
            let cells = table
                .rows
                .iter()
                .filter_map(|row| row.get(column))
                .chain(table.columns.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        for row in std::iter::once(&table.columns).chain(&table.rows) {
            for (index, cell) in row.iter().enumerate() {
                let pad = " ".repeat(width(index).saturating_sub(cell.chars().count()));
                text +=
                    &if index == 0 { format!("  {cell}{pad}") } else { format!("  {pad}{cell}") };
            }
            text.push('\n');
        }
        if noted {
            text += &format!("  {}\n", table.caption);
        }
    }
    text
}

/// Significant digits of our figures.
fn number(value: f64) -> String {
    match value.abs() {
        magnitude if magnitude >= 1000.0 => format!("{value:.0}"),
        magnitude if magnitude >= 100.0 => format!("{value:.1}"),
        magnitude if magnitude >= 10.0 => format!("{value:.2}"),
        _ => format!("{value:.4}"),
    }
}

fn filled(table: &FilledTable) -> Table {
    let printed = &table.printed;
    let with_max = printed.rows.iter().any(|row| row.max_error.is_some());
    let with_improvement = printed.improvement_of != ImprovementOf::Nothing;
    let power =
        |exponent: i32| if exponent == 0 { String::new() } else { format!(" (×1e{exponent})") };
    let mut columns = vec!["scheme".to_owned()];
    let several = table.columns.len() > 1;
    let mut heads = |head: String| {
        columns.push(format!("{head}, printed"));
        columns.extend(table.columns.iter().map(|column| {
            if several { format!("ours, {}", column.title) } else { format!("{head}, ours") }
        }));
    };
    heads(format!("mse{}", power(printed.mse_exponent)));
    if with_max {
        heads(format!("max. error{}", power(printed.max_exponent)));
    }
    if with_improvement {
        heads("improvement [%]".to_owned());
    }
    let (mse_unit, max_unit) = (10f64.powi(printed.mse_exponent), 10f64.powi(printed.max_exponent));
    let linear = printed.rows.iter().position(|row| row.scheme == Scheme::Linear);
    let rows = printed.rows.iter().enumerate().map(|(index, row)| {
        let ours = |of: &dyn Fn(&Cell) -> f64| -> Vec<String> {
            let cell = |cells: &[Option<Cell>]| cells.get(index).copied().flatten();
            let one = |cells| cell(cells).map_or("-".to_owned(), |cell| number(of(&cell)));
            table.columns.iter().map(|column| one(&column.cells)).collect()
        };
        let mut cells = vec![row.label.to_owned(), row.mse.to_string()];
        cells.extend(ours(&|cell| cell.mse / mse_unit));
        if with_max {
            cells.push(row.max_error.map_or("-".to_owned(), |value| value.to_string()));
            cells.extend(ours(&|cell| cell.max_error / max_unit));
        }
        if with_improvement {
            cells.push(row.improvement.map_or("-".to_owned(), |value| value.to_string()));
            for column in &table.columns {
                let cell = |index: Option<usize>| column.cells.get(index?).copied().flatten();
                cells.push(improvement(
                    printed.improvement_of,
                    row,
                    cell(Some(index)),
                    cell(linear),
                ));
            }
        }
        cells
    });
    let inference = if several || printed.number.starts_with('5') {
        ""
    } else {
        table.columns.first().map_or("", |column| column.title.as_str())
    };
    let ours = if inference.is_empty() { String::new() } else { format!("Ours: {inference}. ") };
    Table {
        title: format!("Thesis table {}: {}", printed.number, printed.title),
        caption: format!("{ours}{}", notes::of(printed.number)),
        columns,
        rows: rows.collect(),
        highlight: None,
    }
}

fn improvement(
    of: ImprovementOf,
    row: &PrintedRow,
    ours: Option<Cell>,
    linear: Option<Cell>,
) -> String {
    let (Some(ours), Some(linear)) = (ours, linear) else { return "-".to_owned() };
    let ratio = match of {
        ImprovementOf::Nothing => return "-".to_owned(),
        ImprovementOf::MaxError => ours.max_error / linear.max_error,
        ImprovementOf::Mse => ours.mse / linear.mse,
    };
    if row.scheme == Scheme::Linear {
        "-".to_owned()
    } else {
        format!("{:.1}", 100.0 * (1.0 - ratio))
    }
}

/// What the order of Table 5.1 comes from.
fn explained(found: &ThesisTables) -> Table {
    let rows = found
        .example
        .velocity
        .iter()
        .map(|(case, runs)| {
            let name = |model: Option<super::ExampleModel>| {
                model.map_or("none".to_owned(), |model| model.title().to_owned())
            };
            let mse = Sample::of(runs.iter().map(|run| run.mse));
            vec![
                name(case.plant),
                name(case.observer),
                format!("{}", case.injection),
                format!("{}", case.p),
                format!("{} ± {}", number(1e6 * mse.mean), number(1e6 * mse.deviation())),
                found
                    .example
                    .relative(case)
                    .map_or("-".to_owned(), |relative| format!("{relative:.3}")),
            ]
        })
        .collect();
    Table {
        title: "Where the order of Table 5.1 comes from".to_owned(),
        caption: "Mean over the seeds ± standard deviation. The last rows have no friction and no observer, but the proportional gain that injection amounts to: P + sigma k is 6.1 \
                  for the proposed model and 4.7 for LuGre. They do as well as the observers with injection."
            .to_owned(),
        columns: ["friction of the plant", "observer", "k", "P", "mse (×1e-6)", "relative to no friction"]
            .map(str::to_owned)
            .to_vec(),
        rows,
        highlight: None,
    }
}

fn matrix(rows: &[MatrixRow], task: ThesisTask) -> Table {
    let mut columns = vec!["plant".to_owned(), "mse of none".to_owned()];
    columns.extend(MODELS.map(|model| format!("{} observer", model.title())));
    let of_task = rows.iter().filter(|row| row.task == task);
    let rows = of_task.map(|row| {
        let mut cells = vec![row.plant.title().to_owned(), format!("{:.3e}", row.none)];
        cells.extend(row.relative.iter().zip(MODELS).map(|(relative, model)| {
            let mark = if row.best() == Some(model) { " *" } else { "" };
            format!("{relative:.3}{mark}")
        }));
        cells
    });
    Table {
        title: format!("Plant by observer, {}: mse relative to none", task.title()),
        caption: match task {
            ThesisTask::VelocityRegulation => {
                "Only the estimate at 1 rad/s counts here: the observer that compensates most wins on every plant, so the task says nothing about models."
            }
            _ => {
                "A star marks the best observer of each plant: the model that the plant was made of, or one that cannot be told from it. What is robust is that any observer is \
                 several times better than none; a ranking of observers says which is nearest to the plant."
            }
        }
        .to_owned(),
        columns,
        rows: rows.collect(),
        highlight: None,
    }
}

/// One panel a task: the plants side by side, one mark an observer.
fn matrix_figure(rows: &[MatrixRow]) -> Figure {
    let panel = |task: ThesisTask| {
        let of_task: Vec<_> = rows.iter().filter(|row| row.task == task).collect();
        let traces = MODELS.map(|model| Trace::Categories {
            name: model.title().to_owned(),
            x: of_task.iter().map(|row| row.plant.title().to_owned()).collect(),
            y: of_task.iter().map(|row| row.relative(model).unwrap_or(f64::NAN)).collect(),
            mark: Mark::Marker,
        });
        Panel { y_label: format!("{}, relative mse", task.title()), traces: traces.to_vec() }
    };
    Figure {
        title: "Plant by observer".to_owned(),
        caption: "Mean square error with each observer relative to that of the linear controller alone, in the thesis's units without noise."
            .to_owned(),
        x_label: "friction of the plant".to_owned(),
        log_x: false,
        panels: ThesisTask::ALL.iter().copied().map(panel).collect(),
    }
}
