//! Types of the ROS package `std_msgs`.

use serde::{Deserialize, Serialize};

use crate::{builtin_interfaces::Time, message::ros_message};

/// Time and frame of a message.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Header {
    /// Time of the data.
    pub stamp: Time,
    /// Coordinate frame of the data; empty where it has none.
    pub frame_id: String,
}

impl Header {
    /// Header of data without a frame, at so many nanoseconds since the epoch.
    pub fn at(stamp_ns: u64) -> Self {
        Self { stamp: Time::from_nanos(stamp_ns), frame_id: String::new() }
    }
}

ros_message!(
    Header,
    "std_msgs",
    "../standard/std_msgs/Header.msg",
    "RIHS01_f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01",
    [Time]
);
