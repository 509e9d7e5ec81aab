//! Types of the ROS package `std_srvs`.

use serde::{Deserialize, Serialize};

use crate::message::{RosService, ros_part};

/// Asks for something that needs no arguments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Trigger;

/// Request of [`Trigger`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct TriggerRequest {
    /// The byte that ROS sends for a type without fields.
    pub structure_needs_at_least_one_member: u8,
}

/// Response of [`Trigger`].
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct TriggerResponse {
    /// It was done.
    pub success: bool,
    /// What happened, for people.
    pub message: String,
}

impl RosService for Trigger {
    const PACKAGE: &'static str = "std_srvs";
    const NAME: &'static str = "Trigger";
    type Request = TriggerRequest;
    type Response = TriggerResponse;
}

ros_part!(
    TriggerRequest,
    "std_srvs",
    "srv",
    "Trigger_Request",
    "../standard/std_srvs/Trigger.srv",
    0,
    "RIHS01_d010825374ce8918e72bfd826c82603e60f45419e932ea976f807b74a863a199",
    []
);
ros_part!(
    TriggerResponse,
    "std_srvs",
    "srv",
    "Trigger_Response",
    "../standard/std_srvs/Trigger.srv",
    1,
    "RIHS01_2d946c21e2fc3f1e9ca6986a8191d85fcc70097a8bb7771a053564bc47009cdf",
    []
);
