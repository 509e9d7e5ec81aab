//! What can go wrong when a view is opened.

use std::io;
use std::net::SocketAddr;

/// A view that cannot be opened.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// The port cannot be had.
    #[error(
        "the view cannot listen on {address}: {source}; choose another port with --view-port, or leave it out"
    )]
    Listen {
        /// Where it was to listen.
        address: SocketAddr,
        /// What the system said.
        source: io::Error,
    },
    /// The system grants no threads or no random numbers.
    #[error("the view cannot be started: {0}")]
    System(io::Error),
}

impl ViewError {
    /// Whether the user can mend it by another option.
    #[must_use]
    pub const fn is_bad_input(&self) -> bool {
        matches!(self, Self::Listen { .. })
    }
}
