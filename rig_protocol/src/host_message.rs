//! What the host says.

use crate::{
    Frame, Session,
    decoder::{Message, Rejection, sealed::Sealed},
    wire::{Reader, Writer},
};

const HELLO: u8 = 0x01;
const VOLTAGE: u8 = 0x02;
const HEARTBEAT: u8 = 0x03;
const ACTIVATE: u8 = 0x04;
const DEACTIVATE: u8 = 0x05;
const EMERGENCY_STOP: u8 = 0x06;
const CLEAR: u8 = 0x07;
const CLOSE: u8 = 0x08;

/// Of which session a message is, and its number in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Origin {
    /// The session that the device granted.
    pub session: Session,
    /// Number of the message in its session, from 1, one more each time; after 2^32 - 1 comes 1.
    /// The device takes only numbers that are newer than the last, by at most
    /// [`WINDOW`](crate::WINDOW).
    pub sequence: u32,
}

impl Origin {
    fn write(self, body: &mut Writer) -> &mut Writer {
        body.put(self.session.get().to_le_bytes()).put(self.sequence.to_le_bytes())
    }

    fn read(payload: &mut Reader<'_>) -> Option<Self> {
        let session = Session::new(payload.u32());
        let sequence = payload.u32();
        Some(Self { session: session?, sequence })
    }
}

/// The voltage for the motor, and for how long it may be believed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VoltageCommand {
    /// Session and number.
    pub origin: Origin,
    /// Cycle of the measurement that this command answers. The validity counts from there, on the
    /// device's own clock: what lay in a buffer for too long is old when it arrives.
    pub answers: u32,
    /// The voltage \[count of the voltage output\].
    pub voltage: i16,
    /// How long after the measurement the voltage may be applied \[us\]. The device cuts it to its
    /// own limit.
    pub validity_us: u32,
}

/// A message from the host to the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HostMessage {
    /// Asks for a session: the motor goes to zero volts, the device says [`Hello`](crate::Hello)
    /// with the session that it grants, and sends measurements from now on. Refused while another
    /// host is alive.
    Hello {
        /// A number that the host draws at random: the device repeats it in its answer.
        number: Session,
    },
    /// A voltage for the motor.
    Voltage(VoltageCommand),
    /// The host is there, though it has no voltage to command.
    Heartbeat(Origin),
    /// The motor may move. Refused while a fault or an emergency stop is latched.
    Activate(Origin),
    /// The motor goes to zero volts and stays there. From anybody.
    Deactivate,
    /// The motor goes to zero volts and stays there until cleared. From anybody.
    EmergencyStop,
    /// Clears a latched fault or emergency stop. The motor stays at zero volts until activated.
    Clear(Origin),
    /// Ends the session: the motor goes to zero volts, and another host may say hello at once.
    Close(Origin),
}

impl Message for HostMessage {
    fn frame(&self) -> Frame {
        let with_origin = |kind, origin: Origin| Frame::new(kind, |body| _ = origin.write(body));
        match *self {
            Self::Hello { number } => {
                Frame::new(HELLO, |body| _ = body.put(number.get().to_le_bytes()))
            }
            Self::Voltage(VoltageCommand { origin, answers, voltage, validity_us }) => {
                Frame::new(VOLTAGE, |body| {
                    origin
                        .write(body)
                        .put(answers.to_le_bytes())
                        .put(voltage.to_le_bytes())
                        .put(validity_us.to_le_bytes());
                })
            }
            Self::Heartbeat(origin) => with_origin(HEARTBEAT, origin),
            Self::Activate(origin) => with_origin(ACTIVATE, origin),
            Self::Deactivate => Frame::new(DEACTIVATE, |_| ()),
            Self::EmergencyStop => Frame::new(EMERGENCY_STOP, |_| ()),
            Self::Clear(origin) => with_origin(CLEAR, origin),
            Self::Close(origin) => with_origin(CLOSE, origin),
        }
    }
}

impl Sealed for HostMessage {
    fn length(kind: u8) -> Option<usize> {
        match kind {
            HELLO => Some(4),
            HEARTBEAT | ACTIVATE | CLEAR | CLOSE => Some(8),
            VOLTAGE => Some(18),
            DEACTIVATE | EMERGENCY_STOP => Some(0),
            _ => None,
        }
    }

    #[expect(private_interfaces, reason = "only this crate reads payloads")]
    fn read(kind: u8, payload: &mut Reader<'_>) -> Result<Self, Rejection> {
        let origin = |payload: &mut Reader<'_>| Origin::read(payload).ok_or(Rejection::Value(kind));
        match kind {
            HELLO => {
                let number = Session::new(payload.u32()).ok_or(Rejection::Value(kind))?;
                Ok(Self::Hello { number })
            }
            VOLTAGE => Ok(Self::Voltage(VoltageCommand {
                origin: origin(payload)?,
                answers: payload.u32(),
                voltage: payload.i16(),
                validity_us: payload.u32(),
            })),
            HEARTBEAT => Ok(Self::Heartbeat(origin(payload)?)),
            ACTIVATE => Ok(Self::Activate(origin(payload)?)),
            DEACTIVATE => Ok(Self::Deactivate),
            EMERGENCY_STOP => Ok(Self::EmergencyStop),
            CLEAR => Ok(Self::Clear(origin(payload)?)),
            CLOSE => Ok(Self::Close(origin(payload)?)),
            other => Err(Rejection::Kind(other)),
        }
    }
}
