//! What a message type knows about itself.

use serde::{Serialize, de::DeserializeOwned};

/// The interface definition of one message type. Halves of services and thirds of actions count as
/// messages too.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Definition {
    /// ROS package, as in `sensor_msgs`.
    pub package: &'static str,
    /// Type without its package, as in `JointState` or `Trigger_Request`.
    pub name: &'static str,
    /// Text of the `.msg` file, or of the part of the `.srv` or `.action` file.
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

    /// Folder of the definition in its package: `msg`, `srv` or `action`.
    const FOLDER: &'static str = "msg";

    /// Full ROS name, as in `sensor_msgs/msg/JointState`.
    fn type_name() -> String {
        format!("{}/{}/{}", Self::DEFINITION.package, Self::FOLDER, Self::DEFINITION.name)
    }

    /// Schema of the type as rosbag2 stores it (`ros2msg`): its `.msg` text, then the text of each
    /// dependency behind a ruler of 80 equals signs and a line with its name.
    fn schema() -> String {
        let mut text = Self::DEFINITION.text.to_owned();
        for dependency in Self::DEPENDENCIES {
            if !text.ends_with('\n') {
                text.push('\n');
            }
            text.push_str(&"=".repeat(80));
            text.push_str(&format!(
                "\nMSG: {}/{}\n{}",
                dependency.package, dependency.name, dependency.text
            ));
        }
        text
    }
}

/// What services and actions carry: any message; with the feature `ros2`, any that ros2-client
/// takes.
#[cfg(feature = "ros2")]
pub trait Payload:
    RosMessage + ros2_client::Message + Clone + Default + Send + Sync + 'static
{
}
#[cfg(feature = "ros2")]
impl<M: RosMessage + ros2_client::Message + Clone + Default + Send + Sync + 'static> Payload for M {}

/// What services and actions carry: any message; with the feature `ros2`, any that ros2-client
/// takes.
#[cfg(not(feature = "ros2"))]
pub trait Payload: RosMessage + Clone + Default + Send + Sync + 'static {}
#[cfg(not(feature = "ros2"))]
impl<M: RosMessage + Clone + Default + Send + Sync + 'static> Payload for M {}

/// A service: what is asked and what is answered.
pub trait RosService: 'static {
    /// ROS package, as in `std_srvs`.
    const PACKAGE: &'static str;
    /// Type without its package, as in `Trigger`.
    const NAME: &'static str;
    /// What is asked.
    type Request: Payload;
    /// What is answered.
    type Response: Payload;
}

/// An action: something that takes its time, tells how far it is and can be cancelled.
pub trait RosAction: 'static {
    /// ROS package, as in `friction_msgs`.
    const PACKAGE: &'static str;
    /// Type without its package, as in `RunExperiment`.
    const NAME: &'static str;
    /// What is asked for.
    type Goal: Payload;
    /// What came of it.
    type Result: Payload;
    /// How far it is.
    type Feedback: Payload;
}

/// The part of a `.srv` or `.action` file with that number, from 0; the parts stand between lines
/// of three dashes.
pub(crate) const fn part(text: &'static str, number: usize) -> &'static str {
    let bytes = text.as_bytes();
    let (mut start, mut line, mut seen, mut at) = (0, 0, 0, 0);
    while at < bytes.len() {
        if bytes[at] == b'\n' {
            let dashes = at == line + 3
                && bytes[line] == b'-'
                && bytes[line + 1] == b'-'
                && bytes[line + 2] == b'-';
            if dashes {
                if seen == number {
                    return text.split_at(line).0.split_at(start).1;
                }
                seen += 1;
                start = at + 1;
            }
            line = at + 1;
        }
        at += 1;
    }
    if seen == number { text.split_at(start).1 } else { "" }
}

/// Ties a struct to its `.msg` file:
/// `ros_message!(Struct, "package", "path to .msg", "hash", [types it contains])`.
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

/// Ties a struct to its part of a `.srv` or `.action` file: `ros_part!(Struct, "package", "srv",
/// "Name_Request", "path to .srv", number of the part, "hash", [types it contains])`.
macro_rules! ros_part {
    ($type:ident, $package:literal, $folder:literal, $name:literal, $path:literal, $part:literal, $hash:literal, [$($dependency:ty),*]) => {
        impl $crate::message::RosMessage for $type {
            const DEFINITION: $crate::message::Definition = $crate::message::Definition {
                package: $package,
                name: $name,
                text: $crate::message::part(include_str!($path), $part),
            };
            const DEPENDENCIES: &'static [$crate::message::Definition] =
                &[$(<$dependency as $crate::message::RosMessage>::DEFINITION),*];
            const TYPE_HASH: &'static str = $hash;
            const FOLDER: &'static str = $folder;
        }

        #[cfg(feature = "ros2")]
        impl ros2_client::Message for $type {}
    };
}
pub(crate) use ros_part;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_stand_between_lines_of_three_dashes() {
        let text = "# ----\nint32 a\n---\n---\nbool b # ---\n";
        assert_eq!(part(text, 0), "# ----\nint32 a\n");
        assert_eq!(part(text, 1), "");
        assert_eq!(part(text, 2), "bool b # ---\n");
        assert_eq!(part(text, 3), "");
    }

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
