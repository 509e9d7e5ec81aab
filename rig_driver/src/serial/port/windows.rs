//! The port of a Windows system. It is opened for this program alone, which the system itself sees
//! to.

use std::{
    io::ErrorKind,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
    time::{Duration, Instant},
};

use serial2::{SerialPort, Settings};

use super::{Sent, SerialError};

/// Longest time that one look for bytes takes; [`Port::wait`] looks until its own time is over.
const LOOK: Duration = Duration::from_millis(5);
/// Time after which bytes that the system does not take are dropped.
const TAKE: Duration = Duration::from_millis(5);
/// Bytes that one look takes.
const CHUNK: usize = 4096;

/// An open serial port.
#[derive(Debug)]
pub(in crate::serial) struct Port {
    port: SerialPort,
    /// What was read while waiting.
    come: Mutex<Vec<u8>>,
    path: PathBuf,
}

impl Port {
    /// Opens `path`, as in `COM3`, raw at `baud`, 8N1 without flow control, and throws away what
    /// had come before.
    pub(in crate::serial) fn open(path: &Path, baud: u32) -> Result<Self, SerialError> {
        let path = path.to_owned();
        let settings = |mut settings: Settings| {
            settings.set_raw();
            settings.set_baud_rate(baud)?;
            Ok(settings)
        };
        let mut port = match SerialPort::open(&path, settings) {
            Ok(port) => port,
            Err(error) if error.kind() == ErrorKind::PermissionDenied => {
                return Err(SerialError::Busy { path });
            }
            Err(error) if error.kind() == ErrorKind::InvalidInput => {
                return Err(SerialError::Settings { path, baud, reason: error.to_string() });
            }
            Err(error) => return Err(SerialError::Open { path, reason: error.to_string() }),
        };
        port.set_read_timeout(LOOK)
            .and_then(|()| port.set_write_timeout(TAKE))
            .and_then(|()| port.discard_buffers())
            .map_err(|error| SerialError::Settings {
                path: path.clone(),
                baud,
                reason: error.to_string(),
            })?;
        Ok(Self { port, come: Mutex::default(), path })
    }

    pub(in crate::serial) fn path(&self) -> &Path {
        &self.path
    }

    /// Waits until there are bytes to read, but not longer than `time`, or [`LOOK`] where that is
    /// longer. Says whether there are.
    pub(in crate::serial) fn wait(&self, time: Duration) -> Result<bool, SerialError> {
        let end = Instant::now() + time;
        let mut come = self.come.lock().unwrap_or_else(PoisonError::into_inner);
        let mut buffer = [0; CHUNK];
        while come.is_empty() {
            match self.port.read(&mut buffer) {
                Ok(length) => come.extend_from_slice(buffer.get(..length).unwrap_or_default()),
                Err(error)
                    if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::Interrupted) => {}
                Err(error) => return Err(self.gone(error)),
            }
            if Instant::now() >= end {
                break;
            }
        }
        Ok(!come.is_empty())
    }

    /// Reads what is there into `buffer`; nothing if there is nothing.
    pub(in crate::serial) fn read<'a>(
        &self,
        buffer: &'a mut [u8],
    ) -> Result<&'a [u8], SerialError> {
        let mut come = self.come.lock().unwrap_or_else(PoisonError::into_inner);
        let length = come.len().min(buffer.len());
        let read = buffer.get_mut(..length).unwrap_or_default();
        for (to, from) in read.iter_mut().zip(come.drain(..length)) {
            *to = from;
        }
        Ok(read)
    }

    /// Sends `bytes`; what the system does not take within [`TAKE`] is dropped.
    pub(in crate::serial) fn send(&self, bytes: &[u8]) -> Result<Sent, SerialError> {
        match self.port.write(bytes) {
            Ok(sent) if sent == bytes.len() => Ok(Sent::All),
            // A part of a frame is no frame; the receiver throws it away by its CRC.
            Ok(_) => Ok(Sent::Full),
            Err(error) if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::Interrupted) => {
                Ok(Sent::Full)
            }
            Err(error) => Err(self.gone(error)),
        }
    }

    fn gone(&self, reason: impl ToString) -> SerialError {
        SerialError::Disconnected { path: self.path.clone(), reason: reason.to_string() }
    }
}
