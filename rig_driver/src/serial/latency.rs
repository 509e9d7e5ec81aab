//! The latency timer of FTDI's USB serial chips: they hold bytes back for up to 16 ms unless told
//! not to.

use std::{
    fmt, fs,
    path::{Path, PathBuf},
};

/// Longest latency that a cycle of 1 kHz can bear \[ms\].
const WANTED: u32 = 1;

/// What is known of a port's latency.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Latency {
    /// The port has no latency timer: a USB device of its own (ttyACM), a UART of the board, a
    /// pseudo-terminal.
    NoTimer,
    /// The timer stands at 1 ms already.
    Low,
    /// The timer was set to 1 ms.
    Lowered {
        /// What it was \[ms\].
        from: u32,
    },
    /// The timer is too long and cannot be set.
    High {
        /// What it is \[ms\]; none if it cannot be read.
        milliseconds: Option<u32>,
        /// The timer's file.
        timer: PathBuf,
        /// The port.
        port: PathBuf,
        /// What the system said.
        reason: String,
    },
}

impl Latency {
    /// Sets the latency timer of `port` to 1 ms where there is one. `sysfs` is `/sys`, but in
    /// tests.
    ///
    /// The serial driver's own flag `ASYNC_LOW_LATENCY` sets the same timer; it needs an `ioctl`
    /// for which there is no safe wrapper, so that the advice names the program that does it.
    #[must_use]
    pub fn lower(port: &Path, sysfs: &Path) -> Self {
        // A link such as /dev/serial/by-id/... leads to the device's own name.
        let port = port.canonicalize().unwrap_or_else(|_| port.to_owned());
        let Some(name) = port.file_name() else { return Self::NoTimer };
        let timer = sysfs.join("class/tty").join(name).join("device/latency_timer");
        if !timer.exists() {
            return Self::NoTimer;
        }
        let read = || {
            let text = fs::read_to_string(&timer).map_err(|error| error.to_string())?;
            text.trim().parse::<u32>().map_err(|_| format!("it says {:?}", text.trim()))
        };
        let before = read();
        if before.as_ref().is_ok_and(|ms| *ms <= WANTED) {
            return Self::Low;
        }
        let written = fs::write(&timer, WANTED.to_string()).map_err(|error| error.to_string());
        match (before, written, read()) {
            (Ok(from), Ok(()), Ok(now)) if now <= WANTED => Self::Lowered { from },
            (before, written, now) => {
                let reason = written
                    .err()
                    .or(now.err())
                    .unwrap_or_else(|| "it did not take the value".into());
                Self::High { milliseconds: before.ok(), timer, port, reason }
            }
        }
    }

    /// Whether the port is fast enough for 1 kHz, as far as its timer tells.
    #[must_use]
    pub const fn is_good(&self) -> bool {
        !matches!(self, Self::High { .. })
    }
}

impl fmt::Display for Latency {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoTimer => write!(f, "the port has no latency timer"),
            Self::Low => write!(f, "the port's latency timer is {WANTED} ms"),
            Self::Lowered { from } => {
                write!(f, "the port's latency timer is {WANTED} ms now (it was {from} ms)")
            }
            Self::High { milliseconds, timer, port, reason } => {
                match milliseconds {
                    Some(ms) => write!(f, "the port's latency timer is {ms} ms")?,
                    None => write!(f, "the port's latency timer cannot be read")?,
                }
                write!(
                    f,
                    ": too slow for a cycle of 1 ms, and it cannot be set ({reason}). Say `setserial {} low_latency` or `echo {WANTED} | sudo tee {}`",
                    port.display(),
                    timer.display()
                )
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A made-up /sys with a port, its timer at `text`.
    fn sysfs(text: &str) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let device = folder.path().join("class/tty/ttyUSB9/device");
        fs::create_dir_all(&device).unwrap();
        fs::write(device.join("latency_timer"), text).unwrap();
        (folder, device.join("latency_timer"))
    }

    const PORT: &str = "/dev/ttyUSB9";

    #[test]
    fn a_timer_of_16_ms_is_lowered_to_1_ms() {
        let (folder, timer) = sysfs("16\n");
        assert_eq!(Latency::lower(Path::new(PORT), folder.path()), Latency::Lowered { from: 16 });
        assert_eq!(fs::read_to_string(timer).unwrap(), "1");
        assert_eq!(Latency::lower(Path::new(PORT), folder.path()), Latency::Low);
    }

    #[test]
    fn a_port_without_a_timer_is_left_alone() {
        let (folder, _) = sysfs("16\n");
        assert_eq!(Latency::lower(Path::new("/dev/ttyACM9"), folder.path()), Latency::NoTimer);
    }

    /// A folder in the timer's place: neither root nor anybody can write it.
    #[test]
    fn a_timer_that_cannot_be_set_is_diagnosed_with_the_command_that_sets_it() {
        let (folder, timer) = sysfs("16\n");
        fs::remove_file(&timer).unwrap();
        fs::create_dir(&timer).unwrap();
        let latency = Latency::lower(Path::new(PORT), folder.path());
        assert!(!latency.is_good());
        let said = latency.to_string();
        assert!(said.contains("setserial /dev/ttyUSB9 low_latency"), "{said}");
        assert!(said.contains(&format!("sudo tee {}", timer.display())), "{said}");
    }
}
