//! What the terminal shows.

use std::fmt::Write;

use super::structure::Structured;
use super::structure_page;
use super::{Identification, ModelResult, unit};
use friction_ident::robust_covariance::METHOD;
use friction_ident::{Conditioning, Load};
use recording::Recording;
use report::numbers::{significant, value_and_error as with_error};

/// A summary for people: parameters with standard errors, errors, notes. A structure that was chosen
/// stands before the plain models, and what is wrong with one of these stands with it.
pub fn render(
    found: &Identification,
    structured: Option<&Structured>,
    recording: &Recording,
    validation: Option<&Recording>,
) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail, hence the ignored results.
    let _ = writeln!(
        text,
        "{}: {} samples, {:.2} s at {} Hz",
        recording.path.display(),
        recording.samples(),
        recording.duration(),
        hertz(1.0 / recording.time_step)
    );
    for warning in &found.warnings {
        let _ = writeln!(text, "\nWARNING: {warning}");
    }
    if !found.warnings.is_empty() {
        text.push('\n');
    }
    let how = found.settings.conditioning;
    let _ = writeln!(
        text,
        "low-pass {} (order {}, forwards and backwards), {} samples off each end, 1 in {} kept: {} fitted",
        low_pass(&how),
        how.order,
        how.trim,
        how.decimate,
        found.symmetric.fit.samples
    );
    if let Some(structured) = structured {
        text.push_str(&structure_page::terminal(structured));
        text.push_str("\nThe plain models beside it:\n");
    }
    model(&mut text, found, &found.symmetric, "symmetric", validation);
    if let Some(asymmetric) = &found.asymmetric {
        model(&mut text, found, asymmetric, "asymmetric", validation);
    }
    let _ = writeln!(text, "\nstandard errors: {METHOD}");
    for note in &found.notes {
        let _ = writeln!(text, "\nnote: {note}");
    }
    text
}

fn model(
    text: &mut String,
    found: &Identification,
    result: &ModelResult,
    name: &str,
    validation: Option<&Recording>,
) {
    let axis = found.settings.axis;
    let _ = writeln!(text, "\n{name}: {}", equation(result, axis.force_word()));
    let rows: Vec<_> = result
        .fit
        .terms
        .iter()
        .map(|estimate| {
            let (value, error) = with_error(estimate.value, estimate.standard_error);
            let mark = if estimate.doubt.is_some() { "  not to be trusted" } else { "" };
            let half = with_error(estimate.value, estimate.half_width).1;
            (
                estimate.term.name(),
                value,
                error,
                unit(estimate.term, axis),
                if half.is_empty() {
                    format!("95 %: none{mark}")
                } else {
                    format!("95 %: ± {half}{mark}")
                },
            )
        })
        .collect();
    let width = |of: fn(&(&str, String, String, &str, String)) -> usize| {
        rows.iter().map(of).max().unwrap_or(0)
    };
    let (first, second) = (width(|r| r.0.len()), width(|r| r.1.len()));
    let (third, fourth) = (width(|r| r.2.len()), width(|r| r.3.len()));
    for (term, value, error, unit, interval) in &rows {
        let _ = writeln!(
            text,
            "  {term:first$}  {value:>second$} ± {error:third$}  {unit:fourth$}  ({interval})"
        );
    }
    let _ = writeln!(text, "  relative error {:.3} %", result.fit.relative_error);
    if let (Some(prediction), Some(other)) = (&result.validation, validation) {
        let _ = writeln!(
            text,
            "  cross-test     {:.3} %  on {}",
            prediction.relative_error,
            other.path.display()
        );
    }
    if let Some(run) = result.free_run {
        let unit = axis.position_unit();
        let said = |rms: Option<f64>| {
            rms.map_or_else(|| "none".to_owned(), |rms| format!("{} {unit}", significant(rms, 4)))
        };
        let there = validation.map_or(String::new(), |other| {
            format!(", {} on {}", said(run.validation), other.path.display())
        });
        let _ =
            writeln!(text, "  free run       {} rms of the position{there}", said(run.estimation));
    }
    for said in found.beside(result) {
        let _ = writeln!(text, "  WARNING: {said}");
    }
}

/// The model's equation in one line.
pub fn equation(result: &ModelResult, force: &str) -> String {
    let model = result.fit.model;
    let mut parts = Vec::new();
    if model.inertia {
        parts.push("inertia a");
    }
    if model.asymmetric {
        parts.push("viscous± v + coulomb± sign(v)");
    } else {
        parts.push("viscous v + coulomb sign(v)");
        if model.offset {
            parts.push("offset");
        }
    }
    match model.load {
        Load::None => {}
        Load::Spring => parts.push("spring q"),
        Load::Gravity => parts.push("gravity_sin sin q + gravity_cos cos q"),
    }
    format!("{} = {force}", parts.join(" + "))
}

/// Up to where motion passes.
pub fn low_pass(how: &Conditioning) -> String {
    if how.acceleration_cutoff < how.cutoff {
        let [motion, acceleration] = [how.cutoff, how.acceleration_cutoff].map(hertz);
        return format!("{motion} Hz, of the acceleration {acceleration} Hz");
    }
    format!("{} Hz", hertz(how.cutoff))
}

/// A frequency with as many decimals as it deserves.
pub fn hertz(value: f64) -> String {
    let rounded = (value * 1e3).round() / 1e3;
    format!("{rounded}")
}
