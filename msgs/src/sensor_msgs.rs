//! Types of the ROS package `sensor_msgs`.

use serde::{Deserialize, Serialize};

use crate::{builtin_interfaces::Time, message::ros_message, std_msgs::Header};

/// State of a set of joints. The arrays have the same length, or are empty.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct JointState {
    /// Time of the measurement.
    pub header: Header,
    /// Names of the joints.
    pub name: Vec<String>,
    /// Positions \[rad or m\].
    pub position: Vec<f64>,
    /// Velocities \[rad/s or m/s\].
    pub velocity: Vec<f64>,
    /// Efforts \[N m or N\].
    pub effort: Vec<f64>,
}

ros_message!(
    JointState,
    "sensor_msgs",
    "../standard/sensor_msgs/JointState.msg",
    "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e",
    [Header, Time]
);
