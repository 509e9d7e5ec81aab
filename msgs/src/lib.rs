//! ROS 2 interface package `friction_msgs` and its Rust types.
//!
//! The ROS side is the folder `friction_msgs/` beside this crate's `src/`: an ordinary interface
//! package that `colcon` builds. The Rust side is one module a ROS package; a test compares every
//! `.msg`, `.srv` and `.action` file with its structs, field by field. Standard messages the
//! laboratory uses come along, so that bags can be written and read without a ROS installation.
//!
//! - [`message`]: what a message type knows about itself: name, definition, hash, rosbag2 schema;
//! - [`cdr`]: bytes on the wire and in bags;
//! - [`descriptions`]: types as ROS describes them, with the files they stand in;
//! - [`type_hashes`]: what ROS announces of the types of endpoints;
//! - [`topics`]: which topics there are, with type and quality of service;
//! - [`interfaces`]: topics, services and actions of every node, for documentation and tests;
//! - [`friction_msgs`], [`sensor_msgs`], [`std_msgs`], [`builtin_interfaces`], [`diagnostic_msgs`]:
//!   the types;
//! - [`std_srvs`], [`lifecycle_msgs`], [`rosgraph_msgs`], [`type_description_interfaces`]: those of
//!   standard services, managed nodes, the simulated clock and described types.
//!
//! ```
//! use msgs::{RosMessage, cdr, friction_msgs::MotorVoltage, std_msgs::Header};
//!
//! # fn main() -> Result<(), cdr::CdrError> {
//! let message = MotorVoltage { header: Header::at(1), voltage: 1.5 };
//! let bytes = cdr::encode(&message)?;
//! assert_eq!(cdr::decode::<MotorVoltage>(&bytes)?, message);
//! assert!(MotorVoltage::TYPE_HASH.starts_with("RIHS01_"));
//! # Ok(())
//! # }
//! ```

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

pub mod builtin_interfaces;
pub mod cdr;
pub mod descriptions;
pub mod diagnostic_msgs;
pub mod friction_msgs;
pub mod interfaces;
pub mod lifecycle_msgs;
pub mod message;
pub mod rcl_interfaces;
pub mod rosgraph_msgs;
pub mod sensor_msgs;
pub mod std_msgs;
pub mod std_srvs;
pub mod topics;
pub mod type_description_interfaces;
pub mod type_hashes;

pub use message::{Definition, Payload, RosAction, RosMessage, RosService};
