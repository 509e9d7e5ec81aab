//! Finds frames in a stream of bytes.

use core::marker::PhantomData;

use crate::wire::{HEADER, TRAILER};
use crate::{
    VERSION,
    frame::{Frame, checksum},
    wire::Reader,
};

/// Room for a stuffed frame. Longer than any of this version, so that a later version's hello is
/// still known as such.
const ROOM: usize = 128;

/// What can be framed: [`HostMessage`](crate::HostMessage) or
/// [`DeviceMessage`](crate::DeviceMessage).
pub trait Message: Sized + sealed::Sealed {
    /// The message as it goes over the line.
    fn frame(&self) -> Frame;
}

pub(crate) mod sealed {
    use super::{Reader, Rejection};

    /// How a direction's messages are read.
    pub trait Sealed: Sized {
        /// Length of the payload of `kind` \[byte\]; none for a kind that this direction does not
        /// have.
        fn length(kind: u8) -> Option<usize>;

        /// Reads a payload of the right length.
        #[expect(private_interfaces, reason = "only this crate reads payloads")]
        fn read(kind: u8, payload: &mut Reader<'_>) -> Result<Self, Rejection>;
    }
}

/// Why a frame was thrown away. The checks come in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Rejection {
    /// No zero byte came in time: garbage, or a wrong baud rate.
    #[error("more bytes without a frame's end than a frame has")]
    TooLong,
    /// The bytes are not what the stuffing makes, or too few for a frame.
    #[error("bytes that are no frame")]
    Framing,
    /// The CRC does not match.
    #[error("wrong CRC")]
    Crc,
    /// The frame is whole, but of another version of the protocol.
    #[error("protocol version {0}, where this program speaks {VERSION}")]
    Version(u8),
    /// A kind that this direction does not have.
    #[error("unknown kind {0:#04x}")]
    Kind(u8),
    /// The payload is not as long as its kind's.
    #[error("{came} bytes of payload for kind {kind:#04x}")]
    Length {
        /// The kind.
        kind: u8,
        /// The payload's length \[byte\].
        came: usize,
    },
    /// A field holds what it may not.
    #[error("a value out of its range in kind {0:#04x}")]
    Value(u8),
}

/// How many frames were thrown away, by reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Rejections {
    /// [`Rejection::TooLong`].
    pub too_long: u32,
    /// [`Rejection::Framing`].
    pub framing: u32,
    /// [`Rejection::Crc`].
    pub crc: u32,
    /// [`Rejection::Version`].
    pub version: u32,
    /// [`Rejection::Kind`].
    pub kind: u32,
    /// [`Rejection::Length`].
    pub length: u32,
    /// [`Rejection::Value`].
    pub value: u32,
}

impl Rejections {
    /// All of them.
    #[must_use]
    pub const fn total(&self) -> u64 {
        let Self { too_long, framing, crc, version, kind, length, value } = *self;
        too_long as u64
            + framing as u64
            + crc as u64
            + version as u64
            + kind as u64
            + length as u64
            + value as u64
    }

    const fn count(&mut self, rejection: &Rejection) {
        let counter = match rejection {
            Rejection::TooLong => &mut self.too_long,
            Rejection::Framing => &mut self.framing,
            Rejection::Crc => &mut self.crc,
            Rejection::Version(_) => &mut self.version,
            Rejection::Kind(_) => &mut self.kind,
            Rejection::Length { .. } => &mut self.length,
            Rejection::Value(_) => &mut self.value,
        };
        *counter = counter.saturating_add(1);
    }
}

/// Finds messages of one direction in a stream, byte by byte, in a fixed buffer.
///
/// After any garbage at most one frame is lost: the one that the garbage runs into.
#[derive(Debug, Clone)]
pub struct Decoder<M> {
    bytes: [u8; ROOM],
    length: usize,
    /// The present frame is longer than the buffer.
    overfull: bool,
    rejections: Rejections,
    message: PhantomData<M>,
}

impl<M> Default for Decoder<M> {
    fn default() -> Self {
        Self::new()
    }
}

impl<M> Decoder<M> {
    /// A decoder at the start of a frame.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            bytes: [0; ROOM],
            length: 0,
            overfull: false,
            rejections: Rejections {
                too_long: 0,
                framing: 0,
                crc: 0,
                version: 0,
                kind: 0,
                length: 0,
                value: 0,
            },
            message: PhantomData,
        }
    }

    /// What was thrown away so far.
    #[must_use]
    pub const fn rejections(&self) -> &Rejections {
        &self.rejections
    }
}

impl<M: Message> Decoder<M> {
    /// Takes the next byte. Returns a message when the byte completes one.
    ///
    /// # Errors
    /// [`Rejection`] when the byte ends a frame that is thrown away. It is counted, and the next
    /// byte starts a new frame.
    pub fn push(&mut self, byte: u8) -> Result<Option<M>, Rejection> {
        if byte != 0 {
            match self.bytes.get_mut(self.length) {
                Some(place) => {
                    *place = byte;
                    self.length += 1;
                }
                None => self.overfull = true,
            }
            return Ok(None);
        }
        let result = if self.overfull {
            Err(Rejection::TooLong)
        } else if self.length == 0 {
            // A zero after a zero: a sender may put one in front of a frame.
            return Ok(None);
        } else {
            parse(self.bytes.get_mut(..self.length).unwrap_or_default())
        };
        (self.length, self.overfull) = (0, false);
        if let Err(rejection) = &result {
            self.rejections.count(rejection);
        }
        result.map(Some)
    }
}

/// Reads a stuffed frame without its zero byte.
fn parse<M: Message>(stuffed: &mut [u8]) -> Result<M, Rejection> {
    let length = cobs::decode_in_place(stuffed).map_err(|_| Rejection::Framing)?;
    let body = stuffed.get(..length).ok_or(Rejection::Framing)?;
    let (content, crc) = body.split_last_chunk::<TRAILER>().ok_or(Rejection::Framing)?;
    let (&[version, kind], payload) =
        content.split_first_chunk::<HEADER>().ok_or(Rejection::Framing)?;
    if checksum(content) != u32::from_le_bytes(*crc) {
        return Err(Rejection::Crc);
    }
    if version != VERSION {
        return Err(Rejection::Version(version));
    }
    let expected = M::length(kind).ok_or(Rejection::Kind(kind))?;
    if payload.len() != expected {
        return Err(Rejection::Length { kind, came: payload.len() });
    }
    M::read(kind, &mut Reader::new(payload))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DeviceMessage, HostMessage, wire::Writer};

    fn fed<M: Message>(decoder: &mut Decoder<M>, bytes: &[u8]) -> Option<Rejection> {
        bytes.iter().find_map(|byte| decoder.push(*byte).err())
    }

    #[test]
    fn every_reason_to_reject_a_frame_is_told_and_counted() {
        let session = |body: &mut Writer| _ = body.put([1, 0, 0, 0]);
        let mut decoder = Decoder::<HostMessage>::new();
        assert_eq!(fed(&mut decoder, &[7; 300]), None);
        assert_eq!(fed(&mut decoder, &[0]), Some(Rejection::TooLong));
        assert_eq!(fed(&mut decoder, &[3, 1, 2, 0]), Some(Rejection::Framing), "too short");
        assert_eq!(
            fed(&mut decoder, &[9, 1, 2, 0]),
            Some(Rejection::Framing),
            "points past its end"
        );
        let good = Frame::new(0x01, session);
        let mut wrong = [0; 16];
        let wrong = &mut wrong[..good.as_bytes().len()];
        wrong.copy_from_slice(good.as_bytes());
        wrong[2] ^= 0x40;
        assert_eq!(fed(&mut decoder, wrong), Some(Rejection::Crc));
        let foreign = Frame::versioned(1, 0x01, session);
        assert_eq!(fed(&mut decoder, foreign.as_bytes()), Some(Rejection::Version(1)));
        assert_eq!(
            fed(&mut decoder, Frame::new(0x33, session).as_bytes()),
            Some(Rejection::Kind(0x33))
        );
        let long = Frame::new(0x01, |body| _ = body.put([1; 5]));
        assert_eq!(
            fed(&mut decoder, long.as_bytes()),
            Some(Rejection::Length { kind: 1, came: 5 })
        );
        let none = Frame::new(0x01, |body| _ = body.put([0; 4]));
        assert_eq!(fed(&mut decoder, none.as_bytes()), Some(Rejection::Value(1)), "session zero");
        assert_eq!(fed(&mut decoder, good.as_bytes()), None);
        let expected = Rejections {
            too_long: 1,
            framing: 2,
            crc: 1,
            version: 1,
            kind: 1,
            length: 1,
            value: 1,
        };
        assert_eq!(*decoder.rejections(), expected);
        assert_eq!(expected.total(), 8);
    }

    #[test]
    fn a_message_of_one_direction_is_unknown_in_the_other() {
        let mut decoder = Decoder::<DeviceMessage>::new();
        let stop = HostMessage::EmergencyStop.frame();
        assert_eq!(fed(&mut decoder, stop.as_bytes()), Some(Rejection::Kind(0x06)));
    }
}
