//! One cycle's readings as they go over the line.

use crate::{Cause, Session, State, wire::Reader, wire::Writer};

/// Length on the line before framing \[byte\].
pub(crate) const LENGTH: usize = 51;

const SATURATED: u8 = 1;
const EXPIRED: u8 = 2;

/// What the device's converters read in one cycle. A channel that the device does not have is 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Readings {
    /// Encoder \[count\], with wrap-around.
    pub encoder: i32,
    /// Tachometer \[count\].
    pub tachometer: i32,
    /// Potentiometer \[count\].
    pub potentiometer: i32,
    /// Torque sensor \[count\].
    pub torque: i32,
    /// Motor current \[count\].
    pub current: i32,
}

/// One cycle: readings, what the motor got, and how the device is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Measurement {
    /// Number of the device's cycle, one more each cycle, with wrap-around.
    pub cycle: u32,
    /// The device's clock at the readings \[us\]; it never wraps.
    pub time_us: u64,
    /// The converters.
    pub readings: Readings,
    /// Voltage that the last accepted command asked for \[count\].
    pub voltage_asked: i16,
    /// Voltage on the motor until these readings \[count\].
    pub voltage_applied: i16,
    /// The session whose commands the device takes.
    pub session: Option<Session>,
    /// Number of the last command that was accepted since the activation; 0 before the first.
    pub command_sequence: u32,
    /// Messages of the session refused since the device started, with wrap-around.
    pub refused: u16,
    /// Whole frames that were not the session's, since the device started, with wrap-around: of
    /// another session, of another version, or without meaning. Noise makes none of them; somebody
    /// else writes to the line.
    pub foreign: u16,
    /// The device's state.
    pub state: State,
    /// Why the motor stands still; [`Cause::None`] while active.
    pub cause: Cause,
    /// The voltage asked for was beyond the limit and was cut.
    pub saturated: bool,
    /// The last command is older than its validity: the motor is at zero volts until the next.
    pub expired: bool,
}

impl Measurement {
    pub(crate) fn write(&self, body: &mut Writer) {
        let Readings { encoder, tachometer, potentiometer, torque, current } = self.readings;
        body.put(self.cycle.to_le_bytes()).put(self.time_us.to_le_bytes());
        for reading in [encoder, tachometer, potentiometer, torque, current] {
            body.put(reading.to_le_bytes());
        }
        body.put(self.voltage_asked.to_le_bytes())
            .put(self.voltage_applied.to_le_bytes())
            .put(self.session.map_or(0, Session::get).to_le_bytes())
            .put(self.command_sequence.to_le_bytes())
            .put(self.refused.to_le_bytes())
            .put(self.foreign.to_le_bytes())
            .put([self.state as u8, self.cause as u8])
            .put([(u8::from(self.saturated) * SATURATED) | (u8::from(self.expired) * EXPIRED)]);
    }

    pub(crate) fn read(payload: &mut Reader<'_>) -> Option<Self> {
        let (cycle, time_us) = (payload.u32(), payload.u64());
        let readings = Readings {
            encoder: payload.i32(),
            tachometer: payload.i32(),
            potentiometer: payload.i32(),
            torque: payload.i32(),
            current: payload.i32(),
        };
        let (voltage_asked, voltage_applied) = (payload.i16(), payload.i16());
        let (session, command_sequence) = (Session::new(payload.u32()), payload.u32());
        let (refused, foreign) = (payload.u16(), payload.u16());
        let state = State::from_byte(payload.u8())?;
        let cause = Cause::from_byte(payload.u8())?;
        let flags = payload.u8();
        if flags & !(SATURATED | EXPIRED) != 0 {
            return None;
        }
        Some(Self {
            cycle,
            time_us,
            readings,
            voltage_asked,
            voltage_applied,
            session,
            command_sequence,
            refused,
            foreign,
            state,
            cause,
            saturated: flags & SATURATED != 0,
            expired: flags & EXPIRED != 0,
        })
    }
}
