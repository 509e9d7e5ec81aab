//! `cargo xtask soak`: the loop at 1 kHz for a long time, with a subscriber of the real rclpy:
//! memory, losses, drift.

use std::{env, path::Path, process::Command};

use anyhow::{Context, ensure};
use serde_json::Value;

use crate::python_env;

/// Growth of a process's memory that counts as none.
const GROWTH: f64 = 0.05;
/// Drift that counts as none: of stamps against the wall clock, and of cycles against stamps.
const DRIFT: f64 = 1e-4;
/// Share of a signal that a subscriber in Python may lose when it does not get its share of the
/// machine.
const LOST_IN_PYTHON: f64 = 0.005;
/// Brings loopback up with multicast, then becomes the command.
const LOOPBACK_ONLY: &str = "ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo && exec \"$@\"";

/// Arguments of `cargo xtask soak`.
#[derive(Debug, clap::Args)]
pub struct Soak {
    /// Minutes of each mode
    #[arg(long, default_value_t = 10.0)]
    minutes: f64,
    /// The three executables, or everything in one process
    #[arg(long, value_enum, default_value_t = Mode::Both)]
    mode: Mode,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Mode {
    Processes,
    Live,
    Both,
}

impl Soak {
    /// Runs it and prints a table for each mode.
    ///
    /// # Errors
    /// What does not build or run, or a figure beyond its limit.
    pub fn run(&self) -> anyhow::Result<()> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"))
            .parent()
            .context("xtask stands in the workspace")?;
        let target = env::var_os("CARGO_TARGET_DIR")
            .map_or_else(|| root.join("target"), |dir| root.join(dir));
        let python =
            python_env::prepare()?.with_rclpy().context("the soak needs the real rclpy")?;
        let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let packages = ["rig_driver", "friction_observer", "controller", "frictionlab"];
        let built = Command::new(cargo)
            .args(["build", "--release", "--locked", "--bins"])
            .args(packages.iter().flat_map(|package| ["--package", package]))
            .current_dir(root)
            .status()
            .context("cargo does not start")?;
        ensure!(built.success(), "the programs do not build");
        let programs = target.join("release");
        let mut good = true;
        for mode in ["processes", "live"] {
            if matches!((self.mode, mode), (Mode::Processes, "live") | (Mode::Live, "processes")) {
                continue;
            }
            println!("soak, {mode}: {} minutes ...", self.minutes);
            let output = Command::new("unshare")
                .args(["-r", "-n", "bash", "-c", LOOPBACK_ONLY, "--"])
                .arg(python.join("bin/python"))
                .arg(root.join("tests/python/soak_session.py"))
                .arg(&programs)
                .args([&format!("{}", 60.0 * self.minutes), mode])
                .arg(programs.join("frictionlab"))
                .env("ROS_DOMAIN_ID", "75")
                .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
                .output()
                .context("unshare does not start")?;
            ensure!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            let report: Value =
                serde_json::from_slice(&output.stdout).context("the session prints JSON")?;
            good &= print(&report);
        }
        ensure!(good, "a figure is beyond its limit");
        Ok(())
    }
}

/// Prints what a session measured; whether all of it is within its limits.
fn print(report: &Value) -> bool {
    let mut good = true;
    let mut row = |what: &str, value: String, limit: &str, within: bool| {
        good &= within;
        println!("| {what} | {value} | {limit} | {} |", if within { "yes" } else { "NO" });
    };
    println!("| what | measured | limit | within |\n|---|---|---|---|");
    let early = report["early_s"].as_f64().unwrap_or(f64::NAN);
    for (process, growth) in report["memory_growth"].as_object().into_iter().flatten() {
        let growth = growth.as_f64().unwrap_or(f64::NAN);
        let memory = &report["memory_end_kb"][process];
        row(
            &format!("memory of {process}"),
            format!("{memory} kB, {:+.1} % since {early:.0} s", 100.0 * growth),
            "+5 %",
            growth < GROWTH,
        );
    }
    let heard = report["heard"].as_f64().unwrap_or(0.0);
    for (what, share, limit) in [
        ("missing_at_subscriber", LOST_IN_PYTHON, "0.5 %"),
        ("commands_missing", LOST_IN_PYTHON, "0.5 %"),
        ("disordered", 0.0, "0"),
    ] {
        if let Some(count) = report[what].as_f64() {
            row(
                &what.replace('_', " "),
                format!("{count} of {heard}"),
                limit,
                count <= share * heard,
            );
        }
    }
    if let (Some(commands), Some(cycles)) =
        (report["health"]["controller"]["commands"].as_f64(), report["cycles"].as_f64())
    {
        // Counted by the second.
        let within = (commands - cycles).abs() <= 1000.0 + 1e-3 * cycles;
        row("commands of the controller", format!("{commands} for {cycles} cycles"), "1 s", within);
    }
    if let Some(missing) = report["bag"]["missing"].as_i64() {
        row(
            "missing in the bag",
            format!("{missing} of {}", report["bag"]["messages"]),
            "0",
            missing == 0,
        );
    }
    for what in ["cycles_against_stamps", "stamps_against_wall_clock"] {
        if let Some(drift) = report[what].as_f64() {
            row(&what.replace('_', " "), format!("{drift:.1e}"), "1e-4", drift.abs() < DRIFT);
        }
    }
    if let Some(overruns) = report["health"]["rig_driver: control loop"]["overruns"].as_str() {
        println!("| cycles a whole period late | {overruns} | | |");
    }
    good
}
