//! Types of the ROS package `rcl_interfaces`.

use serde::{Deserialize, Serialize};

use crate::{builtin_interfaces::Time, message::ros_message};

/// A line of a node's log.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Log {
    /// When it was said.
    pub stamp: Time,
    /// [`DEBUG`](Self::DEBUG), [`INFO`](Self::INFO), [`WARN`](Self::WARN), [`ERROR`](Self::ERROR)
    /// or [`FATAL`](Self::FATAL).
    pub level: u8,
    /// Who says it.
    pub name: String,
    /// What is said.
    pub msg: String,
    /// File of the source that says it.
    pub file: String,
    /// Function that says it.
    pub function: String,
    /// Line of that file.
    pub line: u32,
}

impl Log {
    /// For whoever looks for a mistake.
    pub const DEBUG: u8 = 10;
    /// As expected.
    pub const INFO: u8 = 20;
    /// Something may go wrong.
    pub const WARN: u8 = 30;
    /// Something went wrong.
    pub const ERROR: u8 = 40;
    /// The node ends.
    pub const FATAL: u8 = 50;
}

ros_message!(
    Log,
    "rcl_interfaces",
    "../standard/rcl_interfaces/Log.msg",
    "RIHS01_e28ce254ca8abc06abf92773b74602cdbf116ed34fbaf294fb9f81da9f318eac",
    [Time]
);
