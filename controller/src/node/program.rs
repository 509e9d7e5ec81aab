//! The executable `controller`.

use std::process::ExitCode;

use super::run;

const ABOUT: &str = "\
The controller as a managed ROS 2 node: velocity or position of one axis, with friction compensation.

Hears /joint_states, /friction_estimate and /reference, publishes /motor_voltage and /controller_state. Mode, gains and compensation can be
changed while it runs, without a jump of the voltage. A reference that stops coming ramps to zero velocity.
  controller --ros-args -p mode:=position -p pid.k_p:=6.0
  ros2 topic pub -r 100 /reference friction_msgs/msg/Reference '{velocity: 0.3}'";

/// Runs the node as a program of its own; `given` are the words behind the program's name.
pub fn program(given: Vec<String>) -> ExitCode {
    ros_node::run("controller", env!("CARGO_PKG_VERSION"), ABOUT, given, run)
}
