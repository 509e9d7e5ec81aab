//! What the program says of a file: every model with its parameters, and what it warns of.

use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, ensure};
use serde::Serialize;
use serde_json::Value;

/// A parameter as the program tells it.
#[derive(Debug, Clone, Serialize)]
pub struct Told {
    pub name: String,
    pub value: f64,
    /// Its 95 % interval; none where there is none.
    pub interval: Option<[f64; 2]>,
    pub identified: bool,
}

/// A model as the program tells it.
#[derive(Debug, Clone, Serialize)]
pub struct Model {
    /// `symmetric`, `asymmetric`, `structure`, or `servo`.
    pub kind: &'static str,
    /// What it has.
    pub name: String,
    pub parameters: Vec<Told>,
    /// Why it is not to be trusted as a whole.
    pub warnings: Vec<String>,
}

/// What the program says.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Said {
    /// Its sentence, where it refused.
    pub refused: Option<String>,
    pub models: Vec<Model>,
    /// Relative error of the torque of the other file \[%\], and the stretches it was taken over.
    pub held_out: Option<f64>,
    pub stretches: Value,
    /// Conditioning, for the peer.
    pub settings: Value,
}

impl Said {
    /// The model that the program recommends: the structure that it chose, else the plain one.
    pub fn chosen(&self) -> Option<&Model> {
        let structure = self.models.iter().find(|model| model.kind == "structure");
        structure.or_else(|| self.models.first())
    }
}

/// Lets the program identify a file in `folder`, and try what it finds on another one if there is one.
///
/// # Errors
/// When the program cannot be run, fails without a refusal, or its results cannot be read.
pub fn identify(
    program: &Path,
    folder: &Path,
    files: [Option<&str>; 2],
    options: &[&str],
) -> Result<Said> {
    let [file, other] = files;
    let validate = other.map(|other| ["--validate", other]);
    let output = Command::new(program)
        .current_dir(folder)
        .arg("identify")
        .args(file)
        .args(validate.into_iter().flatten())
        .args(["--out", "answer", "--force", "--quiet"])
        .args(options)
        .output()
        .with_context(|| format!("{} does not start", program.display()))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
        ensure!(output.status.code() == Some(2), "it failed: {said}");
        return Ok(Said { refused: Some(said), ..Said::default() });
    }
    let document = fs::read_to_string(folder.join("answer/identification.json"))?;
    Ok(read(&serde_json::from_str(&document)?))
}

fn texts(value: &Value) -> Vec<String> {
    let all = value.as_array().into_iter().flatten();
    all.filter_map(Value::as_str).map(str::to_owned).collect()
}

fn read(document: &Value) -> Said {
    let warnings = texts(&document["warnings"]);
    // What a sentence names is meant; what names no model is meant for all.
    let of = |model: &str| format!("The {model} model ");
    let named = |text: &String| {
        text.starts_with("The structure ")
            || ["symmetric", "asymmetric"].iter().any(|model| text.starts_with(&of(model)))
    };
    let of_all: Vec<String> = warnings.iter().filter(|text| !named(text)).cloned().collect();
    let mut models = Vec::new();
    for kind in ["symmetric", "asymmetric"] {
        let Value::Object(parameters) = &document[kind]["parameters"] else { continue };
        let parameters = parameters.iter().map(|(name, told)| plain(name, told)).collect();
        let own = warnings.iter().filter(|text| text.starts_with(&of(kind))).cloned();
        let warnings = of_all.iter().cloned().chain(own).collect();
        models.push(Model { kind, name: kind.to_owned(), parameters, warnings });
    }
    let structure = &document["structure"];
    if let Value::Array(parameters) = &structure["parameters"]["parameters"] {
        let own = texts(&structure["warnings"]);
        models.push(Model {
            kind: "structure",
            name: structure["chosen"].as_str().unwrap_or_default().to_owned(),
            parameters: parameters.iter().map(estimate).collect(),
            warnings: of_all.iter().cloned().chain(own).collect(),
        });
    }
    let held_out = match structure {
        Value::Object(_) => &structure["cross_test_relative_error_percent"],
        _ => &document["symmetric"]["cross_test"]["relative_error_percent"],
    };
    Said {
        refused: None,
        models,
        held_out: held_out.as_f64(),
        stretches: structure["cross_test_stretches_s"].clone(),
        settings: document["settings"].clone(),
    }
}

fn plain(name: &str, told: &Value) -> Told {
    let value = told["value"].as_f64().unwrap_or(f64::NAN);
    let half = told["half_width_95"].as_f64();
    Told {
        name: name.to_owned(),
        value,
        interval: half.map(|half| [value - half, value + half]),
        identified: told["identifiable"] == true,
    }
}

/// An estimate as documents have it.
pub fn estimate(told: &Value) -> Told {
    let bound = |which: &str| told["interval"][which].as_f64();
    Told {
        name: told["name"].as_str().unwrap_or_default().to_owned(),
        value: told["value"].as_f64().unwrap_or(f64::NAN),
        interval: bound("low").zip(bound("high")).map(|(low, high)| [low, high]),
        identified: told["verdict"] == "identified",
    }
}
