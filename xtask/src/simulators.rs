//! `cargo xtask simulators`: exported friction, run in versions of MuJoCo, Newton and mjlab beside
//! our own models.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use simulator_export::{Target, Version};
use tests::simulators::{
    Apart, INERTIA, Motion, exported, frictions, in_mjlab, in_mujoco, in_newton, of_model, torque,
};

use crate::python_env::{Environment, target};

/// Versions at which something changed, and the newest before a change.
const MUJOCO: [&str; 6] = ["3.6.0", "3.7.0", "3.8.1", "3.12.0", "3.17.0", "4.0.0"];
/// Those of Newton that have a DC motor with LuGre.
const NEWTON: [&str; 1] = ["1.8.0"];

/// Options of `cargo xtask simulators`.
#[derive(Debug, Clone, clap::Args)]
pub struct Simulators {
    /// Versions of MuJoCo, separated by commas
    #[arg(long, value_delimiter = ',', default_values_t = MUJOCO.map(str::to_owned))]
    mujoco: Vec<String>,
    /// Versions of Newton, which runs on the processor: 0.7 GB each, and some minutes
    #[arg(long, value_delimiter = ',', default_values_t = NEWTON.map(str::to_owned))]
    newton: Vec<String>,
    /// Versions of mjlab, as 1.6.0: 7 GB each, for the PyTorch that it stands on; none unless asked
    #[arg(long, value_delimiter = ',')]
    mjlab: Vec<String>,
}

/// A simulator as a wheel.
struct Simulator {
    name: &'static str,
    target: Target,
    /// What it is installed as, without its version.
    wheel: &'static str,
    moves: fn(&Path, &str, &[f64]) -> Motion,
}

const IN_MUJOCO: Simulator =
    Simulator { name: "MuJoCo", target: Target::Mjcf, wheel: "mujoco", moves: in_mujoco };
const IN_NEWTON: Simulator =
    Simulator { name: "Newton", target: Target::Newton, wheel: "newton[sim]", moves: in_newton };
const IN_MJLAB: Simulator =
    Simulator { name: "mjlab", target: Target::Mjlab, wheel: "mjlab", moves: in_mjlab };

impl Simulators {
    /// Runs every friction in every version and prints the table.
    ///
    /// # Errors
    /// A version that is not known or cannot be had, and what keeps a Python from being made.
    pub fn run(&self) -> Result<()> {
        println!(
            "| simulator | friction | in the file | torque error of the file, sliding rms | motion apart, rms | worst | of the motion |"
        );
        println!("|---|---|---|---|---|---|---|");
        let all = [(IN_MUJOCO, &self.mujoco), (IN_NEWTON, &self.newton), (IN_MJLAB, &self.mjlab)];
        for (simulator, versions) in all {
            for text in versions {
                let python = simulator.python(text)?;
                simulator.rows(text, &python)?;
            }
        }
        Ok(())
    }
}

impl Simulator {
    /// The interpreter of an environment of its own with that version.
    fn python(&self, text: &str) -> Result<PathBuf> {
        let name = self.name.to_lowercase();
        let environment = Environment::make(&target()?.join(format!("python-{name}-{text}")))?;
        let wheel = format!("{}=={text}", self.wheel);
        environment
            .half(&name, wheel.clone(), || environment.install(&[wheel.as_str()]))
            .with_context(|| format!("{} {text} cannot be had", self.name))?;
        Ok(environment.dir.join("bin/python"))
    }

    fn rows(&self, text: &str, python: &Path) -> Result<()> {
        let version: Version = text.parse()?;
        for (name, model) in frictions() {
            let level = model.parameter("f_s").or_else(|| model.parameter("f_c"));
            let along = torque(level.unwrap_or(0.1), 0);
            let file = exported(model, self.target, version, None);
            let theirs = (self.moves)(python, &file.text, &along);
            let apart = Apart::of(&of_model(model, INERTIA, &along), &theirs);
            let held = if file.text.contains("lugre=") { "lugre" } else { "friction level" };
            println!(
                "| {} {text} | {name} | {held} | {:.2} % of F_c | {:.2e} rad | {:.2e} rad | {:.3} % |",
                self.name,
                file.cost.percent(file.cost.sliding.rms),
                apart.rms,
                apart.worst,
                apart.percent(),
            );
        }
        Ok(())
    }
}
