//! `frictionlab doctor`: is this machine fit for a rig, and how is the loop that runs?

use std::path::PathBuf;

use anyhow::Context;
use ros_node::Stop;

use crate::doctor::{self, Verdict};
use work::Interrupted;
use work::progress::Progress;
use work::saying::print;

/// Look at this machine and the running nodes
///
/// Scheduling rights and how late a loop of 1 kHz is here; clocks; network, multicast and the
/// environment variables of ROS; which other nodes are on the domain, in which lifecycle state;
/// rigs, ports and disk. About nine seconds. Needs no ROS installation.
///
/// Beside running nodes (`frictionlab launch`, or the executables) it also tells how old the
/// measurement behind each applied voltage is, from what rig_driver reports on /diagnostics.
///
/// Nothing is moved, opened or changed. Ends with exit code 1 if something is broken; what is
/// merely worth a look ends with 0.
#[derive(Debug, clap::Args)]
pub struct DoctorArgs {
    /// Print the findings as JSON, for programs
    #[arg(long)]
    pub json: bool,
    /// The folder to which runs would go
    #[arg(long, value_name = "DIR", default_value = "runs")]
    pub runs: PathBuf,
    /// Print nothing but errors
    #[arg(long)]
    pub quiet: bool,
}

/// Runs it.
///
/// # Errors
/// A plain error if something is broken; [`Interrupted`] at ctrl-C.
pub fn execute(args: &DoctorArgs) -> anyhow::Result<()> {
    let stop = Stop::on_signals().context("cannot watch for ctrl-C")?;
    let progress = Progress::counting(doctor::STAGES, "checks", args.quiet);
    let report = doctor::examine(&args.runs, &progress, &stop);
    progress.finish();
    if args.json {
        let text = serde_json::to_string_pretty(&report).context("the report is no JSON")?;
        print(&format!("{text}\n"))?;
    } else if !args.quiet {
        print(&doctor::render(&report))?;
    }
    if stop.is_set() {
        return Err(Interrupted("stopped; not everything was looked at".to_owned()).into());
    }
    let broken: Vec<&str> =
        report.of(Verdict::Broken).map(|finding| finding.subject.as_str()).collect();
    anyhow::ensure!(
        broken.is_empty(),
        "broken: {}; how to mend it is said above",
        broken.join(", ")
    );
    Ok(())
}
