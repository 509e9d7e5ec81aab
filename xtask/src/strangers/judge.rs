//! What the program said of a machine, beside what is true of it.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use anyhow::{Context, Result, ensure};
use friction_ident::information::or_nan;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::machine::Truth;

/// A parameter of which the truth is known.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Judged {
    pub name: String,
    pub truth: f64,
    #[serde(deserialize_with = "or_nan")]
    pub value: f64,
    /// Its 95 % interval.
    pub interval: Option<[f64; 2]>,
    pub identified: bool,
    /// Further from the truth than this share of it counts as far.
    far: f64,
}

impl Judged {
    pub fn within(&self) -> bool {
        self.interval.is_some_and(|[low, high]| (low..=high).contains(&self.truth))
    }

    /// Said to be identified, outside its interval, and far from the truth.
    pub fn wrong(&self) -> bool {
        self.identified && !self.within() && (self.value - self.truth).abs() > self.far
    }
}

/// How far from the truth a number may lie before it is wrong, as a share of it.
const FAR: f64 = 0.1;

/// What is known of a machine. SI units.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Known {
    pub inertia: f64,
    pub f_c: f64,
    pub f_v: f64,
    /// None where it cannot be told from what else acts.
    pub offset: Option<f64>,
    /// Sampling rate \[Hz\].
    pub rate: f64,
}

impl From<&Truth> for Known {
    fn from(truth: &Truth) -> Self {
        let Truth { inertia, f_c, f_v, offset, rate, .. } = *truth;
        Self { inertia, f_c, f_v, offset: Some(offset), rate }
    }
}

/// What the program said.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Answer {
    /// Its sentence, where it refused.
    pub refused: Option<String>,
    /// An option that it named, and that was then given.
    pub resampled: bool,
    pub chosen: String,
    pub warnings: Vec<String>,
    pub parameters: Vec<Judged>,
    /// Relative error of the torque in the part kept back \[%\].
    pub held_out: Option<f64>,
    /// Stretches of the part kept back that the error was taken over \[s\].
    pub stretches: Value,
    /// Conditioning, for the peer: cutoff_hz, acceleration_cutoff_hz, order, trim, decimate, and in
    /// `elsewhere` the same of the part kept back.
    pub settings: Value,
}

impl Answer {
    /// Numbers that are wrong although no warning was given.
    pub fn wrong(&self) -> usize {
        if !self.warnings.is_empty() {
            return 0;
        }
        self.parameters.iter().filter(|judged| judged.wrong()).count()
    }
}

/// Lets the program identify the recording in `folder`, as a stranger would: with what it offers by
/// itself, and with the option that its refusal names.
///
/// # Errors
/// When the program cannot be run or its results cannot be read.
pub fn ask(program: &Path, folder: &Path, truth: &Known, options: &[&str]) -> Result<Answer> {
    let run = |more: &[String]| -> Result<Output> {
        Command::new(program)
            .current_dir(folder)
            .args([
                "identify",
                "estimation.csv",
                "--validate",
                "validation.csv",
                "--axis",
                "rotary",
            ])
            .args(["--out", "answer", "--force", "--quiet"])
            .args(options)
            .args(more)
            .output()
            .with_context(|| format!("{} does not start", program.display()))
    };
    let mut answer = Answer {
        refused: None,
        resampled: false,
        chosen: String::new(),
        warnings: vec![],
        parameters: vec![],
        held_out: None,
        stretches: Value::Null,
        settings: Value::Null,
    };
    let mut output = run(&[])?;
    let said = |output: &Output| String::from_utf8_lossy(&output.stderr).trim().to_owned();
    if !output.status.success() && said(&output).contains("--resample") {
        answer.resampled = true;
        output = run(&["--resample".to_owned(), truth.rate.to_string()])?;
    }
    if !output.status.success() {
        ensure!(output.status.code() == Some(2), "it failed: {}", said(&output));
        answer.refused = Some(said(&output));
        return Ok(answer);
    }
    let document = fs::read_to_string(folder.join("answer/identification.json"))?;
    let document: Value = serde_json::from_str(&document)?;
    answer.settings = document["settings"].clone();
    answer.settings["elsewhere"] = document["validation_settings"].clone();
    let texts = |value: &Value| -> Vec<String> {
        value
            .as_array()
            .into_iter()
            .flatten()
            .filter_map(Value::as_str)
            .map(str::to_owned)
            .collect()
    };
    answer.warnings = texts(&document["warnings"]);
    let structure = &document["structure"];
    if structure.is_object() {
        // What is said of the plain models is no warning of the structure.
        let of_plain = |text: &String| {
            text.starts_with("The symmetric model") || text.starts_with("The asymmetric model")
        };
        answer.warnings.retain(|text| !of_plain(text));
    }
    answer.warnings.extend(texts(&structure["warnings"]));
    answer.chosen = structure["chosen"].as_str().unwrap_or("symmetric").to_owned();
    if structure.is_object() {
        answer.held_out = structure["cross_test_relative_error_percent"].as_f64();
        answer.stretches = structure["cross_test_stretches_s"].clone();
        answer.parameters = of_structure(&structure["parameters"]["parameters"], truth);
    } else {
        let model = &document["symmetric"];
        answer.held_out = model["cross_test"]["relative_error_percent"].as_f64();
        answer.parameters = of_model(&model["parameters"], truth);
    }
    Ok(answer)
}

fn known(truth: &Known) -> Vec<(&'static str, f64, f64)> {
    let size = truth.f_c;
    let mut known = vec![
        ("inertia", truth.inertia, FAR * truth.inertia),
        ("f_v", truth.f_v, FAR * truth.f_v),
        ("f_c", size, FAR * size),
    ];
    known.extend(truth.offset.map(|offset| ("offset", offset, FAR * size)));
    known
}

/// Each known parameter of a structure, of both directions where it has two.
fn of_structure(parameters: &Value, truth: &Known) -> Vec<Judged> {
    let mut judged = Vec::new();
    for parameter in parameters.as_array().into_iter().flatten() {
        let name = parameter["name"].as_str().unwrap_or_default();
        let same = |known: &str| {
            name == known || name.strip_prefix(known).is_some_and(|side| side.starts_with('.'))
        };
        let Some((known, level, far)) = known(truth).into_iter().find(|(known, ..)| same(known))
        else {
            continue;
        };
        // Of one direction, friction is with what pushes there all the time.
        let truth = match name {
            "f_c.forward" => level + truth.offset.unwrap_or(0.0),
            "f_c.backward" => level - truth.offset.unwrap_or(0.0),
            _ => level,
        };
        let name = known.to_owned();
        let bound = |which: &str| parameter["interval"][which].as_f64();
        judged.push(Judged {
            name,
            truth,
            value: parameter["value"].as_f64().unwrap_or(f64::NAN),
            interval: bound("low").zip(bound("high")).map(|(low, high)| [low, high]),
            identified: parameter["verdict"] == "identified",
            far,
        });
    }
    judged
}

/// Each known parameter of the plain model.
fn of_model(parameters: &Value, truth: &Known) -> Vec<Judged> {
    let names =
        [("inertia", "inertia"), ("f_v", "viscous"), ("f_c", "coulomb"), ("offset", "offset")];
    let mut judged = Vec::new();
    for (name, truth, far) in known(truth) {
        let called =
            names.iter().find(|(known, _)| *known == name).map_or(name, |(_, called)| called);
        let parameter = &parameters[called];
        let Some(value) = parameter["value"].as_f64() else { continue };
        let interval = match (&parameter["interval"], parameter["standard_error"].as_f64()) {
            (Value::Object(interval), _) => interval["low"].as_f64().zip(interval["high"].as_f64()),
            (_, error) => error.map(|error| (value - 1.96 * error, value + 1.96 * error)),
        };
        judged.push(Judged {
            name: name.to_owned(),
            truth,
            value,
            interval: interval.map(|(low, high)| [low, high]),
            identified: parameter["identifiable"] == true,
            far,
        });
    }
    judged
}
