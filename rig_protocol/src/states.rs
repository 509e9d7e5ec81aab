//! The device's states and every transition between them: one table.

/// What a device is in. Only in [`State::Active`] can the motor have any voltage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(u8)]
pub enum State {
    /// Zero volts: after start, after a hello, after the host went silent, after a deactivation.
    #[default]
    Inactive = 0,
    /// The motor follows valid commands.
    Active = 1,
    /// Zero volts: a fault is latched until cleared.
    Fault = 2,
    /// Zero volts: an emergency stop is latched until cleared.
    EmergencyStopped = 3,
}

/// What happens to a device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Event {
    /// A host opens a session.
    Hello = 0,
    /// The host of the session activates.
    Activate = 1,
    /// Anybody deactivates, or the host of the session closes it.
    Deactivate = 2,
    /// Nothing came from the host for too long.
    HostLost = 3,
    /// The device finds a fault in itself.
    Fault = 4,
    /// The emergency stop, by message or by switch.
    EmergencyStop = 5,
    /// The host of the session clears what is latched.
    Clear = 6,
}

use State::{Active, EmergencyStopped as Stopped, Fault, Inactive};

/// The state after an event: a row a state, a column an event.
#[rustfmt::skip]
pub const TRANSITIONS: [[State; 7]; 4] = [
    //            Hello     Activate  Deactivate HostLost  Fault    EmergencyStop Clear
    /* Inactive */ [Inactive, Active,   Inactive,  Inactive, Fault,   Stopped,      Inactive],
    /* Active   */ [Inactive, Active,   Inactive,  Inactive, Fault,   Stopped,      Active],
    /* Fault    */ [Fault,    Fault,    Fault,     Fault,    Fault,   Stopped,      Inactive],
    /* Stopped  */ [Stopped,  Stopped,  Stopped,   Stopped,  Stopped, Stopped,      Inactive],
];

impl State {
    /// Every state, in the table's order. (Written out here and below: a firmware builds this crate,
    /// and a derive for three lists would bring it a procedural macro.)
    pub const ALL: [Self; 4] = [Inactive, Active, Fault, Stopped];

    /// The state after `event`.
    #[must_use]
    pub const fn after(self, event: Event) -> Self {
        TRANSITIONS[self as usize][event as usize]
    }

    pub(crate) const fn from_byte(byte: u8) -> Option<Self> {
        match byte {
            0 => Some(Inactive),
            1 => Some(Active),
            2 => Some(Fault),
            3 => Some(Stopped),
            _ => None,
        }
    }
}

impl Event {
    /// Every event, in the table's order.
    pub const ALL: [Self; 7] = [
        Self::Hello,
        Self::Activate,
        Self::Deactivate,
        Self::HostLost,
        Self::Fault,
        Self::EmergencyStop,
        Self::Clear,
    ];
}

/// Why the motor stands still.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(u8)]
pub enum Cause {
    /// It does not, or nothing happened: active, or not activated since the start or since a clear.
    #[default]
    None = 0,
    /// The host deactivated or closed its session, or a host said hello.
    Deactivated = 1,
    /// Nothing came from the host for too long.
    HostLost = 2,
    /// The emergency stop.
    EmergencyStop = 3,
    /// The device's cycle took longer than its period.
    CycleOverrun = 4,
    /// A sensor failed, such as an encoder line that broke.
    Sensor = 5,
    /// The motor's driver stage reports a fault, such as overcurrent.
    DriverStage = 6,
    /// The motor or its driver is too hot.
    Temperature = 7,
    /// The supply voltage is out of its range.
    Supply = 8,
    /// A fault that none of the others names; see the device's documentation.
    Other = 9,
}

impl Cause {
    /// Every cause.
    pub const ALL: [Self; 10] = [
        Self::None,
        Self::Deactivated,
        Self::HostLost,
        Self::EmergencyStop,
        Self::CycleOverrun,
        Self::Sensor,
        Self::DriverStage,
        Self::Temperature,
        Self::Supply,
        Self::Other,
    ];

    pub(crate) fn from_byte(byte: u8) -> Option<Self> {
        Self::ALL.get(usize::from(byte)).copied()
    }

    /// What it means, for people.
    #[must_use]
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::None => "nothing",
            Self::Deactivated => "the host deactivated it",
            Self::HostLost => "its host went silent",
            Self::EmergencyStop => "the emergency stop",
            Self::CycleOverrun => "a cycle longer than its period",
            Self::Sensor => "a sensor's failure",
            Self::DriverStage => "a fault of the motor's driver stage",
            Self::Temperature => "too high a temperature",
            Self::Supply => "a supply voltage out of its range",
            Self::Other => "a fault of the device",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rules in words, over every state and event.
    #[test]
    fn every_transition_obeys_the_rules() {
        for state in State::ALL {
            for event in Event::ALL {
                let after = state.after(event);
                let expected = match (state, event) {
                    // The stop wins over everything, from everywhere.
                    (_, Event::EmergencyStop) => State::EmergencyStopped,
                    // What is latched, only clearing unlatches, and never into motion.
                    (State::EmergencyStopped | State::Fault, Event::Clear) => State::Inactive,
                    (State::EmergencyStopped, _) => State::EmergencyStopped,
                    (_, Event::Fault) => State::Fault,
                    (State::Fault, _) => State::Fault,
                    // Activation is the one way into motion.
                    (_, Event::Activate) => State::Active,
                    // A clear with nothing to clear changes nothing.
                    (state, Event::Clear) => state,
                    (_, Event::Hello | Event::Deactivate | Event::HostLost) => State::Inactive,
                };
                assert_eq!(after, expected, "{state:?} on {event:?}");
                if after == State::Active && state != State::Active {
                    assert_eq!((state, event), (State::Inactive, Event::Activate));
                }
            }
        }
    }

    #[test]
    fn states_and_causes_are_their_own_bytes() {
        for byte in 0..=u8::MAX {
            assert_eq!(State::from_byte(byte).map(|state| state as u8), (byte < 4).then_some(byte));
            assert_eq!(
                Cause::from_byte(byte).map(|cause| cause as u8),
                (byte < 10).then_some(byte)
            );
        }
        for (index, event) in Event::ALL.into_iter().enumerate() {
            assert_eq!(event as usize, index);
        }
    }
}
