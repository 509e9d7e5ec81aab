//! Types of the ROS package `rosgraph_msgs`.

use serde::{Deserialize, Serialize};

use crate::{builtin_interfaces::Time, message::ros_message};

/// The time that simulated clocks show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Clock {
    /// That time.
    pub clock: Time,
}

ros_message!(
    Clock,
    "rosgraph_msgs",
    "../standard/rosgraph_msgs/Clock.msg",
    "RIHS01_692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564",
    [Time]
);
