//! What can go wrong when a view is opened.

use std::io;
use std::net::{IpAddr, SocketAddr};

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
    /// The address cannot be had, on any port.
    #[error(
        "the view cannot listen on {address}: it is no address of this machine; `ip address` lists them, and without --view-address the view is on this machine alone"
    )]
    NotHere {
        /// The address.
        address: IpAddr,
    },
    /// The system grants no threads or no random numbers.
    #[error("the view cannot be started: {0}")]
    System(io::Error),
}

impl ViewError {
    /// Whether the user can mend it by another option.
    #[must_use]
    pub const fn is_bad_input(&self) -> bool {
        matches!(self, Self::Listen { .. } | Self::NotHere { .. })
    }
}
