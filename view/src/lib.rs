//! A page in the browser, and the Foxglove WebSocket protocol, on one port.
//!
//! The crate knows no ROS and no rig. Somebody gives it channels of messages ([`Hub`]) and takes
//! what viewers ask for ([`Steering`]); it serves both to browsers and to viewers that speak
//! `foxglove.websocket.v1` or `foxglove.sdk.v1`:
//!
//! - [`View`]: the server, its address, and who may do what ([`Access`]);
//! - [`Hub`]: channels, and messages on them. [`Hub::publish`] never waits for a viewer: each has a
//!   bounded queue, which loses its oldest messages first and counts them;
//! - [`Steering`]: parameters, services, messages from viewers, playback, and files to show.
//!
//! The program listens on loopback. On any other address it wants a token, and it looks at `Host`
//! and `Origin` in both cases, so that no other page of the browser can reach it.
//!
//! The crate `foxglove` was looked at first (0.30): it opens a port of its own, which cannot serve
//! a page, and looks neither at `Origin` nor at tokens.

mod access;
mod assets;
mod caller;
mod channel;
mod client;
mod error;
mod files;
mod http;
mod hub;
mod origin;
mod pace;
mod protocol;
mod queue;
mod server;
mod shared;
mod steering;

pub use access::{Access, Token, Tokens};
pub use channel::{Channel, ChannelId};
pub use error::ViewError;
pub use hub::Hub;
pub use origin::Origins;
pub use server::{View, ViewOptions};
pub use steering::{
    Parameter, Playback, PlaybackRequest, PlaybackStatus, Service, Shown, Steering,
};

/// Port that is tried first.
pub const PORT: u16 = 8765;
