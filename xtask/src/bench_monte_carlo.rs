//! `cargo xtask bench-monte-carlo`: is the Monte Carlo of position tracking as fast as a loop that
//! Numba compiled, and are its figures the same?
//!
//! Both sides simulate the proposed plant with the same steps, sensors, controller, observer and
//! errors on one thread each, in turns. Their random numbers differ, so that the mean squares agree
//! as distributions: the medians within four standard errors, and those of the linear controller
//! alone, which hardly scatter, within 1 %.

use std::path::Path;
use std::process::Command;
use std::{env, str};

use anyhow::{Context, Result, ensure};
use friction_ident::statistics::{quantile, sorted};
use serde::Deserialize;

use crate::python_env;

/// Options of `cargo xtask bench-monte-carlo`.
#[derive(Debug, Clone, clap::Args)]
pub struct BenchMonteCarlo {
    /// Draws a turn.
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u32).range(20..))]
    draws: u32,
    /// Turns.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    turns: u32,
}

/// What a program says of a turn.
#[derive(Debug, Deserialize)]
struct Turn {
    draws: u32,
    seconds: f64,
    alone: Vec<f64>,
    compensated: Vec<f64>,
}

/// All turns of a program.
#[derive(Debug, Default)]
struct Side {
    /// Draws a second of each turn.
    speed: Vec<f64>,
    alone: Vec<f64>,
    compensated: Vec<f64>,
}

impl Side {
    fn add(&mut self, turn: Turn) {
        self.speed.push(f64::from(turn.draws) / turn.seconds);
        self.alone.extend(turn.alone);
        self.compensated.extend(turn.compensated);
    }
}

impl BenchMonteCarlo {
    /// Runs both and prints the table.
    ///
    /// # Errors
    /// When a program cannot be built or run, or when the two do not agree.
    pub fn run(&self) -> Result<()> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"))
            .parent()
            .context("xtask stands in the workspace")?;
        let target = env::var_os("CARGO_TARGET_DIR")
            .map_or_else(|| root.join("target"), |dir| root.join(dir));
        let python = python_env::scipy()?;
        let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let package = ["build", "--release", "--locked", "-p", "studies"];
        let example = ["--example", "monte_carlo_speed"];
        ensure!(
            Command::new(cargo).args(package).args(example).current_dir(root).status()?.success(),
            "the Monte Carlo does not build"
        );
        let (mut ours, mut theirs) = (Side::default(), Side::default());
        for seed in 1..=self.turns {
            eprintln!("turn {seed} of {} ...", self.turns);
            let arguments = [self.draws.to_string(), seed.to_string()];
            ours.add(turn(
                Command::new(target.join("release/examples/monte_carlo_speed")).args(&arguments),
            )?);
            let script = root.join("tests/peers/monte_carlo.py");
            theirs.add(turn(Command::new(&python).arg(script).args(&arguments))?);
        }
        let (a, b) = (percentile(&ours.speed, 0.5), percentile(&theirs.speed, 0.5));
        println!(
            "| position tracking, alone and compensated | draws a second | median mse alone | median mse compensated |"
        );
        println!("|---|---|---|---|");
        for (name, speed, side) in [("this program", a, &ours), ("Numba", b, &theirs)] {
            let (alone, compensated) =
                (percentile(&side.alone, 0.5), percentile(&side.compensated, 0.5));
            println!("| {name} | {speed:.0} | {alone:.4e} | {compensated:.4e} |");
        }
        println!("{:.2} times as fast as Numba, one thread each", a / b);
        agree("alone", &ours.alone, &theirs.alone, 0.01)?;
        agree("compensated", &ours.compensated, &theirs.compensated, 0.0)
    }
}

/// The medians lie within four standard errors of one another, or within the fraction `close`.
fn agree(what: &str, ours: &[f64], theirs: &[f64], close: f64) -> Result<()> {
    let (a, b) = (percentile(ours, 0.5), percentile(theirs, 0.5));
    let error = median_error(ours).hypot(median_error(theirs));
    ensure!(
        (a - b).abs() <= (4.0 * error).max(close * b),
        "{what}: the medians {a:e} and {b:e} differ by more than four standard errors of {error:e}: the two do not simulate the same"
    );
    Ok(())
}

/// Standard error of the median without assuming a distribution: half the distance of the order
/// statistics one binomial standard deviation to each side.
fn median_error(values: &[f64]) -> f64 {
    let half = 0.5 / (values.len() as f64).sqrt();
    0.5 * (percentile(values, 0.5 + half) - percentile(values, 0.5 - half))
}

fn percentile(values: &[f64], share: f64) -> f64 {
    quantile(&sorted(values.iter().copied()), share).unwrap_or(f64::NAN)
}

fn turn(command: &mut Command) -> Result<Turn> {
    let output = command.output().with_context(|| format!("{command:?} does not start"))?;
    ensure!(
        output.status.success(),
        "{command:?} failed: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    let text = str::from_utf8(&output.stdout)?;
    serde_json::from_str(text).with_context(|| format!("not a turn: {text}"))
}
