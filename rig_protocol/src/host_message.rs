//! What the host says.

use crate::{
    Frame, Session,
    decoder::{Message, Rejection, sealed::Sealed},
    wire::Reader,
};

const HELLO: u8 = 0x01;
const VOLTAGE: u8 = 0x02;
const HEARTBEAT: u8 = 0x03;
const ACTIVATE: u8 = 0x04;
const DEACTIVATE: u8 = 0x05;
const EMERGENCY_STOP: u8 = 0x06;
const CLEAR: u8 = 0x07;

/// The voltage for the motor, and for how long it may be believed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VoltageCommand {
    /// Number of the command, one more each time, with wrap-around. A number that is not newer is refused.
    pub sequence: u32,
    /// Cycle of the measurement that this command answers. The validity counts from there, on the device's own clock: what lay in
    /// a buffer for too long is old when it arrives.
    pub answers: u32,
    /// The voltage [count of the voltage output].
    pub voltage: i16,
    /// How long after the measurement the voltage may be applied [us]. The device cuts it to its own limit.
    pub validity_us: u32,
}

/// A message from the host to the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HostMessage {
    /// Opens a session: the motor goes to zero volts, the device says [`Hello`](crate::Hello) and sends measurements from now on.
    Hello {
        /// The session to be.
        session: Session,
    },
    /// A voltage for the motor.
    Voltage(VoltageCommand),
    /// The host is there, though it has no voltage to command.
    Heartbeat {
        /// The session.
        session: Session,
    },
    /// The motor may move. Refused while a fault or an emergency stop is latched.
    Activate {
        /// The session.
        session: Session,
    },
    /// The motor goes to zero volts and stays there. From anybody.
    Deactivate,
    /// The motor goes to zero volts and stays there until cleared. From anybody.
    EmergencyStop,
    /// Clears a latched fault or emergency stop. The motor stays at zero volts until activated.
    Clear {
        /// The session.
        session: Session,
    },
}

impl Message for HostMessage {
    fn frame(&self) -> Frame {
        let with_session = |kind, session: Session| {
            Frame::new(kind, |body| {
                body.put(session.get().to_le_bytes());
            })
        };
        match *self {
            Self::Hello { session } => with_session(HELLO, session),
            Self::Voltage(VoltageCommand { sequence, answers, voltage, validity_us }) => {
                Frame::new(VOLTAGE, |body| {
                    body.put(sequence.to_le_bytes())
                        .put(answers.to_le_bytes())
                        .put(voltage.to_le_bytes())
                        .put(validity_us.to_le_bytes());
                })
            }
            Self::Heartbeat { session } => with_session(HEARTBEAT, session),
            Self::Activate { session } => with_session(ACTIVATE, session),
            Self::Deactivate => Frame::new(DEACTIVATE, |_| ()),
            Self::EmergencyStop => Frame::new(EMERGENCY_STOP, |_| ()),
            Self::Clear { session } => with_session(CLEAR, session),
        }
    }
}

impl Sealed for HostMessage {
    fn length(kind: u8) -> Option<usize> {
        match kind {
            HELLO | HEARTBEAT | ACTIVATE | CLEAR => Some(4),
            VOLTAGE => Some(14),
            DEACTIVATE | EMERGENCY_STOP => Some(0),
            _ => None,
        }
    }

    #[expect(private_interfaces, reason = "only this crate reads payloads")]
    fn read(kind: u8, payload: &mut Reader<'_>) -> Result<Self, Rejection> {
        let session = |payload: &mut Reader<'_>| Session::new(payload.u32()).ok_or(Rejection::Value(kind));
        match kind {
            HELLO => Ok(Self::Hello { session: session(payload)? }),
            VOLTAGE => Ok(Self::Voltage(VoltageCommand {
                sequence: payload.u32(),
                answers: payload.u32(),
                voltage: payload.i16(),
                validity_us: payload.u32(),
            })),
            HEARTBEAT => Ok(Self::Heartbeat { session: session(payload)? }),
            ACTIVATE => Ok(Self::Activate { session: session(payload)? }),
            DEACTIVATE => Ok(Self::Deactivate),
            EMERGENCY_STOP => Ok(Self::EmergencyStop),
            CLEAR => Ok(Self::Clear { session: session(payload)? }),
            other => Err(Rejection::Kind(other)),
        }
    }
}
