//! `cargo xtask bench`: is a control step in Rust as fast as the same step in plain C?
//!
//! Both programs take the same velocities and parameters, time themselves (starting a process is not
//! counted), and print the sum of all forces: a comparison is only honest if both computed the same. They
//! run in turns, and what counts is the median of the ratios of neighbouring runs, because a machine's
//! speed drifts more over a minute than the two differ.

use std::collections::BTreeMap;
use std::env;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

/// Options of `cargo xtask bench`.
#[derive(Debug, Clone, clap::Args)]
pub struct Bench {
    /// Rounds; each runs both programs once.
    #[arg(long, default_value_t = 31, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    /// Steps of each model in one run.
    #[arg(long, default_value_t = 2_000_000, value_parser = clap::value_parser!(u64).range(10..))]
    steps: u64,
    /// Largest accepted ratio of Rust's time to C's.
    #[arg(long, default_value_t = 1.2)]
    bar: f64,
}

/// One model in one run of one program.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Timing {
    nanoseconds: f64,
    sum: f64,
}

type Run = BTreeMap<String, Timing>;

impl Bench {
    /// Builds both programs for this processor, runs them in turns and prints the table.
    ///
    /// # Errors
    /// When a program cannot be built or run, when the sums of forces differ, or when a ratio is above the bar.
    pub fn run(&self) -> Result<()> {
        let workspace =
            Path::new(env!("CARGO_MANIFEST_DIR")).parent().context("xtask lies in the workspace")?;
        // Its own target folder: other flags would rebuild everything in the shared one, to and fro.
        let target =
            env::current_exe()?.ancestors().nth(2).context("xtask lies in a target folder")?.join("native");
        let rust = build_rust(workspace, &target)?;
        let c = build_c(workspace, &target)?;

        let mut out = std::io::stdout().lock();
        writeln!(out, "{} rounds of {} steps a model, Rust and C in turns ...", self.rounds, self.steps)?;
        let mut rounds = Vec::new();
        for round in 0..self.rounds {
            // Who goes first changes, so that neither always finds the warmer machine.
            let pair = if round % 2 == 0 {
                let first = self.once(&rust)?;
                (first, self.once(&c)?)
            } else {
                let first = self.once(&c)?;
                (self.once(&rust)?, first)
            };
            rounds.push(pair);
        }
        let rows = compare(&rounds)?;
        writeln!(out, "{}", Row::HEAD)?;
        for row in &rows {
            writeln!(out, "{}", row.line(self.bar))?;
        }
        let slow: Vec<&str> =
            rows.iter().filter(|r| r.ratio[1] > self.bar).map(|r| r.model.as_str()).collect();
        ensure!(slow.is_empty(), "slower than {} times C: {}", self.bar, slow.join(", "));
        Ok(())
    }

    fn once(&self, program: &Path) -> Result<Run> {
        let output = Command::new(program)
            .arg(self.steps.to_string())
            .output()
            .with_context(|| format!("starting {}", program.display()))?;
        ensure!(output.status.success(), "{} ended with {}", program.display(), output.status);
        parse(&String::from_utf8(output.stdout)?).with_context(|| format!("output of {}", program.display()))
    }
}

fn build_rust(workspace: &Path, target: &Path) -> Result<PathBuf> {
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    succeed(
        Command::new(cargo)
            .args(["build", "--quiet", "--release", "--package", "friction_model", "--example", "step_bench"])
            .arg("--target-dir")
            .arg(target)
            .current_dir(workspace)
            .env_remove("CARGO_ENCODED_RUSTFLAGS")
            .env("RUSTFLAGS", "-C target-cpu=native"),
    )?;
    Ok(target.join("release/examples/step_bench"))
}

fn build_c(workspace: &Path, target: &Path) -> Result<PathBuf> {
    let program = target.join("peer");
    let compiler = env::var_os("CC").unwrap_or_else(|| "gcc".into());
    succeed(
        Command::new(compiler)
            .args(["-std=gnu11", "-O3", "-march=native", "-Wall", "-Wextra", "-o"])
            .arg(&program)
            .arg(workspace.join("xtask/bench/peer.c"))
            .arg("-lm"),
    )
    .context("the C side needs a C compiler: install gcc, or name one in CC")?;
    Ok(program)
}

fn succeed(command: &mut Command) -> Result<()> {
    let status = command.status().with_context(|| format!("starting {}", command.get_program().display()))?;
    ensure!(status.success(), "{} ended with {status}", command.get_program().display());
    Ok(())
}

/// Lines of `model nanoseconds sum`.
fn parse(text: &str) -> Result<Run> {
    text.lines()
        .map(|line| {
            let [model, nanoseconds, sum] = line.split_whitespace().collect::<Vec<_>>()[..] else {
                bail!("expected `model nanoseconds sum`, got `{line}`");
            };
            Ok((model.to_owned(), Timing { nanoseconds: nanoseconds.parse()?, sum: sum.parse()? }))
        })
        .collect()
}

/// One line of the table: quartiles over the rounds.
#[derive(Debug, PartialEq)]
struct Row {
    model: String,
    rust: [f64; 3],
    c: [f64; 3],
    ratio: [f64; 3],
    /// Relative difference of the sums of forces.
    difference: f64,
}

impl Row {
    const HEAD: &str = "model      Rust [ns/step]        C [ns/step]           Rust / C               sums differ by\n\
                        ---------- --------------------- --------------------- ---------------------- --------------";

    fn line(&self, bar: f64) -> String {
        let spread = |q: &[f64; 3], digits: usize| {
            format!("{:.*} ({:.*} .. {:.*})", digits, q[1], digits, q[0], digits, q[2])
        };
        format!(
            "{:<10} {:<21} {:<21} {:<22} {:<8.1e} {}",
            self.model,
            spread(&self.rust, 2),
            spread(&self.c, 2),
            spread(&self.ratio, 3),
            self.difference,
            if self.ratio[1] <= bar { "within the bar" } else { "ABOVE THE BAR" },
        )
    }
}

/// The table, medians and quartiles of pairs of runs (Rust, C).
fn compare(rounds: &[(Run, Run)]) -> Result<Vec<Row>> {
    let (first, _) = rounds.first().context("no rounds")?;
    first
        .keys()
        .map(|model| {
            let pairs: Vec<(Timing, Timing)> = rounds
                .iter()
                .map(|(rust, c)| Ok((*rust.get(model).context("Rust")?, *c.get(model).context("C")?)))
                .collect::<Result<_>>()
                .with_context(|| format!("a run lacks {model}"))?;
            let difference = pairs
                .iter()
                .map(|(rust, c)| ((rust.sum - c.sum) / c.sum).abs())
                .fold(0.0, |worst: f64, d| if d.is_nan() { f64::INFINITY } else { worst.max(d) });
            ensure!(
                difference <= 1e-9,
                "{model}: the sums of forces differ by {difference:.1e}; the two sides do not compute the same"
            );
            let over = |f: &dyn Fn(&(Timing, Timing)) -> f64| quartiles(pairs.iter().map(f).collect());
            Ok(Row {
                model: model.clone(),
                rust: over(&|(rust, _)| rust.nanoseconds),
                c: over(&|(_, c)| c.nanoseconds),
                ratio: over(&|(rust, c)| rust.nanoseconds / c.nanoseconds),
                difference,
            })
        })
        .collect()
}

/// First quartile, median and third quartile, interpolated; `values` is not empty.
fn quartiles(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    [0.25, 0.5, 0.75].map(|q| {
        let place = q * (values.len() - 1) as f64;
        let (below, above) = (values[place.floor() as usize], values[place.ceil() as usize]);
        below + (above - below) * place.fract()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(nanoseconds: f64, sum: f64) -> Run {
        BTreeMap::from([("m".to_owned(), Timing { nanoseconds, sum })])
    }

    #[test]
    fn medians_and_quartiles() {
        assert_eq!(quartiles(vec![3.0, 1.0, 2.0, 5.0, 4.0]), [2.0, 3.0, 4.0]);
        assert_eq!(quartiles(vec![1.0, 2.0]), [1.25, 1.5, 1.75]);
        assert_eq!(quartiles(vec![7.0]), [7.0; 3]);
    }

    #[test]
    fn the_ratio_is_the_median_over_rounds() {
        // One disturbed round does not matter.
        let rounds = [
            (run(11.0, 1.0), run(10.0, 1.0)),
            (run(22.0, 1.0), run(20.0, 1.0)),
            (run(90.0, 1.0), run(10.0, 1.0)),
        ];
        let rows = compare(&rounds).unwrap();
        assert!((rows[0].ratio[1] - 1.1).abs() < 1e-12);
    }

    #[test]
    fn different_sums_are_no_comparison() {
        let message = compare(&[(run(1.0, 1.0), run(1.0, 1.0 + 1e-8))]).unwrap_err().to_string();
        assert!(message.contains("do not compute the same"), "{message}");
        assert!(compare(&[(run(1.0, f64::NAN), run(1.0, 1.0))]).is_err());
        assert!(compare(&[(run(1.0, 1.0), run(1.0, 1.0 + 1e-10))]).is_ok());
    }

    #[test]
    fn lines_are_parsed_or_refused() {
        assert_eq!(parse("m 1.5 -2e3\n").unwrap(), run(1.5, -2e3));
        assert!(parse("m 1.5").unwrap_err().to_string().contains("`m 1.5`"));
        assert!(parse("m x 1").is_err());
    }
}
