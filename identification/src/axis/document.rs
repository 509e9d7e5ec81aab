//! `identification.json`.
//!
//! ```text
//! format, format_version, program_version
//! axis                     "linear" or "rotary"
//! recording                file, samples, time_step_s, duration_s, sources, timing (what was uneven and what was done: repeated, moved, filled, dropped,
//!                          gaps, missing, pauses, rate_changes, stretches, too_short, other_rate)
//! validation               the same of the recording for the cross-test, or null
//! settings                 cutoff_hz, acceleration_cutoff_hz, order, trim, decimate, low_pass_force
//! validation_settings      the same of the recording for the cross-test, whose motion may be faster; or null
//! speeds                   [lowest, highest] of the recording [m/s or rad/s]; null where nothing moved
//! standard_errors          how they were computed
//! load                     chosen (`none`, `spring`, `gravity`), compared (pairs of load and relative error in the cross-validation [%]); or null
//! symmetric, asymmetric    (the latter null where the recording does not show both directions)
//!   parameters             name -> value, standard_error, half_width_95 (of the interval), white_error (of ordinary least squares, which counts the
//!                          residual as white), unit, identifiable, not_to_be_trusted (why the interval is not, or null)
//!   correlation            of the errors: names, matrix
//!   relative_error_percent, residual_rms, residual_unit, samples
//!   cross_test             relative_error_percent, samples; or null
//!   free_run               rms and cross_test_rms of the simulated position, unit; null without --free-run
//! warnings                 why a model is not to be trusted as a whole: it explains too little, or what it leaves goes with the motion; last those that
//!                          are of a plain model alone (`The symmetric model ...`) where a structure was chosen
//! notes                    what must be known to read the numbers right
//! ```

use friction_ident::Conditioning;
use friction_ident::robust_covariance::METHOD;
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::{Identification, ModelResult, unit};
use crate::speeds;
use recording::{AxisKind, Recording};

/// The document as text.
pub fn render(
    found: &Identification,
    recording: &Recording,
    validation: Option<&Recording>,
) -> String {
    let axis = found.settings.axis;
    let of_plain = found.plain().flat_map(|model| found.beside(model));
    let warnings: Vec<String> = found.warnings.iter().cloned().chain(of_plain).collect();
    let document = json!({
        "format": "frictionlab-identification",
        "format_version": 1,
        "program_version": env!("CARGO_PKG_VERSION"),
        "axis": axis,
        "recording": source(recording),
        "validation": validation.map(source),
        "settings": settings(&found.settings.conditioning),
        "validation_settings": validation.map(|_| settings(&found.settings.elsewhere)),
        "speeds": speeds::range(found.symmetric.estimation.velocity.iter().copied()),
        "standard_errors": METHOD,
        "load": found.load,
        "symmetric": model(&found.symmetric, axis),
        "asymmetric": found.asymmetric.as_ref().map(|result| model(result, axis)),
        "warnings": warnings,
        "notes": found.notes,
    });
    let mut text = format!("{document:#}");
    text.push('\n');
    text
}

fn settings(how: &Conditioning) -> Value {
    json!({
        "cutoff_hz": how.cutoff,
        "acceleration_cutoff_hz": how.acceleration_cutoff,
        "order": how.order,
        "trim": how.trim,
        "decimate": how.decimate,
        "low_pass_force": how.low_pass_force,
    })
}

#[derive(Serialize)]
struct Parameter {
    value: f64,
    standard_error: f64,
    half_width_95: f64,
    white_error: f64,
    unit: &'static str,
    identifiable: bool,
    not_to_be_trusted: Option<String>,
}

fn model(result: &ModelResult, axis: AxisKind) -> Value {
    let parameters: Map<_, _> = result
        .fit
        .terms
        .iter()
        .map(|estimate| {
            let parameter = Parameter {
                value: estimate.value,
                standard_error: estimate.standard_error,
                unit: unit(estimate.term, axis),
                half_width_95: estimate.half_width,
                white_error: estimate.white_error,
                identifiable: estimate.is_identifiable(),
                not_to_be_trusted: estimate.doubt.map(|doubt| doubt.to_string()),
            };
            (estimate.term.name().to_owned(), json!(parameter))
        })
        .collect();
    let names: Vec<_> = result.fit.terms.iter().map(|estimate| estimate.term.name()).collect();
    json!({
        "parameters": parameters,
        "correlation": { "names": names, "matrix": result.fit.correlation },
        "relative_error_percent": result.fit.relative_error,
        "residual_rms": result.fit.residual_rms,
        "residual_unit": axis.force_unit(),
        "samples": result.fit.samples,
        "cross_test": result.validation.as_ref().map(|prediction| json!({
            "relative_error_percent": prediction.relative_error,
            "samples": prediction.measured.len(),
        })),
        "free_run": result.free_run.map(|run| json!({
            "rms": run.estimation,
            "cross_test_rms": run.validation,
            "unit": axis.position_unit(),
        })),
    })
}

fn source(recording: &Recording) -> Value {
    json!({
        "file": recording.path.display().to_string(),
        "samples": recording.samples(),
        "time_step_s": recording.time_step,
        "duration_s": recording.duration(),
        "sources": recording.sources,
        "timing": recording.irregularities,
    })
}
