//! What a message type knows about itself.

use serde::{Serialize, de::DeserializeOwned};

/// The interface definition of one message type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Definition {
    /// ROS package, as in `sensor_msgs`.
    pub package: &'static str,
    /// Type without its package, as in `JointState`.
    pub name: &'static str,
    /// Text of the `.msg` file.
    pub text: &'static str,
}

/// A Rust type that is a ROS 2 message.
pub trait RosMessage: Serialize + DeserializeOwned {
    /// The type's own definition.
    const DEFINITION: Definition;

    /// Definitions of every type it contains, at any depth, each once.
    const DEPENDENCIES: &'static [Definition];

    /// Hash of the type's structure (REP-2016, `RIHS01_...`), the same that ROS generates.
    const TYPE_HASH: &'static str;

    /// Full ROS name, as in `sensor_msgs/msg/JointState`.
    fn type_name() -> String {
        format!("{}/msg/{}", Self::DEFINITION.package, Self::DEFINITION.name)
    }

    /// Schema of the type as rosbag2 stores it (`ros2msg`): its `.msg` text, then the text of each dependency behind a
    /// ruler of 80 equals signs and a line with its name.
    fn schema() -> String {
        let mut text = Self::DEFINITION.text.to_owned();
        for dependency in Self::DEPENDENCIES {
            if !text.ends_with('\n') {
                text.push('\n');
            }
            text.push_str(&"=".repeat(80));
            text.push_str(&format!("\nMSG: {}/{}\n{}", dependency.package, dependency.name, dependency.text));
        }
        text
    }
}

/// Ties a struct to its `.msg` file: `ros_message!(Struct, "package", "path to .msg", "hash", [types it contains])`.
macro_rules! ros_message {
    ($type:ident, $package:literal, $path:literal, $hash:literal, [$($dependency:ty),*]) => {
        impl $crate::message::RosMessage for $type {
            const DEFINITION: $crate::message::Definition = $crate::message::Definition {
                package: $package,
                name: stringify!($type),
                text: include_str!($path),
            };
            const DEPENDENCIES: &'static [$crate::message::Definition] =
                &[$(<$dependency as $crate::message::RosMessage>::DEFINITION),*];
            const TYPE_HASH: &'static str = $hash;
        }

        #[cfg(feature = "ros2")]
        impl ros2_client::Message for $type {}
    };
}
pub(crate) use ros_message;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn schema_is_own_text_then_each_dependency_behind_a_ruler() {
        let schema = crate::sensor_msgs::JointState::schema();
        let parts: Vec<&str> = schema.split(&format!("{}\n", "=".repeat(80))).collect();
        assert_eq!(parts.len(), 3);
        assert!(parts[0].starts_with("# State of a set of joints"));
        assert!(parts[1].starts_with("MSG: std_msgs/Header\n"));
        assert!(parts[2].starts_with("MSG: builtin_interfaces/Time\n"));
    }
}
