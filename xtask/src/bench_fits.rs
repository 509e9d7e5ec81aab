//! `cargo xtask bench-fits`: are the fits faster than SciPy's least squares over models that Numba
//! compiled, and the servo's simulation faster than its loop in Numba?
//!
//! Both sides read the same files, start from the same values, stop at the same tolerance and use
//! one thread. They run in turns; what counts is the ratio of the medians. Both must find the same
//! minimum: a fit that stops early would be fast too. A search for a servo's parameters does nothing
//! but simulate, so there the same candidates are simulated on the same logs, and both must find the
//! same errors.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::{env, fs};

use anyhow::{Context, Result, ensure};
use friction_ident::servo::FrictionLevel;
use friction_ident::statistics::upper_median;
use serde::Deserialize;

use crate::python_env;

/// Options of `cargo xtask bench-fits`.
#[derive(Debug, Clone, clap::Args)]
pub struct BenchFits {
    /// Turns; in each, both programs make every fit five times.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    turns: u32,
    /// Least accepted ratio of SciPy's time to ours, where SciPy integrates as a user would write
    /// it.
    #[arg(long, default_value_t = 10.0)]
    bar: f64,
    /// Least accepted ratio where SciPy is given our own scheme, the cheapest there is.
    #[arg(long, default_value_t = 5.0)]
    bar_same_scheme: f64,
    /// Least accepted ratio for a servo's simulation.
    #[arg(long, default_value_t = 8.0)]
    bar_servo: f64,
}

/// One fit as both programs report it.
#[derive(Debug, Deserialize)]
struct Fit {
    what: String,
    milliseconds: Vec<f64>,
    evaluations: usize,
    /// Mean square; of a servo's level the mean position error \[rad\].
    mse: f64,
    parameters: BTreeMap<String, f64>,
}

/// Which bar a ratio is held to.
#[derive(Debug, Clone, Copy)]
enum Bar {
    /// SciPy integrates as a user would write it.
    Usual,
    /// SciPy is given our own scheme.
    SameScheme,
    /// Ours need only not be slower.
    NotSlower,
}

/// What is compared: ours, the peer's, and the bar.
const PAIRS: [(&str, &str, Bar); 5] = [
    ("lag", "lag", Bar::Usual),
    ("lag, LuGre", "lag, LuGre", Bar::Usual),
    ("lag, GMS(4)", "lag, GMS(4)", Bar::NotSlower),
    ("joint", "joint, RK4", Bar::Usual),
    ("joint", "joint, fixed step", Bar::SameScheme),
];

impl BenchFits {
    /// Runs both and prints the table.
    ///
    /// # Errors
    /// When a program cannot be built or run, when the two find different minima, or when a ratio
    /// is below its bar.
    pub fn run(&self) -> Result<()> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"))
            .parent()
            .context("xtask stands in the workspace")?;
        let target = env::var_os("CARGO_TARGET_DIR")
            .map_or_else(|| root.join("target"), |dir| root.join(dir));
        let python = python_env::scipy()?;
        let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let build = ["build", "--release", "--locked", "-p", "friction_ident"];
        let examples = ["fit_speed", "servo_speed"];
        let named = examples.iter().flat_map(|name| ["--example", name]);
        ensure!(
            Command::new(cargo).args(build).args(named).current_dir(root).status()?.success(),
            "the fits do not build"
        );
        let [ours, servo] = examples.map(|name| target.join("release/examples").join(name));
        let folder = target.join("bench-fits");
        if folder.exists() {
            fs::remove_dir_all(&folder)?;
        }

        let folder = folder.to_string_lossy().into_owned();
        let peer = |script: &str| {
            let mut command = Command::new(&python);
            command.arg(root.join("tests/peers").join(script)).args([&folder, "5"]);
            // One thread each: on two cores the threads of its linear algebra wait for one another.
            command.envs(["OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"].map(|name| (name, "1")));
            command
        };
        let (mut all, mut levels) = (Fits::new(), Fits::new());
        for turn in 1..=self.turns {
            eprintln!("turn {turn} of {} ...", self.turns);
            collect(&mut all, false, Command::new(&ours).args([&folder, "5"]))?;
            collect(&mut all, true, &mut peer("scipy_fits.py"))?;
            collect(&mut levels, false, Command::new(&servo).args([&folder, "5"]))?;
            collect(&mut levels, true, &mut peer("servo_fits.py"))?;
        }
        let mut slow = self.table(&all)?;
        slow.extend(self.servo_table(&levels)?);
        ensure!(slow.is_empty(), "{}", slow.join("; "));
        Ok(())
    }

    /// Prints the table of the fits; gives the ratios that are below their bars.
    fn table(&self, all: &Fits) -> Result<Vec<String>> {
        println!(
            "| fit | points | ours [ms] | SciPy and Numba [ms] | times faster | simulations, ours / SciPy |"
        );
        println!("|---|---|---|---|---|---|");
        let mut slow = Vec::new();
        for (own, peer, bar) in PAIRS {
            let find = |peer: bool, what: &str| {
                all.get(&(peer, what.to_owned())).with_context(|| format!("no fit `{what}`"))
            };
            let (ours, theirs) = (find(false, own)?, find(true, peer)?);
            let (mine, others) = (median(&ours.milliseconds), median(&theirs.milliseconds));
            let ratio = others / mine;
            let points = if own.starts_with("lag") { 9425 } else { 6000 };
            println!(
                "| {peer} | {points} | {mine:.2} | {others:.2} | {ratio:.1} | {} / {} |",
                ours.evaluations, theirs.evaluations
            );
            // Schemes of different order see slightly different minima; noise of 0.0029 N m makes
            // 8.4e-6.
            ensure!(
                (ours.mse / theirs.mse - 1.0).abs() < 0.005,
                "{peer}: mean squares {:e} and {:e} are not the same minimum: {:?} {:?}",
                ours.mse,
                theirs.mse,
                ours.parameters,
                theirs.parameters
            );
            let bar = match bar {
                Bar::Usual => self.bar,
                Bar::SameScheme => self.bar_same_scheme,
                Bar::NotSlower => 1.0,
            };
            if ratio < bar {
                slow.push(format!("{peer}: {ratio:.1} times faster, but {bar} are expected"));
            }
        }
        Ok(slow)
    }

    /// Prints the table of the servo's simulation; gives the ratios that are below the bar.
    fn servo_table(&self, all: &Fits) -> Result<Vec<String>> {
        println!(
            "\n| servo, level | ours [ms] | Numba [ms] | times faster | simulations of twelve logs a second, ours / Numba |"
        );
        println!("|---|---|---|---|---|");
        let mut slow = Vec::new();
        for level in FrictionLevel::NAMES {
            let find = |peer: bool| {
                all.get(&(peer, (*level).to_owned())).with_context(|| format!("no level {level}"))
            };
            let (ours, theirs) = (find(false)?, find(true)?);
            let (mine, others) = (median(&ours.milliseconds), median(&theirs.milliseconds));
            let rate = |fit: &Fit, milliseconds: f64| 1e3 * fit.evaluations as f64 / milliseconds;
            let ratio = others / mine;
            println!(
                "| {level} | {mine:.2} | {others:.1} | {ratio:.1} | {:.0} / {:.0} |",
                rate(ours, mine),
                rate(theirs, others)
            );
            ensure!(
                (ours.mse / theirs.mse - 1.0).abs() < 1e-9,
                "{level}: the mean position errors {:e} and {:e} rad differ",
                ours.mse,
                theirs.mse
            );
            if ratio < self.bar_servo {
                let bar = self.bar_servo;
                slow.push(format!(
                    "servo, {level}: {ratio:.1} times faster, but {bar} are expected"
                ));
            }
        }
        Ok(slow)
    }
}

/// What both programs say: the peer or not, which fit.
type Fits = BTreeMap<(bool, String), Fit>;

fn collect(all: &mut Fits, peer: bool, command: &mut Command) -> Result<()> {
    for fit in fits(command)? {
        all.entry((peer, fit.what.clone()))
            .and_modify(|seen| seen.milliseconds.extend(&fit.milliseconds))
            .or_insert(fit);
    }
    Ok(())
}

fn fits(command: &mut Command) -> Result<Vec<Fit>> {
    let output = command.output().with_context(|| format!("{command:?} does not start"))?;
    ensure!(
        output.status.success(),
        "{command:?} failed: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    let text = String::from_utf8(output.stdout)?;
    text.lines()
        .map(|line| serde_json::from_str(line).with_context(|| format!("not a fit: {line}")))
        .collect()
}

fn median(values: &[f64]) -> f64 {
    upper_median(&mut values.to_vec()).unwrap_or(f64::NAN)
}
