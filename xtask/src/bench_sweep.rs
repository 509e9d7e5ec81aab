//! `cargo xtask bench-sweep`: many parameter sets of a model along one motion, in lanes beside the
//! scalar step, and on all cores beside Numba's `prange`.
//!
//! All compute the same sets with the same scheme into an array that is there already, and print the
//! sum of all forces, which must agree. They run in turns; what counts is the median of the ratios
//! of a turn. One thread is measured in processor time, several in wall time.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::{env, fs, str, thread};

use anyhow::{Context, Result, ensure};
use friction_ident::statistics::upper_median;
use serde::Deserialize;

use crate::python_env;

/// Options of `cargo xtask bench-sweep`.
#[derive(Debug, Clone, clap::Args)]
pub struct BenchSweep {
    /// Parameter sets.
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..))]
    sets: u32,
    /// Samples of the motion.
    #[arg(long, default_value_t = 5000, value_parser = clap::value_parser!(u32).range(10..))]
    samples: u32,
    /// Turns.
    #[arg(long, default_value_t = 7, value_parser = clap::value_parser!(u32).range(1..))]
    turns: u32,
    /// Least accepted ratio of the scalar step's time to that of the lanes, on one core.
    #[arg(long, default_value_t = 3.0)]
    bar: f64,
    /// Least accepted ratio of Numba's time to ours, on all cores.
    #[arg(long, default_value_t = 5.0)]
    bar_numba: f64,
}

/// What a program says of a model.
#[derive(Debug, Deserialize)]
struct Said {
    model: String,
    scheme: String,
    way: String,
    nanoseconds: f64,
    sum: f64,
}

/// Nanoseconds a step of each turn, by model, scheme and way.
type Times = BTreeMap<(String, String, String), Vec<f64>>;

impl BenchSweep {
    /// Runs both and prints the table.
    ///
    /// # Errors
    /// When a program cannot be built or run, when the sums of forces differ, or when a ratio is
    /// below its bar.
    pub fn run(&self) -> Result<()> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"))
            .parent()
            .context("xtask stands in the workspace")?;
        let python = python_env::scipy()?;
        let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let build =
            ["build", "--release", "--locked", "-p", "friction_lanes", "--example", "sweep_speed"];
        let built = Command::new(cargo).args(build).current_dir(root).status()?;
        ensure!(built.success(), "the lanes do not build");
        let target = python_env::target()?;
        let ours = target.join("release/examples/sweep_speed");
        let [sets, samples] = [self.sets, self.samples].map(|number| number.to_string());
        let threads = thread::available_parallelism()?.to_string();
        let file = target.join("bench-sweep.jsonl");
        fs::write(&file, output(Command::new(&ours).args(["--sets", &sets]))?)?;

        let (mut times, mut sums) = (Times::new(), BTreeMap::new());
        for turn in 1..=self.turns {
            eprintln!("turn {turn} of {} ...", self.turns);
            let mut peer = Command::new(&python);
            peer.arg(root.join("tests/peers/sweep.py")).arg(&file).args([&samples, &threads]);
            let lanes = output(Command::new(&ours).args([&sets, &samples, &threads]))?;
            let numba = output(&mut peer)?;
            for line in lanes.lines().chain(numba.lines()) {
                let said: Said = serde_json::from_str(line).context(line.to_owned())?;
                let sum =
                    *sums.entry((said.model.clone(), said.scheme.clone())).or_insert(said.sum);
                ensure!(
                    (said.sum / sum - 1.0).abs() < 1e-9,
                    "{}, {}: the sums of forces {} and {sum} differ",
                    said.model,
                    said.way,
                    said.sum
                );
                times
                    .entry((said.model, said.scheme, said.way))
                    .or_default()
                    .push(said.nanoseconds);
            }
        }
        let slow = self.table(&times)?;
        ensure!(slow.is_empty(), "{}", slow.join("; "));
        Ok(())
    }

    /// Prints the table; gives the ratios that are below their bars.
    fn table(&self, times: &Times) -> Result<Vec<String>> {
        println!(
            "| model | scheme | scalar [ns] | lanes [ns] | times faster | Numba, one core [ns] | times faster | all cores [ns] | Numba's `prange` [ns] | times faster |"
        );
        println!("|---|---|---|---|---|---|---|---|---|---|");
        let mut slow = Vec::new();
        for model in ["lugre", "gms", "xiong", "proposed"] {
            for scheme in ["held", "mean"] {
                let of = |way: &str| times.get(&(model.into(), scheme.into(), way.into()));
                let pair = |ours: &str, theirs: &str| {
                    let (ours, theirs) = (of(ours)?, of(theirs)?);
                    let mut ratios: Vec<_> = ours.iter().zip(theirs).map(|(a, b)| b / a).collect();
                    Some([median(ours), median(theirs), upper_median(&mut ratios)?])
                };
                let [lanes, scalar, core] = pair("lanes", "scalar").context("no lanes")?;
                let mut row =
                    format!("| {model} | {scheme} | {scalar:.2} | {lanes:.2} | {core:.1} |");
                if core < self.bar {
                    slow.push(format!("{model}, {scheme}: {core:.1} times the scalar step"));
                }
                if let (Some([_, one, ratio]), Some([ours, numba, all])) =
                    (pair("lanes", "one"), pair("threads", "prange"))
                {
                    row += &format!(" {one:.2} | {ratio:.1} | {ours:.2} | {numba:.2} | {all:.1} |");
                    if all < self.bar_numba {
                        slow.push(format!("{model}, {scheme}: {all:.1} times Numba"));
                    }
                } else {
                    let ours = of("threads").context("no threads")?;
                    row += &format!(" | | {:.2} | | |", median(ours));
                }
                println!("{row}");
            }
        }
        Ok(slow)
    }
}

fn median(values: &[f64]) -> f64 {
    upper_median(&mut values.to_vec()).unwrap_or(f64::NAN)
}

fn output(command: &mut Command) -> Result<String> {
    let output = command.output().with_context(|| format!("{command:?} does not start"))?;
    let said = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "{command:?} failed: {said}");
    Ok(String::from_utf8(output.stdout)?)
}
