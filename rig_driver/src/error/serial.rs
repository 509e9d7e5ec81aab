//! What can go wrong on a serial line.

use std::path::PathBuf;

use rig_protocol::{Cause, Rejections, State, VERSION};

/// A rig on a serial line that cannot be opened or driven.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SerialError {
    /// An option lies outside its range.
    #[error("{name} must be {expected}, but is {came}")]
    Option {
        /// The option.
        name: &'static str,
        /// What was expected.
        expected: &'static str,
        /// What came.
        came: String,
    },
    /// The port does not open.
    #[error("cannot open the serial port {}: {reason}; see `ls /dev/serial/by-id` for what is plugged in, and whether your user is in the group that owns it (often `dialout`)", path.display())]
    Open {
        /// The port.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// The path is no serial port.
    #[error("{} is no serial port; give the path of one, such as /dev/ttyACM0 or /dev/serial/by-id/...", path.display())]
    NotATerminal {
        /// The path.
        path: PathBuf,
    },
    /// Another program drives the rig.
    #[error("another program uses {}; end it first (`fuser {}` names it)", path.display(), path.display())]
    Busy {
        /// The port.
        path: PathBuf,
    },
    /// The port does not take its settings.
    #[error("the serial port {} does not take {baud} baud, 8N1, raw: {reason}", path.display())]
    Settings {
        /// The port.
        path: PathBuf,
        /// Baud rate asked for.
        baud: u32,
        /// What the system said.
        reason: String,
    },
    /// Nothing answers.
    #[error("nothing on {} answers; check that the device has power and that its firmware speaks this protocol (PROTOCOL.md)", path.display())]
    NoAnswer {
        /// The port.
        path: PathBuf,
    },
    /// Something answers, but in another language.
    #[error("what comes from {} at {baud} baud is not this protocol ({} frames thrown away, {} by their CRC); check the baud rate and which device this is", path.display(), rejections.total(), rejections.crc)]
    Garbage {
        /// The port.
        path: PathBuf,
        /// Baud rate.
        baud: u32,
        /// What was thrown away.
        rejections: Rejections,
    },
    /// The device speaks another version of the protocol.
    #[error("the device on {} speaks version {theirs} of the protocol, and this program version {VERSION}; {}", path.display(), update(*theirs))]
    WrongVersion {
        /// The port.
        path: PathBuf,
        /// The device's version.
        theirs: u8,
    },
    /// The device obeys another host, and goes on doing so.
    #[error("the device on {} has another host, which is alive: it grants one session at a time; end that program first (`fuser {}` names it), or wait for the device's host timeout if it has just been killed", path.display(), path.display())]
    Held {
        /// The port.
        path: PathBuf,
    },
    /// The device has granted its session to another host, while this one was silent for too long.
    #[error("the device on {} has another host now, which came while this program was silent for longer than the device's host timeout; end that one (`fuser {}` names it), then clear and activate", path.display(), path.display())]
    TakenOver {
        /// The port.
        path: PathBuf,
    },
    /// The device does not say that it stopped.
    #[error("the device on {} did not say within {milliseconds} ms that it stopped; it is told again every 10 ms. Take the motor's power away if it moves", path.display())]
    StopNotAcknowledged {
        /// The port.
        path: PathBuf,
        /// How long \[ms\].
        milliseconds: u64,
    },
    /// The line is gone: unplugged, or the device lost power.
    #[error("the device on {} is gone ({reason}); it comes back by itself when plugged in, with the motor at zero volts until activated again", path.display())]
    Disconnected {
        /// The port.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// The line is there, but no measurement came.
    #[error("no measurement came from {} for {milliseconds} ms, though the port is open; the device hangs or the cable is broken", path.display())]
    Silent {
        /// The port.
        path: PathBuf,
        /// How long \[ms\].
        milliseconds: u64,
    },
    /// The device started anew.
    #[error("the device on {} has restarted; the motor is at zero volts until activated again, and its encoder counts from zero", path.display())]
    Restarted {
        /// The port.
        path: PathBuf,
    },
    /// The motor may not move.
    #[error("the device does not let the motor move: it is {} because of {}; {}", name(*state), cause.meaning(), remedy(*state))]
    NotActive {
        /// The device's state.
        state: State,
        /// Why.
        cause: Cause,
    },
    /// The reader thread does not start.
    #[error("a thread cannot be started: {reason}")]
    Thread {
        /// What the system said.
        reason: String,
    },
}

impl SerialError {
    /// Whether it is the line that failed, or the time on this machine, and neither the motor nor
    /// somebody else's wish: the line may be opened anew.
    #[must_use]
    pub const fn is_of_the_line(&self) -> bool {
        matches!(
            self,
            Self::Silent { .. }
                | Self::Disconnected { .. }
                | Self::Restarted { .. }
                | Self::NoAnswer { .. }
                | Self::NotActive { state: State::Inactive, cause: Cause::HostLost }
        )
    }

    /// Whether whoever named the rig can mend it: another port or baud rate, a device that speaks
    /// this protocol. What the right device fails at is no such thing.
    #[must_use]
    pub const fn is_bad_input(&self) -> bool {
        match self {
            Self::Option { .. }
            | Self::Open { .. }
            | Self::NotATerminal { .. }
            | Self::Settings { .. }
            | Self::Garbage { .. }
            | Self::WrongVersion { .. } => true,
            Self::Busy { .. }
            | Self::NoAnswer { .. }
            | Self::Held { .. }
            | Self::TakenOver { .. }
            | Self::StopNotAcknowledged { .. }
            | Self::Disconnected { .. }
            | Self::Silent { .. }
            | Self::Restarted { .. }
            | Self::NotActive { .. }
            | Self::Thread { .. } => false,
        }
    }
}

const fn name(state: State) -> &'static str {
    match state {
        State::Inactive => "inactive",
        State::Active => "active",
        State::Fault => "in a latched fault",
        State::EmergencyStopped => "in a latched emergency stop",
    }
}

/// Which side is older, and how it is brought up to date.
const fn update(theirs: u8) -> &'static str {
    if theirs < VERSION {
        "update the device: build its firmware anew with this program's rig_protocol (its example `firmware` shows what changed, docs/how-to/write-firmware.md how)"
    } else {
        "update this program"
    }
}

const fn remedy(state: State) -> &'static str {
    match state {
        State::Inactive | State::Active => "activate it again",
        State::Fault | State::EmergencyStopped => "mend that, clear it, then activate",
    }
}
