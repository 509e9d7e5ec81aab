//! What is told under a topic.

/// What a channel carries.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Channel {
    /// Its topic, as in `/joint_states`.
    pub topic: String,
    /// How its messages are written: `cdr` or `json`.
    pub encoding: String,
    /// Name of their type, as in `sensor_msgs/msg/JointState`.
    pub schema_name: String,
    /// How the schema is written: `ros2msg` or `jsonschema`.
    pub schema_encoding: String,
    /// What the messages have in them.
    pub schema: String,
    /// Who comes late gets the last message.
    pub latched: bool,
}

impl Channel {
    /// A channel of JSON whose last message late comers get.
    #[must_use]
    pub fn latched_json(topic: &str, schema_name: &str) -> Self {
        Self {
            topic: topic.to_owned(),
            encoding: "json".to_owned(),
            schema_name: schema_name.to_owned(),
            schema_encoding: "jsonschema".to_owned(),
            schema: r#"{"type":"object"}"#.to_owned(),
            latched: true,
        }
    }
}

/// What a channel is called by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ChannelId(pub(crate) u32);
