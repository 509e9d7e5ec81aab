//! `parameters.yaml`: every identified model as a ROS 2 parameter file, as `run`, `live` and the
//! observer read it.

use friction_ident::{Doubt, Estimate, Verdict};
use friction_model::ModelName;
use friction_observer::parameters::model_parameters;
use parameters::ParameterValue;
use parameters::file::Writer;

use super::{FrictionIdentification, wording};
use crate::speeds;

/// The file could not be written down.
#[derive(Debug, thiserror::Error)]
#[error("the parameters cannot be written as YAML: {0}")]
pub struct ParametersError(String);

/// The file as text; `model` is the chosen one. Behind each value stands whether these recordings
/// identified it.
///
/// # Errors
/// [`ParametersError`] if a model cannot be described, which no model built from finite numbers is.
pub fn render(found: &FrictionIdentification) -> Result<String, ParametersError> {
    let mut file = Writer::default();
    header(found, &mut file);
    file.node("/friction_observer");
    if let Some(first) = found.chosen() {
        let name = ParameterValue::String(first.found.name.to_string());
        file.value("model", name, "the model chosen");
    }
    let mut models: Vec<_> = found.models.iter().map(|result| result.found.model).collect();
    models.sort_unstable_by_key(|model| model.name().as_str());
    for model in models {
        let said = model_parameters(&model).map_err(|error| ParametersError(error.to_string()))?;
        for (path, value) in said {
            let origin = origin(found, &path);
            file.value(&path, value, &origin);
        }
    }
    Ok(file.text())
}

/// Where a value comes from, in words; `path` is its place in the file.
fn origin(found: &FrictionIdentification, path: &str) -> String {
    let mut parts = path.split('.').filter(|part| *part != "asymmetric");
    let (Some(model), Some(first)) = (parts.next(), parts.next()) else { return String::new() };
    let Some(result) = model.parse().ok().and_then(|name: ModelName| found.model(name)) else {
        return String::new();
    };
    let estimates = &result.found.estimates.parameters;
    let estimate = |name: &str| estimates.iter().find(|estimate| estimate.id.to_string() == name);
    // A model for each direction names its parameters `f_s.forward`.
    let known = match parts.next() {
        Some(parameter) => {
            estimate(&format!("{parameter}.{first}")).or_else(|| estimate(parameter))
        }
        None => estimate(first),
    };
    known.map_or_else(|| "not among the parameters identified".to_owned(), said)
}

fn said(estimate: &Estimate) -> String {
    match &estimate.verdict {
        Verdict::Identified => {
            let (_, error) = wording::value(estimate);
            if error.is_empty() {
                "identified".to_owned()
            } else {
                format!("identified, +- {error}")
            }
        }
        Verdict::NotIdentifiable { doubt: Doubt::NotToBeTrusted { .. }, .. } => {
            "its interval is not to be trusted; the report says why".to_owned()
        }
        Verdict::NotIdentifiable { .. } => "not identifiable from these recordings".to_owned(),
        Verdict::Given { source } => format!("not estimated: {source}"),
    }
}

/// Where it comes from, and how sure the chosen model's parameters are.
fn header(found: &FrictionIdentification, file: &mut Writer) {
    let paths: String =
        found.files.iter().map(|file| format!(" {}", file.path.display())).collect();
    let version = env!("CARGO_PKG_VERSION");
    file.comment(&format!("Friction models fitted by frictionlab {version} to{paths}."));
    if let Some(line) = speeds::line(found.velocities(), found.settings.axis) {
        file.comment(&line);
    }
    let Some(first) = found.chosen() else {
        file.comment(wording::NONE_CHOSEN);
        return;
    };
    for estimate in &first.found.estimates.parameters {
        let (value, error) = wording::value(estimate);
        let plus = if error.is_empty() { String::new() } else { format!(" +- {error}") };
        let added = wording::from_drive(first, estimate);
        let plus =
            if added.is_empty() { plus } else { format!("{plus}, from the drive +- {added}") };
        let unit = match estimate.unit {
            "" => String::new(),
            unit => format!(" {unit}"),
        };
        let doubt =
            if estimate.is_identified() { "" } else { ", not identified by these recordings" };
        let (model, id) = (first.found.name, &estimate.id);
        file.comment(&format!("{model}.{id}: {value}{plus}{unit}{doubt}"));
    }
}
