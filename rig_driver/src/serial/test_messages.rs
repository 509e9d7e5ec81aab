//! What tests of this module say.

use rig_protocol::{Cause, Channels, Hello, Measurement, Name, Readings, Session, State};

/// A device with all sensors and cycles of 1 ms.
pub(super) fn hello() -> Hello {
    Hello {
        answers: None,
        session: None,
        name: Name::default(),
        firmware: [0; 3],
        channels: Channels { tachometer: true, potentiometer: true, torque: true, current: true },
        period_us: 1000,
        counts_per_turn: 4000,
        volts_per_count: 0.01,
        voltage_limit: 600,
        tachometer_per_count: -0.5,
        potentiometer_per_count: 0.25,
        torque_per_count: 0.125,
        current_per_count: 2.0,
        validity_limit_us: 20_000,
        host_timeout_us: 250_000,
    }
}

/// A measurement of an active device that was not commanded yet.
pub(super) fn measured() -> Measurement {
    Measurement {
        cycle: 0,
        time_us: 0,
        readings: Readings { encoder: 0, tachometer: 3, potentiometer: 4, torque: -8, current: 5 },
        voltage_asked: 0,
        voltage_applied: 0,
        session: Some(Session::MIN),
        command_sequence: 0,
        refused: 0,
        foreign: 0,
        state: State::Active,
        cause: Cause::None,
        saturated: false,
        expired: false,
    }
}
