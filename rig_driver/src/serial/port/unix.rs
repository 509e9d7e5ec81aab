//! The port of a Unix system.

use std::{
    os::fd::OwnedFd,
    path::{Path, PathBuf},
    time::Duration,
};

use rustix::{
    event::{PollFd, PollFlags, Timespec, poll},
    fs::{FlockOperation, Mode, OFlags, flock, open},
    io::{Errno, read, write},
    termios::{
        ControlModes, OptionalActions, QueueSelector, ioctl_tiocexcl, isatty, tcflush, tcgetattr,
        tcsetattr,
    },
};

use super::{Sent, SerialError};

/// An open serial port, locked against other drivers of this kind.
#[derive(Debug)]
pub(in crate::serial) struct Port {
    fd: OwnedFd,
    path: PathBuf,
}

impl Port {
    /// Opens `path` raw at `baud`, 8N1 without flow control, and throws away what had come before.
    pub(in crate::serial) fn open(path: &Path, baud: u32) -> Result<Self, SerialError> {
        let path = path.to_owned();
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
        let fd = match open(&path, flags, Mode::empty()) {
            Ok(fd) => fd,
            Err(Errno::BUSY) => return Err(SerialError::Busy { path }),
            Err(errno) => return Err(SerialError::Open { path, reason: errno.to_string() }),
        };
        if !isatty(&fd) {
            return Err(SerialError::NotATerminal { path });
        }
        if flock(&fd, FlockOperation::NonBlockingLockExclusive).is_err() {
            return Err(SerialError::Busy { path });
        }
        let settings = |errno: Errno| SerialError::Settings {
            path: path.clone(),
            baud,
            reason: errno.to_string(),
        };
        let mut termios = tcgetattr(&fd).map_err(settings)?;
        termios.make_raw();
        termios.control_modes |= ControlModes::CLOCAL | ControlModes::CREAD | ControlModes::CS8;
        termios.control_modes -=
            ControlModes::CRTSCTS | ControlModes::CSTOPB | ControlModes::PARENB;
        termios.set_speed(baud).map_err(settings)?;
        tcsetattr(&fd, OptionalActions::Now, &termios).map_err(settings)?;
        // A pseudo-terminal keeps the mark when its user is killed, a real port does not.
        let real = path.canonicalize().is_ok_and(|path| !path.starts_with("/dev/pts"));
        if real {
            ioctl_tiocexcl(&fd).map_err(settings)?;
        }
        tcflush(&fd, QueueSelector::IOFlush).map_err(settings)?;
        Ok(Self { fd, path })
    }

    pub(in crate::serial) fn path(&self) -> &Path {
        &self.path
    }

    /// Waits until there are bytes to read, but not longer than `time`. Says whether there are.
    pub(in crate::serial) fn wait(&self, time: Duration) -> Result<bool, SerialError> {
        let timeout = Timespec {
            tv_sec: time.as_secs().try_into().unwrap_or(i64::MAX),
            tv_nsec: time.subsec_nanos().into(),
        };
        let mut fds = [PollFd::new(&self.fd, PollFlags::IN)];
        match poll(&mut fds, Some(&timeout)) {
            Ok(0) | Err(Errno::INTR) => Ok(false),
            // A hang-up too: reading tells it.
            Ok(_) => Ok(true),
            Err(errno) => Err(self.gone(errno)),
        }
    }

    /// Reads what is there into `buffer`; nothing if there is nothing.
    pub(in crate::serial) fn read<'a>(
        &self,
        buffer: &'a mut [u8],
    ) -> Result<&'a [u8], SerialError> {
        match read(&self.fd, &mut *buffer) {
            Ok(0) => Err(self.gone("end of file")),
            Ok(length) => Ok(buffer.get(..length).unwrap_or_default()),
            Err(Errno::AGAIN | Errno::INTR) => Ok(&[]),
            Err(errno) => Err(self.gone(errno)),
        }
    }

    /// Sends `bytes`, without waiting.
    pub(in crate::serial) fn send(&self, bytes: &[u8]) -> Result<Sent, SerialError> {
        match write(&self.fd, bytes) {
            Ok(sent) if sent == bytes.len() => Ok(Sent::All),
            // A part of a frame is no frame; the receiver throws it away by its CRC.
            Ok(_) | Err(Errno::AGAIN | Errno::INTR) => Ok(Sent::Full),
            Err(errno) => Err(self.gone(errno)),
        }
    }

    fn gone(&self, reason: impl ToString) -> SerialError {
        SerialError::Disconnected { path: self.path.clone(), reason: reason.to_string() }
    }
}
