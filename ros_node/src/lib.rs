//! What every ROS 2 node of the laboratory needs and ros2-client does not give.
//!
//! - [`Discovery`]: which domain and which networks, from the environment as ROS reads it, loopback unless told otherwise;
//! - [`Participant`]: the process on the network, with the runtime its nodes' background work runs on;
//! - [`RosNode`]: a node that answers and leaves cleanly;
//! - [`Publisher`]: a typed publisher whose quality of service comes from [`msgs::topics`].
//!
//! ```no_run
//! use msgs::{friction_msgs::MotorVoltage, std_msgs::Header, topics};
//! use ros_node::{Discovery, Participant};
//!
//! # fn main() -> Result<(), ros_node::RosNodeError> {
//! let participant = Participant::join(&Discovery::from_environment()?)?;
//! let mut node = participant.node("talker")?;
//! let publisher = node.publisher(&topics::MOTOR_VOLTAGE)?;
//! publisher.publish(MotorVoltage { header: Header::at(1), voltage: 1.5 })?;
//! # Ok(())
//! # }
//! ```

mod discovery;
mod error;
mod node;
mod participant;
mod publisher;

pub use discovery::{Discovery, Range};
pub use error::RosNodeError;
pub use node::RosNode;
pub use participant::Participant;
pub use publisher::Publisher;
