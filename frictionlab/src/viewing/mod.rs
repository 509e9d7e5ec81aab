//! The view of a running loop: `--view`.
//!
//! The crate `view` serves the page and the socket and knows no ROS. Here are the two ways between
//! it and the nodes. What they say is heard where they publish it, inside the process
//! ([`channels`]); what a viewer asks for goes through their services, parameters and topics as
//! anybody's requests do ([`asking`], [`services`]): the same limits, the same lifecycle, the same
//! age of commands. The control thread knows nothing of a view.

mod args;
#[cfg(feature = "ros")]
mod asking;
#[cfg(feature = "ros")]
mod channels;
#[cfg(feature = "ros")]
mod curve;
#[cfg(feature = "ros")]
mod json;
#[cfg(feature = "ros")]
mod nodes;
#[cfg(feature = "ros")]
mod services;
#[cfg(feature = "ros")]
mod settings;

pub use args::{ViewArgs, words};
#[cfg(feature = "ros")]
pub use nodes::{NodesView, NodesViewError};
