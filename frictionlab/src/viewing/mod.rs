//! The view of what a command does: `--view`, and `view BAG`.
//!
//! The crate `view` serves the page and the socket and knows no ROS. Here is what it shows and whom
//! it asks:
//!
//! - [`NodesView`]: running nodes. What those of this process say is heard where they publish it,
//!   what others say over DDS (`channels`). What a viewer asks for goes through services,
//!   parameters and topics (`services`, `settings`, `asking`), as anybody's requests do: the same
//!   limits, the same lifecycle, the same age of commands. The control thread knows nothing of a
//!   view;
//! - [`BagsView`]: a run without nodes, by what it writes into its bag;
//! - [`CommissionView`]: a commission, by what its stages write on its board;
//! - [`Shelf`]: folders of results, with their reports and bags;
//! - [`Player`]: a recording.

mod args;
#[cfg(feature = "ros")]
mod asking;
mod at_work;
mod bags;
#[cfg(feature = "ros")]
mod channels;
mod clock;
mod commissioning;
#[cfg(feature = "ros")]
mod curve;
mod ending;
#[cfg(feature = "ros")]
mod json;
#[cfg(feature = "ros")]
mod nodes;
mod pace;
mod paper;
mod player;
#[cfg(feature = "ros")]
mod services;
#[cfg(feature = "ros")]
mod settings;
mod shelf;
mod topics;
mod words;

pub use args::{ViewArgs, ViewPlace, worded};
pub use bags::BagsView;
#[cfg(feature = "ros")]
pub use channels::Heard;
pub use commissioning::{CommissionView, REQUESTED};
#[cfg(feature = "ros")]
pub use nodes::{Join, NodesView, NodesViewError, Shown, refused};
pub use player::Player;
pub use shelf::Shelf;
pub use words::words;
