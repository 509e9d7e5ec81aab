//! `cargo xtask simulators`: exported friction, run in versions of MuJoCo beside our own models.

use anyhow::{Context, Result};
use simulator_export::Version;
use tests::simulators::{Apart, INERTIA, exported, frictions, in_mujoco, of_model, torque};

use crate::python_env::{Environment, target};

/// Versions at which something changed, and the newest before a change.
const VERSIONS: [&str; 6] = ["3.6.0", "3.7.0", "3.8.1", "3.12.0", "3.17.0", "4.0.0"];

/// Options of `cargo xtask simulators`.
#[derive(Debug, Clone, clap::Args)]
pub struct Simulators {
    /// Versions of MuJoCo, separated by commas
    #[arg(long, value_delimiter = ',', default_values_t = VERSIONS.map(str::to_owned))]
    mujoco: Vec<String>,
}

impl Simulators {
    /// Runs every friction in every version and prints the table.
    ///
    /// # Errors
    /// A version that is not known or cannot be had, and what keeps a Python from being made.
    pub fn run(&self) -> Result<()> {
        println!(
            "| MuJoCo | friction | in the file | torque error of the file, sliding rms | motion apart, rms | worst | of the motion |"
        );
        println!("|---|---|---|---|---|---|---|");
        for text in &self.mujoco {
            let version: Version = text.parse()?;
            let environment = Environment::make(&target()?.join(format!("python-mujoco-{text}")))?;
            let wheel = format!("mujoco=={text}");
            environment
                .half("mujoco", wheel.clone(), || environment.install(&[wheel.as_str()]))
                .with_context(|| format!("MuJoCo {text} cannot be had"))?;
            let python = environment.dir.join("bin/python");
            for (name, model) in frictions() {
                let level = model.parameter("f_s").or_else(|| model.parameter("f_c"));
                let along = torque(level.unwrap_or(0.1), 0);
                let file = exported(model, version, None);
                let apart = Apart::of(
                    &of_model(model, INERTIA, &along),
                    &in_mujoco(&python, &file.text, &along),
                );
                let held = if file.text.contains("lugre") { "lugre" } else { "frictionloss" };
                println!(
                    "| {text} | {name} | {held} | {:.2} % of F_c | {:.2e} rad | {:.2e} rad | {:.3} % |",
                    file.cost.percent(file.cost.sliding.rms),
                    apart.rms,
                    apart.worst,
                    apart.percent(),
                );
            }
        }
        Ok(())
    }
}
