//! The `frictionlab` command, one file a subcommand ([`cli`]), and what only the command does:
//! it looks at the machine ([`doctor`]), starts nodes ([`launch`]), runs the loop on ROS 2
//! ([`live`]), shows it in a browser ([`viewing`]) and checks keys ([`security`]).

pub mod cli;
#[cfg(feature = "ros")]
pub mod doctor;
pub mod interruption;
#[cfg(feature = "ros")]
pub mod launch;
#[cfg(feature = "ros")]
pub mod live;
#[cfg(feature = "ros")]
pub mod security;
pub mod viewing;
