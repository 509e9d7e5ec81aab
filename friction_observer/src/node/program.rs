//! The executable `friction_observer`.

use std::process::ExitCode;

use super::run;

const ABOUT: &str = "\
The friction observer as a managed ROS 2 node: says what the friction torque is now.

Hears /joint_states, /motor_voltage and /reference, publishes /friction_estimate. Model, parameters and technique can be changed while
it runs: the estimate goes over without a jump. A parameters.yaml of an identification is its parameter file.
  friction_observer --ros-args -p model:=lugre --params-file parameters.yaml
  ros2 param set /friction_observer lugre.sigma0 20.0";

/// Runs the node as a program of its own; `given` are the words behind the program's name.
pub fn program(given: Vec<String>) -> ExitCode {
    ros_node::run("friction_observer", env!("CARGO_PKG_VERSION"), ABOUT, given, run)
}
