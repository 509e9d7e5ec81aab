//! The executable `rig_driver`.

use std::process::ExitCode;

use super::{Lasting, run};

const ABOUT: &str = "\
The rig as a managed ROS 2 node: measures and drives one axis at its control period.

Publishes /joint_states and /rig_measurement, follows /motor_voltage while it is active, and stops the motor by itself when
commands come late, readings contradict each other or limits are passed. The simulated rig activates itself; a real one waits
for `ros2 lifecycle set /rig_driver configure` and `activate` (parameter autostart).

Limits of a real rig (safety.*, calibration.*, rig, voltage_limit) are those of the start. With -p allow_limits:=true they may be set
later too, while the node is not active.
  rig_driver --ros-args -p rig:=simulated
  rig_driver --ros-args -p rig:=serial:/dev/ttyACM0 --params-file calibration.yaml";

/// Runs the node as a program of its own; `given` are the words behind the program's name.
pub fn program(given: Vec<String>) -> ExitCode {
    let lasting = Lasting::default();
    ros_node::run("rig_driver", env!("CARGO_PKG_VERSION"), ABOUT, given, |participant, stop| {
        run(participant, stop, &lasting)
    })
}
