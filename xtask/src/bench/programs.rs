//! The two programs: `friction_model/examples/step_bench.rs` and the C files in `xtask/bench/`.

use std::collections::BTreeMap;
use std::env;
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::str::FromStr;

use anyhow::{Context, Result, bail, ensure};
use friction_model::ModelName;

/// How a model is stepped. `friction_model/examples/step_bench.rs` explains them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Scheme {
    /// Fixed-step form.
    Exact,
    /// Classical Runge-Kutta.
    Rk4,
    /// Fixed-step form with the state in memory, of a model known at compile time.
    Known,
    /// The same, of a model chosen while the program runs.
    Chosen,
}

impl Scheme {
    const ALL: [(Self, &'static str); 4] = [
        (Self::Exact, "exact"),
        (Self::Rk4, "rk4"),
        (Self::Known, "known"),
        (Self::Chosen, "chosen"),
    ];
}

impl fmt::Display for Scheme {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (_, text) =
            Self::ALL.into_iter().find(|(scheme, _)| scheme == self).unwrap_or(Self::ALL[0]);
        f.pad(text)
    }
}

impl FromStr for Scheme {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let known = Self::ALL.into_iter().find(|(_, name)| *name == text);
        known.map(|(scheme, _)| scheme).with_context(|| format!("unknown scheme `{text}`"))
    }
}

/// One model and scheme in one run of one program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// Nanoseconds a step.
    pub nanoseconds: f64,
    /// Sum of all forces.
    pub sum: f64,
}

/// One run of one program for one model. Empty where C has no peer of the model.
pub type Run = BTreeMap<Scheme, Timing>;

/// Both programs, built for this processor.
#[derive(Debug)]
pub struct Programs {
    rust: PathBuf,
    c: PathBuf,
}

impl Programs {
    pub fn build() -> Result<Self> {
        let workspace = Path::new(env!("CARGO_MANIFEST_DIR"))
            .parent()
            .context("xtask lies in the workspace")?;
        // Its own target folder: other flags would rebuild everything in the shared one, to and
        // fro.
        let target = env::current_exe()?
            .ancestors()
            .nth(2)
            .context("xtask lies in a target folder")?
            .join("native");
        Ok(Self { rust: build_rust(workspace, &target)?, c: build_c(workspace, &target)? })
    }

    /// Runs both programs for `model`, one after the other.
    pub fn in_turns(&self, model: ModelName, steps: u64, rust_first: bool) -> Result<(Run, Run)> {
        if rust_first {
            let rust = once(&self.rust, model, steps)?;
            Ok((rust, once(&self.c, model, steps)?))
        } else {
            let c = once(&self.c, model, steps)?;
            Ok((once(&self.rust, model, steps)?, c))
        }
    }
}

fn once(program: &Path, model: ModelName, steps: u64) -> Result<Run> {
    let output = Command::new(program)
        .args([&steps.to_string(), model.as_str()])
        .output()
        .with_context(|| format!("starting {}", program.display()))?;
    ensure!(output.status.success(), "{} ended with {}", program.display(), output.status);
    parse(&String::from_utf8(output.stdout)?, model)
        .with_context(|| format!("output of {}", program.display()))
}

/// Lines of `model scheme nanoseconds sum`.
fn parse(text: &str, model: ModelName) -> Result<Run> {
    text.lines()
        .map(|line| {
            let [name, scheme, nanoseconds, sum] = line.split_whitespace().collect::<Vec<_>>()[..]
            else {
                bail!("expected `model scheme nanoseconds sum`, got `{line}`");
            };
            ensure!(name == model.as_str(), "asked for {model}, got `{line}`");
            Ok((scheme.parse()?, Timing { nanoseconds: nanoseconds.parse()?, sum: sum.parse()? }))
        })
        .collect()
}

fn build_rust(workspace: &Path, target: &Path) -> Result<PathBuf> {
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    succeed(
        Command::new(cargo)
            .args([
                "build",
                "--quiet",
                "--release",
                "--package",
                "friction_model",
                "--example",
                "step_bench",
            ])
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
    let folder = workspace.join("xtask/bench");
    let mut sources = fs::read_dir(&folder)
        .and_then(|files| {
            files.map(|file| file.map(|file| file.path())).collect::<Result<Vec<_>, _>>()
        })
        .with_context(|| format!("reading {}", folder.display()))?;
    sources.retain(|path| path.extension().is_some_and(|extension| extension == "c"));
    sources.sort();
    succeed(
        Command::new(compiler)
            .args(["-std=gnu11", "-O3", "-march=native", "-Wall", "-Wextra", "-o"])
            .arg(&program)
            .args(sources)
            .arg("-lm"),
    )
    .context("the C side needs a C compiler: install gcc, or name one in CC")?;
    Ok(program)
}

fn succeed(command: &mut Command) -> Result<()> {
    let status = command
        .status()
        .with_context(|| format!("starting {}", command.get_program().display()))?;
    ensure!(status.success(), "{} ended with {status}", command.get_program().display());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_parsed_or_refused() {
        let model = ModelName::LuGre;
        let run = parse("lugre rk4 1.5 -2e3\n", model).unwrap();
        assert_eq!(run, Run::from([(Scheme::Rk4, Timing { nanoseconds: 1.5, sum: -2e3 })]));
        assert!(parse("", model).unwrap().is_empty());
        assert!(parse("lugre rk4 1.5", model).unwrap_err().to_string().contains("`lugre rk4 1.5`"));
        assert!(parse("lugre euler 1.5 1", model).unwrap_err().to_string().contains("`euler`"));
        assert!(
            parse("dahl rk4 1.5 1", model).unwrap_err().to_string().contains("asked for lugre")
        );
        assert!(parse("lugre rk4 x 1", model).is_err());
    }
}
