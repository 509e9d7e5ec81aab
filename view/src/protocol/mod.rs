//! The Foxglove WebSocket protocol: what comes, what goes, as JSON and as bytes.
//!
//! <https://github.com/foxglove/ws-protocol/blob/main/docs/spec.md>

pub(crate) mod incoming;
pub(crate) mod outgoing;
pub(crate) mod reading;
pub(crate) mod writing;

/// Names of the protocol that are spoken, the better one first. Both are written alike.
pub(crate) const SPOKEN: [&str; 2] = ["foxglove.sdk.v1", "foxglove.websocket.v1"];
