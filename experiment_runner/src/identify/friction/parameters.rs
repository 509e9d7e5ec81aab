//! `parameters.yaml`: every identified model as a ROS 2 parameter file, as `run`, `live` and the observer read it.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde::Serialize;
use serde_json::Value;

use super::{FrictionIdentification, wording};

#[derive(Serialize)]
struct File {
    #[serde(rename = "/friction_observer")]
    friction_observer: Node,
}

#[derive(Serialize)]
struct Node {
    #[serde(rename = "ros__parameters")]
    parameters: BTreeMap<String, Value>,
}

/// The file could not be written down.
#[derive(Debug, thiserror::Error)]
#[error("the parameters cannot be written as YAML: {0}")]
pub struct ParametersError(String);

/// The file as text; `model` is the chosen one.
///
/// # Errors
/// [`ParametersError`] if a model cannot be described, which no model built from finite numbers is.
pub fn render(found: &FrictionIdentification) -> Result<String, ParametersError> {
    let mut parameters = BTreeMap::new();
    let mut asymmetric = serde_json::Map::new();
    if let Some(first) = found.chosen() {
        parameters.insert("model".to_owned(), Value::from(first.found.name.as_str()));
    }
    for result in &found.models {
        let name = result.found.name.as_str();
        let mut described =
            serde_json::to_value(result.found.model).map_err(|error| ParametersError(error.to_string()))?;
        if let Some(both) = described.get_mut("asymmetric").and_then(Value::as_object_mut) {
            asymmetric.append(both);
        } else if let Some(plain) = described.get_mut(name) {
            parameters.insert(name.to_owned(), plain.take());
        }
    }
    if !asymmetric.is_empty() {
        parameters.insert("asymmetric".to_owned(), asymmetric.into());
    }
    let file = File { friction_observer: Node { parameters } };
    let yaml = serde_saphyr::to_string(&file).map_err(|error| ParametersError(error.to_string()))?;
    Ok(header(found) + &yaml)
}

/// Where it comes from, and how sure the chosen model's parameters are.
fn header(found: &FrictionIdentification) -> String {
    let mut text = format!("# Identified by frictionlab {} from", env!("CARGO_PKG_VERSION"));
    for file in &found.files {
        // A path must not end the comment it stands in. Writing to a string cannot fail.
        let path: String =
            file.path.display().to_string().chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        let _ = write!(text, " {path}");
    }
    text.push_str(".\n");
    if let Some(first) = found.chosen() {
        for estimate in &first.found.estimates.parameters {
            let (value, error) = wording::value(estimate);
            let plus = if error.is_empty() { String::new() } else { format!(" +- {error}") };
            let added = wording::from_drive(first, estimate);
            let plus = if added.is_empty() { plus } else { format!("{plus}, from the drive +- {added}") };
            let unit = if estimate.unit.is_empty() { String::new() } else { format!(" {}", estimate.unit) };
            let doubt = if estimate.is_identified() { "" } else { ", not identified by these recordings" };
            let _ = writeln!(text, "# {}.{}: {value}{plus}{unit}{doubt}", first.found.name, estimate.name);
        }
    }
    text
}
