//! `cargo xtask bench-step`: how long a whole control step takes, estimator and controller, for
//! every model and technique.

use std::process::Command;

use anyhow::{Context, Result, ensure};

/// Options of `cargo xtask bench-step`.
#[derive(Debug, Clone, clap::Args)]
pub struct BenchStep {}

impl BenchStep {
    /// Builds and runs the example `step_latency` of the observer's crate.
    ///
    /// # Errors
    /// When it cannot be built, or when a step is above the bar of 1 microsecond at the 99.9th
    /// percentile.
    pub fn run(&self) -> Result<()> {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let arguments = [
            "run",
            "--release",
            "--quiet",
            "-p",
            "friction_observer",
            "--no-default-features",
            "--example",
            "step_latency",
        ];
        let status = Command::new(cargo).args(arguments).status().context("starting cargo")?;
        ensure!(
            status.success(),
            "a step is above the bar, or the bench could not be built; see above"
        );
        Ok(())
    }
}
