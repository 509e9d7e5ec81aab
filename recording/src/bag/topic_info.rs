//! What a bag says of one of its topics.

/// One topic of a bag.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TopicInfo {
    /// The topic.
    pub name: String,
    /// ROS type, as in `sensor_msgs/msg/JointState`; empty if the bag does not say.
    pub type_name: String,
    /// Number of messages.
    pub count: u64,
}
