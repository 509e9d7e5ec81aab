//! Logs of servos, fitted by `frictionlab identify-servo` from two disjoint sets of logs.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use super::Halved;
use super::pairs;
use super::said::{self, Said};

/// A short search, so that a servo takes half a minute.
const SEARCH: [&str; 4] = ["--seeds", "3", "--evaluations", "10000"];

/// Both sets of logs of each servo whose name begins with `only`.
///
/// # Errors
/// When a log cannot be read, or the program cannot be run.
pub fn halved(program: &Path, data: &Path, root: &Path, only: &str) -> Result<Vec<Halved>> {
    let mut all = Vec::new();
    for servo in ["xl330", "sts3215"] {
        let folder = data.join(servo);
        if !folder.is_dir() || !format!("{servo} logs").starts_with(only) {
            continue;
        }
        eprintln!("{servo} ...");
        let mut halves = Vec::new();
        for (logs, half) in dealt_out(&folder)?.iter().zip(["first", "second"]) {
            let out = root.join(format!("{servo}_{half}"));
            halves.push(identify(program, logs, &out)?);
        }
        let pairs = match &halves[..] {
            [first, second] => pairs::pairs(first, second),
            _ => vec![],
        };
        let recording = format!("{servo} logs");
        all.push(Halved { recording, split: "logs dealt out", halves, pairs });
    }
    Ok(all)
}

/// The logs in two sets that hold every motion, mass and gain: as the fields of a chessboard.
fn dealt_out(folder: &Path) -> Result<[Vec<PathBuf>; 2]> {
    let mut logs = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let text = fs::read_to_string(&path)?;
        let log: Value = serde_json::from_str(&text).with_context(|| path.display().to_string())?;
        let facts = ["trajectory", "mass", "kp"].map(|fact| log[fact].to_string());
        logs.push((path, facts));
    }
    logs.sort();
    let mut places = [const { BTreeMap::new() }; 3];
    for (place, fact) in logs.iter().flat_map(|(_, facts)| facts.iter().enumerate()) {
        let known = places[place].len();
        places[place].entry(fact.clone()).or_insert(known);
    }
    let mut sets = [vec![], vec![]];
    for (path, facts) in logs {
        let field: usize = facts.iter().zip(&places).map(|(fact, known)| known[fact]).sum();
        sets[field % 2].push(path);
    }
    Ok(sets)
}

fn identify(program: &Path, logs: &[PathBuf], out: &Path) -> Result<Said> {
    let output = Command::new(program)
        .arg("identify-servo")
        .args(logs)
        .args(SEARCH)
        .arg("--out")
        .arg(out)
        .args(["--force", "--quiet"])
        .output()
        .with_context(|| format!("{} does not start", program.display()))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
        ensure!(output.status.code() == Some(2), "it failed: {said}");
        return Ok(Said { refused: Some(said), ..Said::default() });
    }
    let document: Value = serde_json::from_str(&fs::read_to_string(out.join("servo.json"))?)?;
    let parameters = document["parameters"].as_array().into_iter().flatten();
    let model = said::Model {
        kind: "servo",
        name: document["level"].as_str().unwrap_or_default().to_owned(),
        parameters: parameters.map(said::estimate).collect(),
        warnings: document["failure"].as_str().map(str::to_owned).into_iter().collect(),
    };
    Ok(Said { models: vec![model], ..Said::default() })
}
