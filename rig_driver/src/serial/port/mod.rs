//! A serial port: raw bytes, no waiting but in [`Port::wait`].

#[cfg(unix)]
mod unix;
#[cfg(windows)]
mod windows;

#[cfg(unix)]
pub(super) use unix::Port;
#[cfg(windows)]
pub(super) use windows::Port;

use super::SerialError;

/// What became of bytes that were to be sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sent {
    /// All of them are on their way.
    All,
    /// The system's buffer is full: the line does not carry what is sent, and the bytes are
    /// dropped.
    Full,
}
