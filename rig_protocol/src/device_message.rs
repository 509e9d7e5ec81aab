//! What the device says.

use crate::{
    Cause, Frame, Hello, Measurement, State,
    decoder::{Message, Rejection, sealed::Sealed},
    hello, measurement,
    wire::Reader,
};

const HELLO: u8 = 0x81;
const MEASUREMENT: u8 = 0x82;
const FAULT: u8 = 0x83;

/// Why the motor went to zero volts, when.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FaultReport {
    /// The device's cycle in which it happened.
    pub cycle: u32,
    /// Why.
    pub cause: Cause,
    /// The state since.
    pub state: State,
}

/// A message from the device to the host.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DeviceMessage {
    /// What the device is and how it scales.
    Hello(Hello),
    /// One cycle's readings.
    Measurement(Measurement),
    /// The motor went to zero volts by the device's own decision.
    Fault(FaultReport),
}

impl Message for DeviceMessage {
    fn frame(&self) -> Frame {
        match self {
            Self::Hello(hello) => Frame::new(HELLO, |body| hello.write(body)),
            Self::Measurement(measurement) => {
                Frame::new(MEASUREMENT, |body| measurement.write(body))
            }
            Self::Fault(FaultReport { cycle, cause, state }) => Frame::new(FAULT, |body| {
                body.put(cycle.to_le_bytes()).put([*cause as u8, *state as u8]);
            }),
        }
    }
}

impl Sealed for DeviceMessage {
    fn length(kind: u8) -> Option<usize> {
        match kind {
            HELLO => Some(hello::LENGTH),
            MEASUREMENT => Some(measurement::LENGTH),
            FAULT => Some(6),
            _ => None,
        }
    }

    #[expect(private_interfaces, reason = "only this crate reads payloads")]
    fn read(kind: u8, payload: &mut Reader<'_>) -> Result<Self, Rejection> {
        let value = Rejection::Value(kind);
        match kind {
            HELLO => Hello::read(payload).map(Self::Hello).ok_or(value),
            MEASUREMENT => Measurement::read(payload).map(Self::Measurement).ok_or(value),
            FAULT => {
                let cycle = payload.u32();
                let cause = Cause::from_byte(payload.u8()).ok_or(value)?;
                let state = State::from_byte(payload.u8()).ok_or(value)?;
                Ok(Self::Fault(FaultReport { cycle, cause, state }))
            }
            other => Err(Rejection::Kind(other)),
        }
    }
}
