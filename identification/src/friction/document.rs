//! `identification.json` of friction models.
//!
//! ```text
//! format                  "frictionlab-friction-identification"; format_version, program_version
//! axis                    "linear" or "rotary"
//! speeds                  [lowest, highest] of the recordings [m/s or rad/s]; null where nothing moved
//! files, validation       file, samples, points, stretches, outliers (channel, time, measured, by), pieces_left_out, timing (what was
//!                         uneven and what was done: repeated, moved, filled, dropped, gaps, missing, pauses, rate_changes, stretches, too_short),
//!                         added_uncertainty (rms, largest) of the friction by the drive's constants; null with a torque sensor
//! recordings              of each kind: points or samples fitted to, and held out
//! settings                models, asymmetric, elements, joint, inertia, damping_ratio, torque_source, drive_constants
//!                         (each value and standard_error; null with a sensor), smoothing, decimate, reach
//! beside_friction         chosen and compared: offset, position ("none", "spring" or "gravity"), and of what was compared unexplained_percent
//!                         of the force in blocks kept back
//! ranking                 by ("held_out" or "bic"), chosen (null where no fit can be trusted), and in order: model, free_parameters, cannot_be_chosen (why, or null), tie,
//!                         standing ("alike", "worse", "undecided"), difference_of_mean_square and ln_ratio_of_mean_square (mean,
//!                         standard_error), each to the first and paired over blocks; at_rest_too: of the models that predict at rest too, model and
//!                         rms over all samples, best first; null where that decided nothing
//! models                  name ->
//!   parameters            name -> value, unit, standard_error, interval_95 ([low, high]; null is open), identified, explanation,
//!                         from_drive (standard_error, and by_constant how far one standard error of each moves it); null with a sensor.
//!                         standard_error and interval_95 do not contain from_drive
//!   correlation           names, matrix: of the last fit
//!   fit, held_out         rms [N or N m] over all, and of each kind; held_out is null without --validate
//!   information           samples, effective_samples, parameters, mse, aic, bic
//!   stages                stage, samples, rms, parameters as above
//!   stopped               stopped before its end
//!   notes
//! warnings                why the chosen model is not to be trusted as a whole
//! notes, interrupted
//! ```

use friction_ident::{Estimate, Estimates, FrictionData};
use serde_json::{Map, Value, json};

use super::from_drive::FromDrive;
use super::{Errors, FrictionIdentification, KINDS, ModelResult, Source, wording};
use crate::speeds;

/// The document as text.
pub fn render(found: &FrictionIdentification) -> String {
    let staged = &found.settings.staged;
    let preparation = &found.settings.preparation;
    let ranking: Vec<Value> = found
        .models
        .iter()
        .map(|result| {
            json!({
                "model": result.found.name,
                "free_parameters": result.found.free_parameters,
                "cannot_be_chosen": result.cannot_be_chosen,
                "tie": result.tie(),
                "standing": result.standing,
                "difference_of_mean_square": result.difference,
                "ln_ratio_of_mean_square": result.ratio,
            })
        })
        .collect();
    let models: Map<String, Value> = found
        .models
        .iter()
        .map(|result| (result.found.name.as_str().to_owned(), model(result)))
        .collect();
    let document = json!({
        "format": "frictionlab-friction-identification",
        "format_version": 1,
        "program_version": env!("CARGO_PKG_VERSION"),
        "axis": found.settings.axis,
        "speeds": speeds::range(found.velocities()),
        "files": found.files.iter().map(source).collect::<Vec<_>>(),
        "validation": found.validation.iter().map(source).collect::<Vec<_>>(),
        "recordings": {
            "fitted": counts(&found.data),
            "held_out": found.held_out.as_ref().map(counts),
        },
        "settings": {
            "models": found.settings.models,
            "asymmetric": staged.asymmetric,
            "elements": staged.elements,
            "joint": staged.joint,
            "inertia": staged.inertia,
            "damping_ratio": staged.damping_ratio,
            "torque_source": preparation.torque.describe(),
            "drive_constants": preparation.drive,
            "smoothing": preparation.smoothing,
            "decimate": preparation.decimate,
            "reach": found.settings.reach,
        },
        "beside_friction": {
            "chosen": found.beside.chosen,
            "compared": found.beside.compared.iter().map(|(shape, percent)| json!({
                "offset": shape.offset,
                "position": shape.position,
                "unexplained_percent": percent,
            })).collect::<Vec<_>>(),
        },
        "ranking": {
            "by": found.criterion,
            "chosen": found.chosen().map(|result| result.found.name),
            "order": ranking,
            "at_rest_too": found.at_rest_too.as_ref().map(|told| told.errors.iter().map(
                |(name, rms)| json!({ "model": name, "rms": rms })
            ).collect::<Vec<_>>()),
        },
        "models": models,
        "warnings": found.warnings,
        "notes": found.notes,
        "interrupted": found.interrupted,
    });
    let mut text = format!("{document:#}");
    text.push('\n');
    text
}

fn source(source: &Source) -> Value {
    json!({
        "file": source.path.display().to_string(),
        "samples": source.samples,
        "points": source.points,
        "stretches": source.stretches,
        "outliers": source.outliers,
        "pieces_left_out": source.irregularities.too_short,
        "timing": source.irregularities,
        "added_uncertainty": source.added,
    })
}

fn counts(data: &FrictionData) -> Value {
    let count = |kind| FrictionIdentification::count(data, kind);
    KINDS.iter().map(|&kind| (key(kind), json!(count(kind)))).collect::<Map<_, _>>().into()
}

fn key(kind: friction_ident::StretchKind) -> String {
    match serde_json::to_value(kind) {
        Ok(Value::String(name)) => name,
        _ => kind.describe().to_owned(),
    }
}

fn model(result: &ModelResult) -> Value {
    let found = &result.found;
    let last = found.stages.iter().rev().find(|stage| stage.estimates.parameters.len() > 1);
    let stages: Vec<Value> = found
        .stages
        .iter()
        .map(|stage| {
            json!({
                "stage": stage.stage,
                "samples": stage.samples,
                "rms": stage.rms,
                "parameters": parameters(&stage.estimates, None),
            })
        })
        .collect();
    json!({
        "parameters": parameters(&found.estimates, result.from_drive.as_ref()),
        "correlation": last.map(|stage| json!({
            "names": stage.estimates.parameters.iter().map(|p| p.id.to_string()).collect::<Vec<_>>(),
            "matrix": stage.estimates.correlation,
        })),
        "fit": errors(&result.fit),
        "held_out": result.held_out.as_ref().map(errors),
        "information": found.information,
        "stages": stages,
        "stopped": found.stopped,
        "notes": found.notes,
    })
}

fn errors(errors: &Errors) -> Value {
    let kinds: Map<String, Value> =
        KINDS.iter().zip(errors.kinds).map(|(&kind, rms)| (key(kind), json!(rms))).collect();
    json!({ "rms": errors.all, "rms_of_kind": kinds })
}

fn parameters(estimates: &Estimates, from_drive: Option<&FromDrive>) -> Value {
    let named = |p: &Estimate| (p.id.to_string(), parameter(p, from_drive));
    estimates.parameters.iter().map(named).collect::<Map<_, _>>().into()
}

fn parameter(estimate: &Estimate, from_drive: Option<&FromDrive>) -> Value {
    let from_drive = from_drive.and_then(|from| {
        let standard_error = from.of(estimate.id)?;
        let moves = from.by_constant(estimate.id);
        let by_constant: Map<String, Value> =
            moves.iter().map(|(constant, by)| (constant.name().to_owned(), json!(by))).collect();
        Some(json!({ "standard_error": standard_error, "by_constant": by_constant }))
    });
    json!({
        "from_drive": from_drive,
        "value": estimate.value,
        "unit": estimate.unit,
        "standard_error": estimate.standard_error,
        "interval_95": estimate.interval.map(|interval| [interval.low, interval.high]),
        "identified": estimate.is_identified(),
        "explanation": wording::verdict(estimate),
    })
}
