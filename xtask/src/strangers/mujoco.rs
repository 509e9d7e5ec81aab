//! Axes that MuJoCo moves (`tests/peers/mujoco_axes.py`): friction of another maker, which sticks as
//! real friction does, under a position loop.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};
use serde::Deserialize;
use serde_json::json;

use super::Machine;
use super::judge::Known;
use crate::python_env;

/// An axis that was moved.
#[derive(Debug, Deserialize)]
pub struct Axis {
    pub number: u64,
    has: Vec<String>,
    #[serde(rename = "true")]
    pub known: Known,
}

impl From<&Axis> for Machine {
    fn from(axis: &Axis) -> Self {
        Self { friction: "mujoco".to_owned(), rate: axis.known.rate, has: axis.has.clone() }
    }
}

/// Records the axes of these numbers below a folder.
///
/// # Errors
/// When MuJoCo cannot be had or fails.
pub fn move_axes(numbers: &[u64], root: &Path) -> Result<Vec<Axis>> {
    let [python, _] = python_env::mujoco()?;
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/peers/mujoco_axes.py");
    let mut child =
        Command::new(python).arg(script).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
    let mut input = child.stdin.take().context("MuJoCo's Python reads nothing")?;
    input.write_all(json!({"numbers": numbers, "folder": root}).to_string().as_bytes())?;
    drop(input);
    let output = child.wait_with_output()?;
    ensure!(output.status.success(), "MuJoCo's Python failed");
    Ok(serde_json::from_slice(&output.stdout)?)
}
