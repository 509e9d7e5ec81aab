//! `parameters.yaml`: every identified model as a ROS 2 parameter file, as `run`, `live` and the
//! observer read it.

use std::fmt::Write;

use friction_ident::{Estimate, Verdict};
use friction_model::ModelName;
use serde_json::{Map, Value, json};

use super::{FrictionIdentification, wording};
use files::commented_yaml;

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
    let mut parameters = Map::new();
    let mut asymmetric = Map::new();
    if let Some(first) = found.chosen() {
        parameters.insert("model".to_owned(), Value::from(first.found.name.as_str()));
    }
    let mut names: Vec<&str> =
        found.models.iter().map(|result| result.found.name.as_str()).collect();
    names.sort_unstable();
    let by_name =
        |name: &str| found.models.iter().find(|result| result.found.name.as_str() == name);
    for result in names.iter().filter_map(|name| by_name(name)) {
        let name = result.found.name.as_str();
        let mut described = serde_json::to_value(result.found.model)
            .map_err(|error| ParametersError(error.to_string()))?;
        if let Some(both) = described.get_mut("asymmetric").and_then(Value::as_object_mut) {
            asymmetric.append(both);
        } else if let Some(plain) = described.get_mut(name) {
            parameters.insert(name.to_owned(), plain.take());
        }
    }
    if !asymmetric.is_empty() {
        parameters.insert("asymmetric".to_owned(), asymmetric.into());
    }
    let file = json!({ "/friction_observer": { "ros__parameters": parameters } });
    let tree = file.as_object().cloned().unwrap_or_default();
    Ok(header(found) + &commented_yaml::render(&tree, &|path| origin(found, path)))
}

/// Where a value comes from, in words; `path` is its place in the file.
fn origin(found: &FrictionIdentification, path: &str) -> String {
    let mut parts = path.split('.').skip(2).filter(|part| *part != "asymmetric");
    let (Some(model), Some(first)) = (parts.next(), parts.next()) else {
        return if path.ends_with(".model") {
            "the model chosen".to_owned()
        } else {
            String::new()
        };
    };
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
        Verdict::NotIdentifiable { .. } => "not identifiable from these recordings".to_owned(),
        Verdict::Given { source } => format!("not estimated: {source}"),
    }
}

/// Where it comes from, and how sure the chosen model's parameters are.
fn header(found: &FrictionIdentification) -> String {
    let mut text =
        format!("# Friction models fitted by frictionlab {} to", env!("CARGO_PKG_VERSION"));
    for file in &found.files {
        // A path must not end the comment it stands in. Writing to a string cannot fail.
        let path: String = file
            .path
            .display()
            .to_string()
            .chars()
            .map(|c| if c.is_control() { ' ' } else { c })
            .collect();
        let _ = write!(text, " {path}");
    }
    text.push_str(".\n");
    if let Some(first) = found.chosen() {
        for estimate in &first.found.estimates.parameters {
            let (value, error) = wording::value(estimate);
            let plus = if error.is_empty() { String::new() } else { format!(" +- {error}") };
            let added = wording::from_drive(first, estimate);
            let plus =
                if added.is_empty() { plus } else { format!("{plus}, from the drive +- {added}") };
            let unit = if estimate.unit.is_empty() {
                String::new()
            } else {
                format!(" {}", estimate.unit)
            };
            let doubt =
                if estimate.is_identified() { "" } else { ", not identified by these recordings" };
            let _ = writeln!(
                text,
                "# {}.{}: {value}{plus}{unit}{doubt}",
                first.found.name, estimate.id
            );
        }
    }
    text
}
