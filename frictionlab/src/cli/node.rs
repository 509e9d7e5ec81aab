//! `frictionlab node`: one of the four nodes, in this process.

use std::process::ExitCode;

use clap::{Args, Subcommand};

/// Run one of the four ROS 2 nodes in this process
///
/// rig_driver, friction_observer, controller or experiment_runner: the same programs as the
/// executables of these names, for those who have installed `frictionlab` alone;
/// `frictionlab launch` starts them so.
///
///   frictionlab node rig_driver --ros-args -p rig:=serial:/dev/ttyACM0
///   frictionlab node controller --help
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct NodeArgs {
    #[command(subcommand)]
    node: Node,
}

/// Words for the node itself; `--help` is for it too.
#[derive(Debug, Args)]
#[command(disable_help_flag = true)]
struct Given {
    /// Arguments of the node, as in --ros-args -p NAME:=VALUE
    #[arg(value_name = "ARGUMENTS", trailing_var_arg = true, allow_hyphen_values = true)]
    words: Vec<String>,
}

#[derive(Debug, Subcommand)]
#[command(rename_all = "snake_case")]
enum Node {
    /// The rig: measures and drives one axis
    RigDriver(Given),
    /// The friction observer: says what the friction torque is now
    FrictionObserver(Given),
    /// The controller: velocity or position, with friction compensation
    Controller(Given),
    /// Experiments and identification for whoever asks
    ExperimentRunner(Given),
}

/// Runs it until it is told to end; the exit code is the node's.
#[must_use]
pub fn execute(args: NodeArgs) -> ExitCode {
    match args.node {
        Node::RigDriver(given) => rig_driver::node::program(given.words),
        Node::FrictionObserver(given) => friction_observer::node::program(given.words),
        Node::Controller(given) => controller::node::program(given.words),
        Node::ExperimentRunner(given) => {
            experiment_runner::server::program(given.words, thesis::BESIDE, super::ERRANDS)
        }
    }
}
