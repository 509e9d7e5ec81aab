//! `cargo xtask bench-simulate`: points a second of `simulate`, beside Numba.
//!
//! Our side writes the whole table as text, into nothing; the peer fills three arrays. Both compute
//! the same motion as they go, with the same scheme, on one thread, in turns.

use std::path::Path;
use std::process::Command;
use std::{env, str};

use anyhow::{Context, Result, ensure};
use friction_ident::statistics::upper_median;
use serde::Deserialize;

use crate::python_env;

/// Options of `cargo xtask bench-simulate`.
#[derive(Debug, Clone, clap::Args)]
pub struct BenchSimulate {
    /// Points a turn.
    #[arg(long, default_value_t = 2_000_000, value_parser = clap::value_parser!(u32).range(1000..))]
    points: u32,
    /// Turns.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    turns: u32,
}

/// What a program says of a turn.
#[derive(Debug, Deserialize)]
struct Turn {
    points: u64,
    seconds: f64,
}

impl BenchSimulate {
    /// Runs both and prints the table.
    ///
    /// # Errors
    /// When a program cannot be built or run.
    pub fn run(&self) -> Result<()> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"))
            .parent()
            .context("xtask stands in the workspace")?;
        let python = python_env::scipy()?;
        let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let build =
            ["build", "--release", "--locked", "-p", "studies", "--example", "simulate_speed"];
        let built = Command::new(cargo).args(build).current_dir(root).status()?;
        ensure!(built.success(), "the simulation does not build");
        let ours = python_env::target()?.join("release/examples/simulate_speed");
        let script = root.join("tests/peers/simulate.py");
        let points = self.points.to_string();
        let (mut fast, mut peer) = (Vec::new(), Vec::new());
        for turn in 1..=self.turns {
            eprintln!("turn {turn} of {} ...", self.turns);
            fast.push(rate(Command::new(&ours).arg(&points))?);
            peer.push(rate(Command::new(&python).arg(&script).arg(&points))?);
        }
        let middle = |values: &mut Vec<f64>| upper_median(values).unwrap_or(f64::NAN);
        let (a, b) = (middle(&mut fast), middle(&mut peer));
        println!("| LuGre along a motion, one thread | million points a second |\n|---|---|");
        println!("| this program, with the table as text | {:.2} |", 1e-6 * a);
        println!("| Numba, into arrays | {:.2} |", 1e-6 * b);
        println!("{:.2} times Numba", a / b);
        Ok(())
    }
}

fn rate(command: &mut Command) -> Result<f64> {
    let output = command.output().with_context(|| format!("{command:?} does not start"))?;
    let said = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "{command:?} failed: {said}");
    let turn: Turn = serde_json::from_str(str::from_utf8(&output.stdout)?)?;
    Ok(turn.points as f64 / turn.seconds)
}
