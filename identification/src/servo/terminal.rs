//! What the terminal shows.

use std::fmt::Write;

use friction_ident::statistics::Quartiles;
use friction_ident::{Estimate, Verdict};

use super::{PEER_RATE, ServoIdentification};
use report::numbers;

/// A summary for people: errors, speed, parameters.
pub fn render(found: &ServoIdentification) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail, hence the ignored results.
    let failure = found.failure();
    if let Some(failure) = &failure {
        let _ = writeln!(text, "FAILED: {failure}. No parameter is identified.");
    }
    for note in &found.settings.notes {
        let _ = writeln!(text, "note: {note}");
    }
    let _ = writeln!(
        text,
        "servo {}, level {}: {}, {} of {} evaluations{}",
        found.settings.servo,
        found.settings.level.name(),
        numbers::count(found.estimates.parameters.len(), "parameter"),
        numbers::searches(found.seeds.len()),
        found.settings.effort.evaluations,
        if found.stopped { ", stopped before the end" } else { "" }
    );
    let _ = writeln!(text, "mean position error over the searches, median (quartiles) [mrad]");
    let _ = writeln!(text, "  fitted    {}", quartiles(&found.train));
    if let Some(held_out) = &found.held_out {
        let _ = writeln!(text, "  held out  {}", quartiles(held_out));
    }
    let _ = writeln!(
        text,
        "evaluations a second and thread: {:.0} in the search, {:.0} without giving up early ({:.0} times the {PEER_RATE} of bam)",
        found.rate,
        found.whole_rate,
        found.whole_rate / PEER_RATE
    );
    if failure.is_some() {
        let _ = writeln!(
            text,
            "\ncheck the description of the servo (--servo), mass and length in the headers, and that goal \
             and position have one sign and one zero; then try a richer --level"
        );
        return text;
    }
    let _ = writeln!(text, "\nparameters of the search with the least error on what was fitted");
    for estimate in &found.estimates.parameters {
        let _ = writeln!(
            text,
            "  {:<16} {:>12} {:<14} {:<26} {}",
            estimate.id,
            number(estimate.value),
            estimate.unit,
            range(estimate),
            verdict(estimate)
        );
    }
    text
}

/// Median and quartiles in milliradians.
pub fn quartiles(of: &Quartiles) -> String {
    format!("{:.2} ({:.2} to {:.2})", 1e3 * of.median, 1e3 * of.lower, 1e3 * of.upper)
}

/// Four digits.
pub fn number(value: f64) -> String {
    if value != 0.0 && !(1e-3..1e5).contains(&value.abs()) {
        format!("{value:.3e}")
    } else {
        format!("{value:.5}")
    }
}

/// The interval in brackets.
pub fn range(estimate: &Estimate) -> String {
    let interval = estimate.interval;
    interval.map_or_else(String::new, |i| format!("[{}, {}]", number(i.low), number(i.high)))
}

/// Whether the data determine it, and what helps where not.
pub fn verdict(estimate: &Estimate) -> String {
    match &estimate.verdict {
        Verdict::Identified => "identified".to_owned(),
        Verdict::Given { source } => format!("given: {source}"),
        Verdict::NotIdentifiable { doubt, remedy } => {
            format!("not identifiable: {doubt}; {remedy}")
        }
    }
}
