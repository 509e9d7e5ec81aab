//! The topics of the laboratory as channels.

use msgs::RosMessage;
use msgs::topics::{self, Topic};
use view::Channel;

/// All of them, under their names before any remapping.
pub(super) fn known() -> Vec<Channel> {
    vec![
        channel(&topics::JOINT_STATES),
        channel(&topics::RIG_MEASUREMENT),
        channel(&topics::REFERENCE),
        channel(&topics::MOTOR_VOLTAGE),
        channel(&topics::FRICTION_ESTIMATE),
        channel(&topics::CONTROLLER_STATE),
        channel(&topics::EXPERIMENT_STATUS),
        channel(&topics::DIAGNOSTICS),
    ]
}

/// The channel of a topic.
pub(super) fn channel<M: RosMessage>(topic: &Topic<M>) -> Channel {
    Channel {
        topic: topic.name.to_owned(),
        encoding: "cdr".to_owned(),
        schema_name: M::type_name(),
        schema_encoding: "ros2msg".to_owned(),
        schema: M::schema(),
        latched: topic.qos.transient_local,
    }
}
