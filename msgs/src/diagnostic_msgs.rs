//! Types of the ROS package `diagnostic_msgs`.

use serde::{Deserialize, Serialize};

use crate::{builtin_interfaces::Time, message::ros_message, std_msgs::Header};

/// One value with its name.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct KeyValue {
    /// What the value is called.
    pub key: String,
    /// The value as text.
    pub value: String,
}

/// Health of one component.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct DiagnosticStatus {
    /// [`OK`](Self::OK), [`WARN`](Self::WARN), [`ERROR`](Self::ERROR) or [`STALE`](Self::STALE).
    pub level: u8,
    /// The component.
    pub name: String,
    /// What is the matter.
    pub message: String,
    /// The hardware it runs on.
    pub hardware_id: String,
    /// Figures that tell more.
    pub values: Vec<KeyValue>,
}

impl DiagnosticStatus {
    /// All is well.
    pub const OK: u8 = 0;
    /// Works, but someone should look.
    pub const WARN: u8 = 1;
    /// Does not work.
    pub const ERROR: u8 = 2;
    /// Has not reported for too long.
    pub const STALE: u8 = 3;
}

/// Health of the components of one node.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct DiagnosticArray {
    /// Time of the report.
    pub header: Header,
    /// One entry a component.
    pub status: Vec<DiagnosticStatus>,
}

ros_message!(
    KeyValue,
    "diagnostic_msgs",
    "../standard/diagnostic_msgs/KeyValue.msg",
    "RIHS01_d68081eaa540288c5440753baecef0c4e16e81a5f78ad68902ded5100413bb42",
    []
);
ros_message!(
    DiagnosticStatus,
    "diagnostic_msgs",
    "../standard/diagnostic_msgs/DiagnosticStatus.msg",
    "RIHS01_b0e3e692ea2d54a8af2f4ef1930e81556a2db55216b771f8a7d2724ed47bf0e4",
    [KeyValue]
);
ros_message!(
    DiagnosticArray,
    "diagnostic_msgs",
    "../standard/diagnostic_msgs/DiagnosticArray.msg",
    "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e",
    [Header, Time, DiagnosticStatus, KeyValue]
);
