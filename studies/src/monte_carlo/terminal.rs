//! A study as text.

use super::{Cell, Study};

/// One table a cell: what each arm is worth, and how the models stand.
#[must_use]
pub fn summary(study: &Study) -> String {
    let mut text = String::new();
    for cell in &study.cells {
        text += &worth(study, cell);
        text += &standings(study, cell);
    }
    if study.stopped {
        text += "stopped before the end: the figures rest on fewer draws\n";
    }
    text
}

fn worth(study: &Study, cell: &Cell) -> String {
    let alone = cell.worth(0);
    let mut text = format!(
        "{} on {}, {}: linear controller alone {:.3e} ({:.3} V), without friction {:.3e} ({:.1} times less)\n",
        capitalised(cell.task.title()),
        cell.plant.title(),
        report::numbers::count(cell.draws.len(), "draw"),
        alone.mse.median,
        alone.effort,
        cell.floor.mse,
        cell.ceiling()
    );
    text += &format!(
        "  {:<36}{:>8}{:>8}{:>8}{:>8}{:>8}{:>11}{:>8}{:>9}\n",
        "mse smaller, times", "5 %", "25 %", "50 %", "75 %", "95 %", "max error", "worse", "volts"
    );
    for (index, arm) in study.arms.iter().enumerate().skip(1) {
        let worth = cell.worth(index);
        let ratio = &worth.mse_ratio;
        text += &format!(
            "  {:<36}{:>8.2}{:>8.2}{:>8.2}{:>8.2}{:>8.2}{:>11.2}{:>6.1} %{:>9.3}\n",
            arm.to_string(),
            ratio.p5,
            ratio.p25,
            ratio.median,
            ratio.p75,
            ratio.p95,
            worth.max_error_ratio.median,
            100.0 * worth.worse,
            worth.effort
        );
    }
    text
}

fn standings(study: &Study, cell: &Cell) -> String {
    let mut text = String::new();
    for ranking in study.rankings(cell) {
        text += &format!(
            "  first by {}, {}: ",
            ranking.means.as_str(),
            report::numbers::count(ranking.orders, "order")
        );
        let shares: Vec<String> = ranking
            .standings
            .iter()
            .map(|standing| {
                format!(
                    "{} {:.1} ± {:.1} %",
                    standing.model,
                    100.0 * standing.first,
                    100.0 * standing.first_error
                )
            })
            .collect();
        text += &format!("{}\n", shares.join(", "));
    }
    text.push('\n');
    text
}

pub(super) fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
