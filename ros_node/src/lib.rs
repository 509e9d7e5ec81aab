//! What a ROS 2 node needs and ros2-client does not give: parameters, lifecycle, actions, graph,
//! log, clock, discovery, security and a clean end.
//!
//! - [`Arguments`]: the ROS part of the command line, with [remappings](remap) and
//!   [parameter files](parameter_file), as rcl reads them;
//! - [`Discovery`]: which domain and which networks, from the environment as ROS reads it, loopback
//!   unless told otherwise;
//! - [`Participant`]: the process on the network, with the runtime its nodes' background work runs
//!   on;
//! - [`RosNode`]: a node that publishes, listens, answers, describes its types and leaves cleanly;
//! - [`Publisher`]: a typed publisher whose quality of service comes from [`msgs::topics`];
//! - [`ServiceClient`], [`RemoteParameters`]: asking other nodes;
//! - [`ActionServer`]: requests that take their time, see [`RosNode::serve_action`];
//! - [`Logger`], [`NodeClock`]: `/rosout` and `use_sim_time`;
//! - [`parameters`]: declared parameters with ranges and reasons, and their services;
//! - [`lifecycle`]: managed nodes;
//! - [`Graph`]: which other nodes are there;
//! - [`Stop`], [`before_forced_exit`]: SIGINT and SIGTERM, and an end that comes whatever is stuck;
//!   [`launched`]: the end of whoever launched the program;
//! - [`terminal`]: lines that nobody waits for;
//! - [`Gate`]: a topic of which one writer counts ([`one_writer`], [`stamps`]);
//! - [`hostile`]: what becomes of what strangers send;
//! - [`security`]: who may join and who may do what, as SROS 2 has it;
//! - [`deadlines`], [`timing`], [`queue`]: what a control thread stands on.
//!
//! ```no_run
//! use msgs::{friction_msgs::MotorVoltage, std_msgs::Header, topics};
//! use ros_node::{Discovery, Participant};
//!
//! # fn main() -> Result<(), ros_node::RosNodeError> {
//! let participant = Participant::join(&Discovery::from_environment()?)?;
//! let node = participant.node("talker")?;
//! let publisher = node.publisher(&topics::MOTOR_VOLTAGE)?;
//! publisher.publish(MotorVoltage { header: Header::at(1), voltage: 1.5 })?;
//! # Ok(())
//! # }
//! ```

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod action;
mod apart;
mod arguments;
mod client;
mod clock;
pub mod deadlines;
mod dialect;
mod discovery;
mod ending;
mod environment;
mod error;
mod executable;
mod gate;
mod graph;
mod hearing;
pub mod hostile;
mod inside;
// The published middleware does not tell who lags.
#[cfg_attr(not(feature = "mended"), allow(dead_code, unused_imports, unused_variables))]
mod lagging;
pub mod launched;
pub mod lifecycle;
mod limits;
mod log_level;
mod logger;
mod middleware;
mod names;
mod node;
pub mod one_writer;
mod outbox;
pub mod parameters;
mod participant;
mod publisher;
pub mod queue;
pub mod remap;
mod remote_parameters;
mod repeated;
pub mod rmw;
mod scope;
pub mod security;
mod service;
mod shared;
mod signals;
pub mod stamps;
pub mod terminal;
pub mod timing;
mod turn;
mod twins;
mod types;

pub use ::parameters::ParameterValue;
pub use ::parameters::file as parameter_file;
pub use action::{ActionHandler, ActionServer, Goal, GoalEnd, GoalId};
pub use arguments::{ArgumentError, Arguments, ROS_ARGUMENTS_HELP, command_line};
pub use client::ServiceClient;
pub use clock::NodeClock;
pub use discovery::{Discovery, Range};
pub use ending::before_forced_exit;
pub use environment::EnvironmentError;
pub use error::RosNodeError;
pub use executable::run;
pub use gate::{Gate, GateReport, Passes, TwoWriters};
pub use graph::{Graph, ParticipantId, SeenNode};
pub use inside::{Inside, Listener};
pub use lagging::SUBSCRIBERS_THAT_LAG;
pub use limits::quoted;
pub use log_level::LogLevel;
pub use logger::Logger;
pub use middleware::{Lost, Watch};
pub use names::NodeIdentity;
pub use node::{RosNode, Sent};
pub use participant::Participant;
pub use publisher::Publisher;
pub use remap::Named;
pub use remote_parameters::{Described, RemoteParameters};
pub use signals::{ENDS_WITHIN, ENDS_WITHIN_WRITING, FORCED, Stop, ends_within, signal_exit_code};
pub use twins::Twin;
