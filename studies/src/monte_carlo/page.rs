//! `report.html` of a study as data.

use friction_model::ModelName;

use super::terminal::capitalised;
use super::{Cell, Setting, Sharing, Study, Task};
use experiment_runner::compensation::{Arm, Means};
use report::figure::{Block, Figure, LineStyle, Page, Panel, Table, Trace};
use report::numbers;

/// The page.
#[must_use]
pub fn page(study: &Study) -> Page {
    let errors = &study.errors;
    let mut blocks = vec![Block::Text(format!(
        "In each draw every parameter of a model, and every drive constant that the compensation uses, is multiplied by a factor of its own, even within ± {:.0} %; {}. \
         Where F_s would come out below F_c the two change places. {}, the linear controller's gains are the same in every arm \
         unless the arm's name says otherwise, and the plant inverse is off. Errors are those of the shaft itself.",
        100.0 * errors.fraction,
        match errors.sharing {
            Sharing::Common => "parameters of one name have one factor in all models",
            Sharing::Own => "every model has factors of its own",
        },
        match study.setting {
            Setting::Physical =>
                "Friction is a torque, and the sensors have noise and converter steps",
            Setting::Thesis =>
                "As in the thesis's simulations friction in N m is taken off the volts and the sensors are ideal",
        }
    ))];
    if study.stopped {
        blocks.push(Block::Note(
            "Stopped before the end: the figures rest on fewer draws.".to_owned(),
        ));
    }
    for cell in &study.cells {
        blocks.push(Block::Heading(format!(
            "{}, plant {}",
            capitalised(cell.task.title()),
            cell.plant.title()
        )));
        blocks.push(Block::Table(worth(study, cell)));
        blocks.push(Block::Figure(distributions(study, cell)));
        blocks.extend(rankings(study, cell).map(Block::Table));
    }
    for &task in Task::ALL {
        blocks.extend(matrices(study, task).map(Block::Table));
    }
    Page {
        title: "What compensation is worth".to_owned(),
        subtitle: format!(
            "{}, errors within ± {:.0} %, seed {}; frictionlab {}",
            numbers::count(study.draws as usize, "draw"),
            100.0 * errors.fraction,
            errors.seed,
            study.program_version
        ),
        blocks,
    }
}

fn worth(study: &Study, cell: &Cell) -> Table {
    let columns = [
        "arm",
        "5 %",
        "25 %",
        "median",
        "75 %",
        "95 %",
        "max error, median",
        "worse than alone [%]",
        "effort [V rms]",
    ];
    let rows: Vec<Vec<String>> = study
        .arms
        .iter()
        .enumerate()
        .skip(1)
        .map(|(index, arm)| {
            let worth = cell.worth(index);
            let ratio = &worth.mse_ratio;
            let mut row = vec![arm.to_string()];
            row.extend(
                [
                    ratio.p5,
                    ratio.p25,
                    ratio.median,
                    ratio.p75,
                    ratio.p95,
                    worth.max_error_ratio.median,
                ]
                .map(|value| format!("{value:.2}")),
            );
            row.extend([format!("{:.1}", 100.0 * worth.worse), format!("{:.3}", worth.effort)]);
            row
        })
        .collect();
    let alone = cell.worth(0);
    let best = (1..study.arms.len())
        .max_by(|&a, &b| cell.worth(a).mse_ratio.median.total_cmp(&cell.worth(b).mse_ratio.median));
    Table {
        title: "How many times smaller the mean square of the error becomes".to_owned(),
        caption: format!(
            "Percentiles of (linear controller alone) / (compensated) over {}, pairs under the same noise. Alone: mean square {:.3e} ({unit})^2, largest error {:.4} {unit}, \
             {:.3} V rms. Without any friction the same controller has {:.3e} ({unit})^2, {:.1} times less: that part is the controller's own lag behind the reference.",
            numbers::count(cell.draws.len(), "draw"),
            alone.mse.median,
            median_max_error(cell),
            alone.effort,
            cell.floor.mse,
            cell.ceiling(),
            unit = cell.task.unit(),
        ),
        columns: columns.map(str::to_owned).to_vec(),
        rows,
        highlight: best.map(|index| index - 1),
    }
}

fn median_max_error(cell: &Cell) -> f64 {
    super::worth::Percentiles::of(
        cell.draws.iter().filter_map(|trials| trials.first()).map(|trial| trial.max_error),
    )
    .median
}

/// One panel a technique over models; those that need none share one. All have the same axes.
fn distributions(study: &Study, cell: &Cell) -> Figure {
    let mut groups: Vec<(Option<Means>, Vec<usize>)> = Vec::new();
    for (index, arm) in study.arms.iter().enumerate().skip(1) {
        let means = arm.means().filter(|means| means.needs_model());
        match groups.iter_mut().find(|(known, _)| *known == means) {
            Some((_, arms)) => arms.push(index),
            None => groups.push((means, vec![index])),
        }
    }
    let panels = groups.into_iter().map(|(means, arms)| {
        let traces = arms
            .iter()
            .map(|&index| {
                let ratios = cell.ratios(index);
                let n = ratios.len() as f64;
                Trace::Line {
                    name: match study.arms[index] {
                        Arm::Model(_, model) => model.title().to_owned(),
                        arm => arm.to_string(),
                    },
                    y: (0..ratios.len()).map(|i| 100.0 * (i as f64 + 0.5) / n).collect(),
                    x: ratios,
                    style: LineStyle::Solid,
                }
            })
            .collect();
        Panel { y_label: format!("{} [%]", means.map_or("without a model", Means::as_str)), traces }
    });
    Figure {
        title: format!("{} on {}", capitalised(cell.task.title()), cell.plant.title()),
        caption: "Share of the draws in which the mean square became smaller by less than the factor below, a panel a technique. Further right is better; left of 1 is worse \
                  than no compensation. A steep line does not depend on the parameters."
            .to_owned(),
        x_label: "times smaller [-]".to_owned(),
        log_x: true,
        panels: panels.collect(),
    }
}

fn rankings(study: &Study, cell: &Cell) -> impl Iterator<Item = Table> {
    study.rankings(cell).into_iter().map(|ranking| Table {
        title: format!("The models of {} in order", ranking.means.as_str()),
        caption: format!(
            "Over {} {} occurred. By chance alone each model would be first in {:.1} % of them.",
            numbers::count(ranking.draws, "draw"),
            numbers::count(ranking.orders, "order"),
            100.0 / ranking.standings.len() as f64
        ),
        columns: [
            "model",
            "first [%]",
            "standard error [%]",
            "mean place",
            "behind the best, median",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: ranking
            .standings
            .iter()
            .map(|standing| {
                vec![
                    standing.model.title().to_owned(),
                    format!("{:.1}", 100.0 * standing.first),
                    format!("{:.1}", 100.0 * standing.first_error),
                    format!("{:.2}", standing.place),
                    format!("{:.3}", standing.behind),
                ]
            })
            .collect(),
        highlight: None,
    })
}

/// Plant by observer: who is first, one table a technique.
fn matrices(study: &Study, task: Task) -> impl Iterator<Item = Table> {
    let cells: Vec<&Cell> = study.cells.iter().filter(|cell| cell.task == task).collect();
    let kinds = if cells.len() > 1 { study.rankings(cells[0]) } else { Vec::new() };
    kinds.into_iter().map(move |kind| {
        let models: Vec<ModelName> = kind.standings.iter().map(|standing| standing.model).collect();
        let mut columns = vec!["plant".to_owned()];
        columns.extend(models.iter().map(|model| model.title().to_owned()));
        let rows = cells
            .iter()
            .map(|cell| {
                let mut row = vec![cell.plant.title().to_owned()];
                let ranking = study.rankings(cell).into_iter().find(|ranking| ranking.means == kind.means);
                row.extend(ranking.iter().flat_map(|ranking| &ranking.standings).map(|standing| {
                    let arm = study.arms.iter().position(|arm| *arm == Arm::Model(kind.means, standing.model));
                    let ratio = arm.map_or(f64::NAN, |arm| cell.worth(arm).mse_ratio.median);
                    format!("{:.0} ({ratio:.2})", 100.0 * standing.first)
                }));
                row
            })
            .collect();
        Table {
            title: format!("Plant by observer: {}, {}", task.title(), kind.means.as_str()),
            caption: "Share of the draws in which the column's model is first on the row's plant [%]; in brackets how many times smaller the mean square became, median."
                .to_owned(),
            columns,
            rows,
            highlight: None,
        }
    })
}
