//! The executable `experiment_runner`.

use std::process::ExitCode;

use super::node;
use crate::errand::Errands;
use crate::run::Beside;

const ABOUT: &str = "\
Experiments and identification of friction over ROS 2, one experiment at a time.

Offers the action ~/run_experiment and the services ~/start_experiment, ~/list_experiments, ~/identify and ~/abort, and says on
/experiment_status what goes on. Experiments are those of `frictionlab run`, with its options, and leave the same folder.
  experiment_runner --ros-args -p runs:=/data/runs";

/// Runs the node as a program of its own; `given` are the words behind the program's name.
/// What it has `beside` experiments and identification, and what it `offers` besides, comes from its
/// author.
pub fn program(given: Vec<String>, beside: Beside, offers: Errands) -> ExitCode {
    // An experiment under way leaves a whole bag.
    ros_node::ends_within(ros_node::ENDS_WITHIN_WRITING);
    ros_node::run(
        "experiment_runner",
        env!("CARGO_PKG_VERSION"),
        ABOUT,
        given,
        move |participant, stop| node::run(participant, stop, (beside, offers)),
    )
}
