//! `controller`: the controller as a ROS 2 node.

use std::process::ExitCode;

fn main() -> ExitCode {
    controller::node::program(ros_node::command_line())
}
