//! Books on what voltage the motor had when, kept apart from the device that decides it.

use rig_protocol::{Refusal, Rejections, State};
use serde::Serialize;

use crate::line::Fates;

/// Messages that the device refused, by reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub(crate) struct Refusals {
    other_session: u64,
    held: u64,
    latched: u64,
    not_active: u64,
    not_newer: u64,
    too_far_ahead: u64,
    stale: u64,
    from_the_future: u64,
}

/// Frames that the device's decoder threw away, by reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub(crate) struct Rejected {
    too_long: u32,
    framing: u32,
    crc: u32,
    version: u32,
    kind: u32,
    length: u32,
    value: u32,
}

impl From<&Rejections> for Rejected {
    fn from(rejections: &Rejections) -> Self {
        let Rejections { too_long, framing, crc, version, kind, length, value } = *rejections;
        Self { too_long, framing, crc, version, kind, length, value }
    }
}

/// The motor's story in cycles of the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub(crate) struct Books {
    /// Cycles of the device.
    pub(crate) cycles: u64,
    /// Cycles that began a whole period late, because the machine was busy.
    pub(crate) late_cycles: u64,
    /// Sessions that hosts have opened.
    pub(crate) sessions: u64,
    /// Times that the device went active.
    pub(crate) activations: u64,
    /// Restarts of the device.
    pub(crate) reboots: u64,
    /// Commands accepted.
    pub(crate) commands: u64,
    /// Cycles with other than zero volts.
    pub(crate) driven: u64,
    /// Cycles with other than zero volts since the last accepted command came.
    pub(crate) driven_since_command: u64,
    /// The most that `driven_since_command` ever was: it may not exceed the validity.
    pub(crate) longest_drive_after_a_command: u64,
    /// The most cycles from a measurement to a cycle with the voltage that answers it: it may not
    /// exceed the validity.
    pub(crate) longest_drive_after_a_measurement: u64,
    /// Cycles with other than zero volts after a stop, a deactivation, a hello or a restart and
    /// before the next activation: none are allowed.
    pub(crate) driven_without_permission: u64,
    /// Cycles with the last command expired while active.
    pub(crate) expired: u64,
    /// Refused messages.
    pub(crate) refusals: Refusals,
}

impl Books {
    /// An accepted command came.
    pub(crate) const fn command(&mut self) {
        self.commands += 1;
        self.driven_since_command = 0;
    }

    /// A message was refused.
    pub(crate) const fn refusal(&mut self, refusal: Refusal) {
        let counter = match refusal {
            Refusal::OtherSession => &mut self.refusals.other_session,
            Refusal::Held => &mut self.refusals.held,
            Refusal::Latched => &mut self.refusals.latched,
            Refusal::NotActive => &mut self.refusals.not_active,
            Refusal::NotNewer => &mut self.refusals.not_newer,
            Refusal::TooFarAhead => &mut self.refusals.too_far_ahead,
            Refusal::Stale => &mut self.refusals.stale,
            Refusal::FromTheFuture => &mut self.refusals.from_the_future,
        };
        *counter += 1;
    }

    /// A cycle has begun with `voltage` on the motor. `age` is the cycles since the measurement
    /// that the last accepted command answers.
    pub(crate) fn cycle(&mut self, voltage: i16, permitted: bool, age: Option<u32>) {
        self.cycles += 1;
        if voltage == 0 {
            return;
        }
        self.driven += 1;
        self.driven_since_command += 1;
        self.longest_drive_after_a_command =
            self.longest_drive_after_a_command.max(self.driven_since_command);
        // A voltage without a command would be as bad as one of any age.
        let age = age.map_or(u64::MAX, u64::from);
        self.longest_drive_after_a_measurement = self.longest_drive_after_a_measurement.max(age);
        self.driven_without_permission += u64::from(!permitted);
    }
}

/// Everything there is to tell.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Summary {
    /// The device's limit of a command's validity \[cycle\].
    pub(crate) validity_limit_cycles: u32,
    /// The motor's story.
    pub(crate) books: Books,
    /// The device's state now.
    pub(crate) state: &'static str,
    /// The voltage on the motor now \[count\].
    pub(crate) voltage: i16,
    /// Frames from the host.
    pub(crate) from_host: Fates,
    /// Frames from the device.
    pub(crate) from_device: Fates,
    /// What the device's decoder threw away.
    pub(crate) rejected: Rejected,
}

pub(crate) const fn name(state: State) -> &'static str {
    match state {
        State::Inactive => "inactive",
        State::Active => "active",
        State::Fault => "fault",
        State::EmergencyStopped => "emergency_stopped",
    }
}
