//! What SciPy makes of the same halves (`tests/peers/plain_fits.py`).

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};
use serde_json::{Map, Value};

use crate::python_env;

/// Errors of each of the peer's models, one answer for each job.
///
/// # Errors
/// When the peer cannot be made ready, fails, or answers nothing that can be read.
pub fn errors(jobs: &[Map<String, Value>]) -> Result<Vec<Map<String, Value>>> {
    if jobs.is_empty() {
        return Ok(Vec::new());
    }
    let python = python_env::scipy()?;
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/peers/plain_fits.py");
    eprintln!("SciPy ...");
    let mut child = Command::new(python)
        .arg(script)
        .envs(["OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"].map(|name| (name, "1")))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()?;
    let mut input = child.stdin.take().context("the peer reads nothing")?;
    input.write_all(serde_json::to_string(jobs)?.as_bytes())?;
    drop(input);
    let output = child.wait_with_output()?;
    ensure!(output.status.success(), "the peer failed");
    let errors: Vec<Map<String, Value>> = serde_json::from_slice(&output.stdout)?;
    ensure!(errors.len() == jobs.len(), "the peer answered {} of {}", errors.len(), jobs.len());
    Ok(errors)
}

/// The best of the peer's models, with its error \[%\].
pub fn best(errors: &Map<String, Value>) -> Option<(&str, f64)> {
    errors
        .iter()
        .filter_map(|(name, error)| Some((name.as_str(), error.as_f64()?)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
}
