//! What the terminal shows: the models in order, and the chosen one's parameters.

use std::fmt::Write;

use super::{FrictionIdentification, KINDS, wording};

/// A summary for people. Writing to a string cannot fail, hence the ignored results.
pub fn render(found: &FrictionIdentification) -> String {
    let mut text = String::new();
    for warning in &found.warnings {
        let _ = writeln!(text, "WARNING: {warning}\n");
    }
    let unit = found.settings.axis.force_unit();
    let recordings: Vec<String> = KINDS
        .iter()
        .map(|&kind| (FrictionIdentification::count(&found.data, kind), kind))
        .filter(|(count, _)| *count > 0)
        .map(|(count, kind)| format!("{count} of {}", kind.describe()))
        .collect();
    let _ = writeln!(text, "points and samples: {}", recordings.join(", "));
    let held_out = found.held_out.is_some();
    let _ = writeln!(
        text,
        "\n{:<18} {:>12} {:>12}{}",
        "model",
        "parameters",
        format!("fit [{unit}]"),
        if held_out {
            format!(" {:>14}", format!("held out [{unit}]"))
        } else {
            format!(" {:>12}", "BIC")
        },
    );
    for (place, result) in found.models.iter().enumerate() {
        let information = result.found.information;
        let last = match result.held_out {
            Some(errors) => format!("{:>16}", wording::significant(errors.all)),
            None => format!("{:>12}", wording::significant(information.bic)),
        };
        let _ = writeln!(
            text,
            "{:<18} {:>12} {:>12} {last}  {}",
            result.found.name.as_str(),
            result.found.free_parameters,
            wording::significant(result.fit.all),
            wording::place(found, place, result),
        );
    }
    if let Some(simpler) = wording::simpler(found) {
        let _ = writeln!(text, "{simpler}");
    }
    if let Some(chosen) = found.chosen() {
        let _ = writeln!(
            text,
            "\n{} (value ± one standard error; the 95 % intervals are in the report)",
            chosen.found.name
        );
        let from_drive = |estimate| match wording::from_drive(chosen, estimate) {
            added if added.is_empty() => String::new(),
            added => format!(", from the drive ± {added}"),
        };
        let rows: Vec<_> = chosen
            .found
            .estimates
            .parameters
            .iter()
            .map(|estimate| {
                let (value, error) = wording::value(estimate);
                (estimate, value, error)
            })
            .collect();
        let width = rows.iter().map(|(e, ..)| e.id.to_string().len()).max().unwrap_or(0);
        let numbers = rows.iter().map(|(_, value, _)| value.len()).max().unwrap_or(0);
        for (estimate, value, error) in rows {
            let plus = if error.is_empty() { String::new() } else { format!(" ± {error}") };
            let note = if estimate.is_identified() {
                String::new()
            } else {
                format!("  {}", wording::verdict(estimate))
            };
            let _ = writeln!(
                text,
                "  {:width$}  {value:>numbers$}{plus}{} {}{note}",
                estimate.id,
                from_drive(estimate),
                estimate.unit
            );
        }
    }
    for note in
        found.notes.iter().chain(found.chosen().iter().flat_map(|chosen| &chosen.found.notes))
    {
        let _ = writeln!(text, "\nnote: {note}");
    }
    text
}
