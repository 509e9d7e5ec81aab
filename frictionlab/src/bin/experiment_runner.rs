//! The node `experiment_runner`: experiments and identification over ROS 2.

use std::process::ExitCode;

fn main() -> ExitCode {
    let offers = frictionlab::cli::ERRANDS;
    experiment_runner::server::program(ros_node::command_line(), thesis::BESIDE, offers)
}
