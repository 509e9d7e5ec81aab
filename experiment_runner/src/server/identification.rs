//! Identification of friction models from a bag, on request.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use friction_ident::{Estimate, Verdict};
use msgs::friction_msgs::{EstimatedParameter, IdentifyRequest, IdentifyResponse, ModelFit};

use super::permissions::Permissions;
use super::{Refusal, request};
use identification::asked::friction::{self, Written};
use identification::friction::ModelResult;
use work::ending::told;
use work::progress::Progress;

/// Identifies what is asked for and writes it down; an answer that says what was wrong if nothing
/// could be. Ends early once `cancel` is set.
#[must_use]
pub fn identify(
    asked: &IdentifyRequest,
    permissions: &Permissions,
    cancel: &Arc<AtomicBool>,
) -> IdentifyResponse {
    attempt(asked, permissions, cancel).unwrap_or_else(|error| IdentifyResponse {
        message: error.to_string(),
        ..Default::default()
    })
}

fn attempt(
    asked: &IdentifyRequest,
    permissions: &Permissions,
    cancel: &Arc<AtomicBool>,
) -> Result<IdentifyResponse, Refusal> {
    let args = request::identify_args(asked, permissions)?;
    let progress = Progress::counting(1, "models", true);
    let Written { found, folder } =
        friction::identify(&args, permissions.besides().friction, &progress, cancel)
            .map_err(|error| Refusal::BadRequest(told(&error)))?;
    let chosen =
        found.chosen().map(|result| result.found.name.as_str().to_owned()).unwrap_or_default();
    let use_which =
        if chosen.is_empty() { "none can be used".to_owned() } else { format!("use {chosen}") };
    let stopped = if found.interrupted { "stopped before the end; " } else { "" };
    let notes = found
        .warnings
        .iter()
        .chain(&found.notes)
        .map(|note| format!(" {note}"))
        .collect::<String>();
    Ok(IdentifyResponse {
        success: true,
        message: format!("{stopped}{} models identified, {use_which}.{notes}", found.models.len()),
        model: chosen,
        parameters: found.models.iter().flat_map(parameters).collect(),
        fits: found.models.iter().map(fit).collect(),
        parameters_file: folder.join("parameters.yaml").display().to_string(),
        report: folder.join("report.html").display().to_string(),
    })
}

fn fit(result: &ModelResult) -> ModelFit {
    ModelFit {
        model: result.found.name.as_str().to_owned(),
        fit_error: result.fit.all,
        validation_error: result.held_out.map_or(f64::NAN, |errors| errors.all),
        parameters: u32::try_from(result.found.information.parameters).unwrap_or(u32::MAX),
        tie: result.tie(),
    }
}

fn parameters(result: &ModelResult) -> impl Iterator<Item = EstimatedParameter> {
    let model = result.found.name.as_str();
    result.found.estimates.parameters.iter().map(move |estimate| parameter(model, estimate))
}

fn parameter(model: &str, estimate: &Estimate) -> EstimatedParameter {
    let end = |end: Option<f64>| end.filter(|end| end.is_finite()).unwrap_or(f64::NAN);
    EstimatedParameter {
        model: model.to_owned(),
        name: estimate.id.to_string(),
        unit: estimate.unit.to_owned(),
        value: estimate.value,
        standard_error: estimate.standard_error.unwrap_or(f64::NAN),
        low: end(estimate.interval.map(|interval| interval.low)),
        high: end(estimate.interval.map(|interval| interval.high)),
        identified: estimate.is_identified(),
        explanation: match &estimate.verdict {
            Verdict::Identified => String::new(),
            Verdict::NotIdentifiable { doubt, remedy } => format!("{doubt}. Measure {remedy}."),
            Verdict::Given { source } => format!("not estimated: {source}"),
        },
    }
}
