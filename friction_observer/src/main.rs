//! `friction_observer`: the friction observer as a ROS 2 node.

use std::process::ExitCode;

fn main() -> ExitCode {
    friction_observer::node::program(ros_node::command_line())
}
