//! The `ros2` command itself, where a ROS installation is on the path.

use tests::{network::namespaced, node_programs};

/// Starts the nodes from the folder in `$1`, calls the verbs, and ends the nodes.
const SESSION: &str = r#"
for node in rig_driver friction_observer controller; do "$1/$node" & done
trap 'kill -INT $(jobs -p); wait' EXIT
for attempt in $(seq 30); do
  there=$(ros2 node list --no-daemon | grep -cxE '/(rig_driver|friction_observer|controller)')
  [ "$there" = 3 ] && break
done
verb() { echo "== $*"; timeout 30 ros2 "$@" || echo "FAILED $*"; }
verb node list --no-daemon
verb topic list -t --no-daemon
verb topic echo --once --no-daemon /joint_states sensor_msgs/msg/JointState
verb param list /controller --no-daemon
verb param get /controller compensation_scale --no-daemon
verb param set /controller compensation_scale 0.5 --no-daemon
verb param describe /friction_observer model --no-daemon
verb lifecycle get /rig_driver --no-daemon
verb lifecycle set /rig_driver deactivate --no-daemon
verb lifecycle list /rig_driver --no-daemon
verb service call /rig_driver/emergency_stop std_srvs/srv/Trigger
"#;

#[tests::needs(namespace, ros2)]
#[test]
fn the_ros2_command_finds_and_drives_the_nodes() {
    let mut command = namespaced();
    let output = command
        .args(["bash", "-c", SESSION, "verbs"])
        .arg(node_programs())
        .env("ROS_DOMAIN_ID", "76")
        .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        .output()
        .expect("unshare starts");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(!said.contains("FAILED"), "{said}\n{}", String::from_utf8_lossy(&output.stderr));
    for told in [
        "/rig_driver",
        "sensor_msgs/msg/JointState",
        "load_shaft",
        "compensation_scale",
        "Double value is: 1.0",
        "Set parameter successful",
        "proposed",
        "active",
        "success=True",
    ] {
        assert!(said.contains(told), "`{told}` is not in\n{said}");
    }
}
