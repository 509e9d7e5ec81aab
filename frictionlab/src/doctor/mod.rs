//! What `frictionlab doctor` looks at: one file a check, each with a verdict, figures, and how to
//! mend what is not right.
//!
//! - [`scheduling`]: real-time priority, and how late a bare loop is;
//! - [`clock`]: resolution, jumps, synchronisation, the processor's frequency;
//! - [`network`]: environment variables of ROS, loopback, multicast;
//! - [`domain`]: listens to the domain, from which [`participants`] and [`loop_timing`] judge who
//!   is there and how old the commands are;
//! - [`security`]: whether nodes are secured, and who on the domain is authenticated;
//! - [`rigs`]: rigs, ports and disk.
//!
//! Nothing here moves a motor, opens a rig or changes a node.

mod clock;
mod domain;
mod finding;
mod heard;
mod loop_timing;
mod network;
mod participants;
mod rigs;
mod scheduling;
mod security;
mod terminal;

use std::path::Path;

use ros_node::{Discovery, Range, Stop};

pub use finding::{Figure, Finding, Report, Section, Verdict};
pub use terminal::render;

use work::progress::Progress;

/// Stages of the examination.
pub const STAGES: u64 = 7;

/// Looks at everything, about nine seconds; ends early, with what there is, when `stop` is set.
/// Runs would go to the folder `runs`.
#[must_use]
pub fn examine(runs: &Path, progress: &Progress, stop: &Stop) -> Report {
    let clocks = clock::ClockWatch::start();
    let (environment, discovery) = network::environment();
    let range = discovery.map_or(Range::Localhost, |discovery| discovery.range);
    let mut sections = Vec::new();
    let mut add = |name, findings| {
        sections.push(Section { name, findings });
        progress.advance(1.0);
    };

    progress.stage("how late a loop is here");
    add("Scheduling", scheduling::check());
    if !stop.is_set() {
        progress.stage("network");
        add("Network", [environment, network::network(range)].concat());
    }
    if !stop.is_set() {
        progress.stage("who is on the domain");
        let asked_for = security::environment(discovery.as_ref());
        let (participants, secured, loops) = others(discovery.as_ref(), stop);
        add("Security", [vec![asked_for], secured].concat());
        add("Other nodes", participants);
        add("Control loops", loops);
    }
    add("Clocks", clocks.findings(range == Range::Subnet));
    add("Rigs and disk", [rigs::check(), rigs::disk(runs)].concat());
    Report::new(sections)
}

fn others(
    discovery: Option<&Discovery>,
    stop: &Stop,
) -> (Vec<Finding>, Vec<Finding>, Vec<Finding>) {
    let Some(discovery) = discovery else {
        let said = "not looked at, since the environment names no domain (see network)";
        return (
            vec![Finding::fine("other nodes", said)],
            Vec::new(),
            vec![Finding::fine("control loop", said)],
        );
    };
    match domain::listen(discovery, stop) {
        Ok(heard) => {
            (participants::check(&heard), security::others(&heard), loop_timing::check(&heard))
        }
        Err(error) => {
            let broken = Finding::broken(
                "other nodes",
                format!("the domain cannot be joined: {error}"),
                "see network; another domain may have free ports: `export ROS_DOMAIN_ID=42`",
            );
            (
                vec![broken],
                Vec::new(),
                vec![Finding::fine("control loop", "not looked at: the domain cannot be joined")],
            )
        }
    }
}
