//! `rig_driver`: the rig as a ROS 2 node.

use std::process::ExitCode;

fn main() -> ExitCode {
    rig_driver::node::program(ros_node::command_line())
}
