//! What a run found, for the terminal.

use super::{Characterisation, Comparison, Outcome};
use crate::characterise::Measured;
use report::numbers;

/// What was found, for the terminal.
#[must_use]
pub fn summary(outcome: &Outcome) -> String {
    let results = &outcome.results;
    let mut text = String::new();
    if let Some(found) = &results.identification {
        text += "Stribeck curve\n";
        for p in &found.parameters {
            text += &match (p.estimate.unidentifiable, p.estimate.standard_error) {
                (Some(reason), _) => {
                    format!("  {:<4} not identifiable from these data: {reason}\n", p.name)
                }
                (None, Some(error)) if error > 0.0 => {
                    format!("  {:<4} {:.5} ± {error:.0e} {}\n", p.name, p.estimate.value, p.unit)
                }
                (None, Some(_)) => format!("  {:<4} {:.5} {}\n", p.name, p.estimate.value, p.unit),
                (None, None) => {
                    format!("  {:<4} {:.5} {} (at its bound)\n", p.name, p.estimate.value, p.unit)
                }
            };
        }
    }
    text += &results.repeated().map_or(String::new(), |said| said + "\n");
    text += &results.resumed().map_or(String::new(), |said| said + "\n");
    text += &results.added_to_points().map_or(String::new(), |said| said + "\n");
    text += &characterisation(&results.characterisation);
    for (name, comparison) in results.comparisons() {
        text += &table(name, comparison);
    }
    text += results.thesis_tables.as_ref().map_or("", |found| &found.text);
    let megabytes = results.bag.bytes as f64 * 1e-6;
    text += &format!(
        "{}\nReport  {}\nBag     {} ({} messages, {megabytes:.0} MB)\n",
        numbers::rig_time(results.timing.rig_seconds, results.timing.wall_seconds),
        outcome.folder.join("report.html").display(),
        outcome.folder.join(results.bag.folder).display(),
        results.bag.messages,
    );
    text
}

/// The uncertainty, where there is one: a single repetition on a torque sensor has none to tell.
fn plus_minus(figure: &Measured) -> String {
    match figure.uncertainty() {
        uncertainty if uncertainty > 0.0 => format!(" ± {uncertainty:.0e}"),
        _ => String::new(),
    }
}

/// Experiments 2 to 4 for the terminal.
fn characterisation(found: &Characterisation) -> String {
    let mut text = String::new();
    let value = |figure: &Measured| format!("{:.5}{}", figure.mean, plus_minus(figure));
    for figures in &found.lag {
        let hint = if figures.visible() { "" } else { "   (not clear of its uncertainty)" };
        text += &format!(
            "Lag at {:>4} rad/s     loop area {:.3e}{} N m rad/s{hint}\n",
            figures.frequency,
            figures.area.mean,
            plus_minus(&figures.area)
        );
    }
    for figures in found.ramps.iter().chain(&found.rates) {
        text += &format!(
            "Breakaway, {:<15} {} N m at {} rad, {:.3} N m/s\n",
            figures.excitation,
            value(&figures.torque),
            value(&figures.displacement),
            figures.rate
        );
    }
    if let Some(gap) =
        found.closures.iter().map(|closure| closure.gap.mean.abs()).max_by(f64::total_cmp)
    {
        text += &format!(
            "Nested path: {} closed loops, largest gap {gap:.1e} rad\n",
            found.closures.len()
        );
    }
    for note in &found.notes {
        text += &format!("{note}\n");
    }
    text
}

fn table(title: &str, comparison: &Comparison) -> String {
    let names: Vec<String> = comparison.rows.iter().map(|row| row.arm.to_string()).collect();
    let width = names.iter().map(String::len).chain([title.len(), 18]).max().unwrap_or(18) + 2;
    let mut text =
        format!("{title:<width$}{:>12}{:>9}{:>14}{:>9}\n", "mse", "better", "max error", "better");
    let better = |percent: f64| match numbers::smaller_by(percent) {
        text if text.ends_with("larger") => text.replace("larger", "worse"),
        number => format!("{number} %"),
    };
    for (name, row) in names.iter().zip(&comparison.rows) {
        text += &format!(
            "  {name:<inner$}{:>12.3e}{:>9}{:>14.4}{:>9}\n",
            row.mse,
            better(row.mse_improvement),
            row.max_error,
            better(row.max_error_improvement),
            inner = width - 2,
        );
        if let Some(cycle) = row.limit_cycle {
            text += &format!(
                "{:width$}  hunts: {:.4} rad, {:.2} s\n",
                "", cycle.amplitude, cycle.period
            );
        }
    }
    text
}
