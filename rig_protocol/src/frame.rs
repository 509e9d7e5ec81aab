//! A frame: version, kind, payload and CRC, stuffed so that no byte of it is zero, and a zero byte
//! at its end.

use crc::{CRC_32_ISO_HDLC, Crc, Table};

use crate::VERSION;
use crate::wire::{MAX_BODY, TRAILER, Writer};

/// Length of the longest frame on the line \[byte\], its zero byte included. COBS adds one byte to up
/// to 254.
pub const MAX_FRAME: usize = cobs::max_encoding_length(MAX_BODY) + 1;

/// CRC-32/ISO-HDLC, that of Ethernet and zip: of any burst up to 32 bits nothing passes it, of
/// longer garbage one frame in 2^32. The two bytes it has over a 16-bit CRC are a tenth of the
/// shortest command, and what slips through is a voltage.
const CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// The CRC of `bytes`.
pub(crate) fn checksum(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// A message as it goes over the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Frame {
    bytes: [u8; MAX_FRAME],
    length: usize,
}

impl Frame {
    /// The bytes, the zero at the end included.
    #[must_use]
    pub fn as_bytes(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or_default()
    }

    /// The same frame as a speaker of another version would send it: for tests of what becomes of
    /// it.
    #[must_use]
    pub fn of_version(&self, version: u8) -> Self {
        let mut stuffed = self.bytes;
        let plain = stuffed.get_mut(..self.length.saturating_sub(1)).unwrap_or_default();
        let length = cobs::decode_in_place(plain).unwrap_or(0);
        match plain.get(..length).and_then(|body| body.split_last_chunk::<TRAILER>()) {
            Some(([_, kind, payload @ ..], _)) => Self::versioned(version, *kind, |body| {
                for byte in payload {
                    body.put([*byte]);
                }
            }),
            _ => *self,
        }
    }

    /// Wraps the payload that `fill` writes.
    pub(crate) fn new(kind: u8, fill: impl FnOnce(&mut Writer)) -> Self {
        Self::versioned(VERSION, kind, fill)
    }

    /// As [`new`](Self::new), of any version: a device of tomorrow.
    pub(crate) fn versioned(version: u8, kind: u8, fill: impl FnOnce(&mut Writer)) -> Self {
        let mut body = Writer::new();
        body.put([version, kind]);
        fill(&mut body);
        let crc = checksum(body.written());
        body.put(crc.to_le_bytes());
        let mut bytes = [0; MAX_FRAME];
        // A body that fits its buffer fits the stuffed one.
        let stuffed = cobs::try_encode(body.written(), &mut bytes).unwrap_or(0);
        // The array is zeros: the byte behind the stuffed ones ends the frame.
        Self { bytes, length: stuffed + 1 }
    }
}

impl AsRef<[u8]> for Frame {
    fn as_ref(&self) -> &[u8] {
        self.as_bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The check value of the CRC catalogue, and the one zero byte in every frame.
    #[test]
    fn the_crc_is_that_of_ethernet_and_only_the_last_byte_is_zero() {
        assert_eq!(checksum(b"123456789"), 0xCBF4_3926);
        let frame = Frame::new(0x55, |body| {
            body.put([0; crate::wire::MAX_PAYLOAD]);
        });
        assert_eq!(frame.as_bytes().len(), MAX_FRAME);
        assert_eq!(frame.as_bytes().iter().position(|byte| *byte == 0), Some(MAX_FRAME - 1));
    }

    #[test]
    fn another_version_differs_in_the_version_and_the_crc_alone() {
        let frame = Frame::new(0x55, |body| _ = body.put([1, 0, 3]));
        assert_eq!(frame.of_version(VERSION), frame);
        assert_eq!(frame.of_version(9), Frame::versioned(9, 0x55, |body| _ = body.put([1, 0, 3])));
    }

    /// The examples in Cheshire and Baker, Consistent Overhead Byte Stuffing, IEEE/ACM Transactions
    /// on Networking 7 (1999).
    #[test]
    fn the_stuffing_is_the_published_one() {
        for (plain, stuffed) in [
            (&[0x00][..], &[0x01, 0x01][..]),
            (&[0x11, 0x22, 0x00, 0x33], &[0x03, 0x11, 0x22, 0x02, 0x33]),
            (&[0x11, 0x00, 0x00, 0x00], &[0x02, 0x11, 0x01, 0x01, 0x01]),
        ] {
            let mut out = [0; 8];
            let length = cobs::try_encode(plain, &mut out).unwrap();
            assert_eq!(&out[..length], stuffed);
        }
    }
}
