//! The pseudo-terminal in the serial port's place.

use std::{
    fs,
    os::{fd::OwnedFd, unix::fs::symlink},
    path::{Path, PathBuf},
};

use anyhow::Context;
use rustix::{
    fs::{Mode, OFlags, fcntl_getfl, fcntl_setfl, open},
    io::{read, write},
    pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt},
    termios::{OptionalActions, tcgetattr, tcsetattr},
};

/// The device's end of the line.
#[derive(Debug)]
pub(crate) struct Terminal {
    device: OwnedFd,
    /// Held open, so that the line stays when a host closes its end.
    _host: OwnedFd,
    path: PathBuf,
    link: Option<PathBuf>,
}

impl Terminal {
    /// Opens a pseudo-terminal, and puts `link` to it.
    pub(crate) fn open(link: Option<&Path>) -> anyhow::Result<Self> {
        let device =
            openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).context("no pseudo-terminal")?;
        grantpt(&device)
            .and_then(|()| unlockpt(&device))
            .context("the pseudo-terminal does not open")?;
        let name = ptsname(&device, Vec::new()).context("the pseudo-terminal has no name")?;
        let name = PathBuf::from(name.to_str().context("the pseudo-terminal's name is no text")?);
        fcntl_setfl(&device, fcntl_getfl(&device)? | OFlags::NONBLOCK)?;
        let host = open(&name, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty())?;
        // No echo of what the device says, from the start.
        let mut settings = tcgetattr(&host)?;
        settings.make_raw();
        tcsetattr(&host, OptionalActions::Now, &settings)?;
        if let Some(link) = link {
            // A link left by an emulator that was killed may go; anything else stays.
            if link.is_symlink() {
                fs::remove_file(link)
                    .with_context(|| format!("cannot replace {}", link.display()))?;
            }
            symlink(&name, link)
                .with_context(|| format!("cannot make the link {}", link.display()))?;
        }
        Ok(Self { device, _host: host, path: name, link: link.map(Path::to_owned) })
    }

    /// What a host opens.
    pub(crate) fn path(&self) -> &Path {
        self.link.as_deref().unwrap_or(&self.path)
    }

    /// What the host has sent.
    pub(crate) fn receive(&self) -> Vec<u8> {
        let mut buffer = [0; 4096];
        // Nothing there, or nobody.
        let length = read(&self.device, &mut buffer).unwrap_or(0);
        buffer.get(..length).unwrap_or_default().to_vec()
    }

    /// Sends to the host. A line whose buffer is full drops what comes, as a serial line does.
    pub(crate) fn send(&self, bytes: &[u8]) {
        if !bytes.is_empty() {
            let _ = write(&self.device, bytes);
        }
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        if let Some(link) = &self.link {
            let _ = fs::remove_file(link);
        }
    }
}
