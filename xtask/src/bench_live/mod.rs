//! `cargo xtask bench-live`: is the 1 kHz loop of `frictionlab live` as regular as this machine
//! allows?
//!
//! The loop runs with recording and DDS publishing on, in blocks, and between them a bare loop that
//! does nothing but sleep to its next deadline by the same call, in the same scheduling class. What
//! counts is the 99th percentile of |period - 1 ms| of each block, and of the blocks the median of
//! the ratios of neighbours: what else the machine does strikes both.
//!
//! With `--viewers N` a third loop runs in each block: the same `live` with a view and so many
//! viewers, of which every third stops reading. It is held against the one without.

#![expect(
    rustdoc::broken_intra_doc_links,
    reason = "options are read in a terminal, where units are not escaped"
)]

mod bare;
mod errors;
mod viewers;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use anyhow::{Context, Result, ensure};
use friction_ident::statistics::{quantile, sorted};

use errors::PeriodErrors;

/// Period of both loops.
const PERIOD: Duration = Duration::from_millis(1);
/// Brings loopback up with multicast, then becomes the command.
const LOOPBACK_ONLY: &str = "ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo && exec \"$@\"";

/// Options of `cargo xtask bench-live`.
#[derive(Debug, Clone, clap::Args)]
pub struct BenchLive {
    /// Blocks; each runs both loops once.
    #[arg(long, default_value_t = 12, value_parser = clap::value_parser!(u32).range(1..))]
    blocks: u32,
    /// Length of a block of one loop [s].
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..))]
    seconds: u32,
    /// Largest accepted median of the ratios.
    #[arg(long, default_value_t = 1.2)]
    bar: f64,
    /// Print the table, whatever the ratio.
    #[arg(long)]
    report_only: bool,
    /// Hold `live` with so many viewers against `live` without, too; every third stops reading.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(..=16))]
    viewers: u32,
    /// One block with viewers, here: how this program calls itself in the namespace.
    #[arg(long, value_name = "TIMING", hide = true)]
    watched: Option<PathBuf>,
    /// A built `frictionlab`; built anew in the release profile if left out.
    #[arg(long, value_name = "PROGRAM")]
    program: Option<PathBuf>,
}

impl BenchLive {
    /// Runs both loops in turns and prints the table.
    ///
    /// # Errors
    /// When a loop cannot be built or run, when they ran in different scheduling classes, or when
    /// the median ratio is above the bar.
    pub fn run(&self) -> Result<()> {
        let program = match &self.program {
            Some(program) => program.clone(),
            None => build()?,
        };
        if let Some(timing) = &self.watched {
            return viewers::watch(self.live_command(Command::new(&program), timing), self.viewers);
        }
        let namespace = namespace();
        if namespace.is_none() {
            writeln!(
                std::io::stderr(),
                "no network namespace: other participants of this machine are heard"
            )?;
        }
        let mut out = std::io::stdout().lock();
        let watched = self.viewers > 0;
        let more = if watched {
            "   late   viewed p50  p99 [us]   late  ratio of p99  late cycles"
        } else {
            ""
        };
        let head = format!("block  live p50  p99 [us]   bare p50  p99 [us]  ratio of p99{more}");
        writeln!(out, "{head}\n{}", "-".repeat(head.len()))?;
        let (mut ratios, mut viewed) = (Vec::new(), Vec::new());
        for block in 0..self.blocks {
            // Who goes first changes, so that neither always finds the warmer machine.
            let with_viewers = || watched.then(|| self.live(&program, namespace, true)).transpose();
            let (live, bare, with) = if block % 2 == 0 {
                let live = self.live(&program, namespace, false)?;
                let with = with_viewers()?;
                (live, self.bare()?, with)
            } else {
                let bare = self.bare()?;
                let with = with_viewers()?;
                (self.live(&program, namespace, false)?, bare, with)
            };
            ensure!(
                live.realtime == bare.realtime,
                "one loop has real-time priority and the other has not: live {}, bare {}",
                live.realtime,
                bare.realtime
            );
            let ratio = live.p99_us / bare.p99_us.max(0.1);
            let more = with.map_or_else(String::new, |with| {
                let of_p99 = with.p99_us / live.p99_us.max(0.1);
                viewed.push((of_p99, live.late, with.late));
                format!(
                    "  {:>5}  {:>10.1}  {:>8.1}  {:>5}  {of_p99:>12.2}  {:>11}",
                    live.late,
                    with.p50_us,
                    with.p99_us,
                    with.late,
                    format!("{:+}", with.late as i64 - live.late as i64)
                )
            });
            writeln!(
                out,
                "{:>5}  {:>8.1}  {:>8.1}   {:>8.1}  {:>8.1}  {ratio:>12.2}{more}",
                block + 1,
                live.p50_us,
                live.p99_us,
                bare.p50_us,
                bare.p99_us
            )?;
            out.flush()?;
            ratios.push(ratio);
            if block == 0 && !live.realtime {
                writeln!(
                    std::io::stderr(),
                    "both loops run at ordinary priority: SCHED_FIFO was refused"
                )?;
            }
        }
        let median = quantile(&sorted(ratios), 0.5).unwrap_or(f64::NAN);
        writeln!(out, "median ratio of the p99 period errors: {median:.2} (bar {:.2})", self.bar)?;
        if watched {
            let ratios = sorted(viewed.iter().map(|(ratio, ..)| *ratio));
            let late = |of: fn(&(f64, u64, u64)) -> u64| viewed.iter().map(of).sum::<u64>();
            writeln!(
                out,
                "with {} viewers: median ratio of the p99 period errors {:.2}, late cycles {} with and {} without",
                self.viewers,
                quantile(&ratios, 0.5).unwrap_or(f64::NAN),
                late(|(_, _, with)| *with),
                late(|(_, without, _)| *without)
            )?;
        }
        ensure!(
            self.report_only || median <= self.bar,
            "the median ratio {median:.2} is above {:.2}",
            self.bar
        );
        Ok(())
    }

    /// A block of `frictionlab live`, with viewers or without.
    fn live(
        &self,
        program: &Path,
        namespace: Option<&[&str]>,
        viewers: bool,
    ) -> Result<PeriodErrors> {
        let folder = tempfile::tempdir().context("making a folder for the bag")?;
        let timing = folder.path().join("timing.json");
        let this = std::env::current_exe().context("a running program knows its own file")?;
        let started = if viewers { &this } else { program };
        let mut command = match namespace {
            Some(flags) => {
                let mut command = Command::new("unshare");
                command.args(flags).args(["bash", "-c", LOOPBACK_ONLY, "--"]).arg(started);
                command
            }
            None => Command::new(started),
        };
        if viewers {
            command.args(["bench-live", "--program"]).arg(program).arg("--watched").arg(&timing);
            command.arg(format!("--viewers={}", self.viewers));
            command.arg(format!("--seconds={}", self.seconds));
        } else {
            command = self.live_command(command, &timing);
            command.arg("--quiet");
        }
        let output = command.output().with_context(|| format!("starting {}", started.display()))?;
        ensure!(
            output.status.success(),
            "frictionlab live: {}",
            String::from_utf8_lossy(&output.stderr)
        );
        let text =
            std::fs::read_to_string(&timing).context("reading the timing of frictionlab live")?;
        let found: serde_json::Value =
            serde_json::from_str(&text).context("the timing of frictionlab live")?;
        let number =
            |name: &str| found[name].as_f64().with_context(|| format!("no {name} in {text}"));
        let priority = found["priority"].as_str().context("no priority in the timing")?;
        let cycles = number("cycles")?;
        ensure!(
            cycles >= f64::from(self.seconds) * 990.0,
            "only {cycles} cycles of {} s were recorded: the machine is too busy to measure anything",
            self.seconds
        );
        Ok(PeriodErrors {
            p50_us: number("p50_us")?,
            p99_us: number("p99_us")?,
            late: found["late"].as_u64().context("no late cycles in the timing")?,
            realtime: priority.contains("SCHED_FIFO, priority"),
        })
    }

    /// The options of a block; `--quiet`, where nobody looks for the view.
    fn live_command(&self, mut command: Command, timing: &Path) -> Command {
        command.args(["live", "--amplitude", "1.5", "--frequency", "3", "--duration"]);
        command.arg(self.seconds.to_string()).arg("--timing").arg(timing);
        command.arg("--out").arg(timing.with_file_name("run"));
        if self.watched.is_some() {
            command.args(["--view-port", "0"]);
        }
        command.env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST").stdin(Stdio::null());
        command
    }

    fn bare(&self) -> Result<PeriodErrors> {
        let cycles = u64::from(self.seconds) * 1000;
        let thread = std::thread::Builder::new()
            .name("bare".into())
            .spawn(move || bare::run(PERIOD, cycles));
        thread
            .context("starting the bare loop")?
            .join()
            .map_err(|_| anyhow::anyhow!("the bare loop panicked"))
    }
}

/// Builds `frictionlab` in the release profile.
pub(crate) fn build() -> Result<PathBuf> {
    let root =
        Path::new(env!("CARGO_MANIFEST_DIR")).parent().context("xtask stands in the workspace")?;
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let arguments =
        ["build", "--release", "--locked", "--package", "frictionlab", "--bin", "frictionlab"];
    let status =
        Command::new(cargo).args(arguments).current_dir(root).status().context("starting cargo")?;
    ensure!(status.success(), "frictionlab could not be built; see above");
    let target = std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| root.join("target"), |dir| root.join(dir));
    Ok(target.join("release").join(format!("frictionlab{}", std::env::consts::EXE_SUFFIX)))
}

/// The flags with which `unshare` makes a network namespace here, if it does.
pub(crate) fn namespace() -> Option<&'static [&'static str]> {
    [&["-n"][..], &["-r", "-n"]].into_iter().find(|flags| {
        let probe = Command::new("unshare")
            .args(*flags)
            .args(["bash", "-c", LOOPBACK_ONLY, "--", "true"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status();
        probe.is_ok_and(|status| status.success())
    })
}
