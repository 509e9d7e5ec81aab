//! `cargo xtask bench-ros`: what `/friction_estimate` at 1 kHz costs and how fast it is, from
//! `frictionlab live`, from `frictionlab launch` and from a publisher of rclpy, measured in one run
//! by subscribers and clients of rclpy.

#![expect(
    rustdoc::broken_intra_doc_links,
    reason = "options are read in a terminal, where units are not escaped"
)]

mod table;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use crate::python_env;

/// Brings loopback up with multicast, then becomes the command.
const LOOPBACK_ONLY: &str = "ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo && exec \"$@\"";

/// Options of `cargo xtask bench-ros`.
#[derive(Debug, Clone, clap::Args)]
pub struct BenchRos {
    /// Length of each measurement [s].
    #[arg(long, default_value_t = 15.0)]
    seconds: f64,
    /// Minutes after which memory is read once more.
    #[arg(long, default_value_t = 2.0)]
    minutes: f64,
    /// Clients that join and leave, one after the other, to see how much memory each leaves behind.
    #[arg(long, default_value_t = 100)]
    clients: u32,
    /// A built `frictionlab`; built anew in the release profile if left out.
    #[arg(long, value_name = "PROGRAM")]
    program: Option<PathBuf>,
}

impl BenchRos {
    /// Measures and prints the table as Markdown.
    ///
    /// # Errors
    /// What does not build or run.
    pub fn run(&self) -> Result<()> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"))
            .parent()
            .context("xtask stands in the workspace")?;
        let python =
            python_env::prepare()?.with_rclpy().context("the bench needs the real rclpy")?;
        let program = match &self.program {
            Some(program) => std::path::absolute(program).context("the program's path")?,
            None => crate::bench_live::build()?,
        };
        let flags = crate::bench_live::namespace().context(
            "no network namespace (`unshare -n` with `ip`): run as root or allow user namespaces",
        )?;
        let mut err = std::io::stderr();
        writeln!(err, "three publishers, one after the other; leave the machine alone meanwhile")?;
        let output = Command::new("unshare")
            .args(flags)
            .args(["bash", "-c", LOOPBACK_ONLY, "--"])
            .arg(python.join("bin/python"))
            .arg(root.join("tests/python/bench_session.py"))
            .arg(&program)
            .args([self.seconds, self.minutes].map(|number| number.to_string()))
            .arg(self.clients.to_string())
            .env("ROS_DOMAIN_ID", "80")
            .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
            .stdin(Stdio::null())
            .output()
            .context("unshare does not start")?;
        ensure!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let report: Value =
            serde_json::from_slice(&output.stdout).context("the session prints JSON")?;
        write!(std::io::stdout(), "{}", table::markdown(&report, self.minutes, self.clients))?;
        Ok(())
    }
}
