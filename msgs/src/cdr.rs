//! Messages as bytes: plain CDR behind the four bytes of its encapsulation header, as DDS sends and
//! bags keep it.

use byteorder::{BigEndian, LittleEndian};

use crate::RosMessage;

/// Header of little-endian plain CDR, the only one that is written.
const LITTLE_ENDIAN_HEADER: [u8; 4] = [0x00, 0x01, 0x00, 0x00];

/// A message that cannot be turned into bytes, or bytes that are not the message.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CdrError {
    /// The message could not be written.
    #[error("cannot encode a {message}: {source}")]
    Encode {
        /// Type of the message.
        message: String,
        /// What the encoder said.
        source: cdr_encoding::Error,
    },
    /// The bytes stop before the encapsulation header does.
    #[error(
        "a {message} needs at least the 4 bytes of its encapsulation header, but {length} came; the data is cut off"
    )]
    TooShort {
        /// Type that was expected.
        message: String,
        /// How many bytes came.
        length: usize,
    },
    /// The encapsulation is not plain CDR.
    #[error(
        "a {message} was expected in plain CDR (encapsulation 00 00 or 00 01), but the data says {found:02x?}; \
         record it with a ROS 2 middleware that writes plain CDR"
    )]
    Encapsulation {
        /// Type that was expected.
        message: String,
        /// First two bytes that came.
        found: [u8; 2],
    },
    /// The bytes do not follow the type's definition.
    #[error("{length} bytes are not a {message}: {source}; check that the topic carries that type")]
    Decode {
        /// Type that was expected.
        message: String,
        /// How many bytes came.
        length: usize,
        /// What the decoder said.
        source: cdr_encoding::Error,
    },
    /// More bytes than the type has.
    #[error(
        "a {message} of {used} bytes was expected, but {length} came; the sender uses another version of the type"
    )]
    TrailingBytes {
        /// Type that was expected.
        message: String,
        /// Bytes the message takes.
        used: usize,
        /// How many bytes came.
        length: usize,
    },
}

/// Bytes of a message, encapsulation header included.
///
/// # Errors
/// [`CdrError::Encode`] when a string or sequence is longer than CDR can say (2^32 - 1).
pub fn encode<M: RosMessage>(message: &M) -> Result<Vec<u8>, CdrError> {
    let mut bytes = Vec::with_capacity(128);
    encode_into(message, &mut bytes)?;
    Ok(bytes)
}

/// Like [`encode`], into a buffer that is cleared first and can be used again and again.
///
/// # Errors
/// As [`encode`].
pub fn encode_into<M: RosMessage>(message: &M, bytes: &mut Vec<u8>) -> Result<(), CdrError> {
    bytes.clear();
    bytes.extend_from_slice(&LITTLE_ENDIAN_HEADER);
    // CDR aligns to the start of the data behind the header; the serializer counts from its own
    // first byte, which is just there.
    cdr_encoding::to_writer::<M, LittleEndian, _>(&mut *bytes, message)
        .map_err(|source| CdrError::Encode { message: M::type_name(), source })
}

/// The message in the bytes, of either byte order. Up to three bytes of padding at the end are
/// allowed, as DDS adds them.
///
/// # Errors
/// Every other variant of [`CdrError`]: never a panic, and never more memory than a small multiple
/// of the input.
pub fn decode<M: RosMessage>(bytes: &[u8]) -> Result<M, CdrError> {
    let Some((header, body)) = bytes.split_first_chunk::<4>() else {
        return Err(CdrError::TooShort { message: M::type_name(), length: bytes.len() });
    };
    let decoded = match [header[0], header[1]] {
        [0x00, 0x01] => cdr_encoding::from_bytes::<M, LittleEndian>(body),
        [0x00, 0x00] => cdr_encoding::from_bytes::<M, BigEndian>(body),
        found => return Err(CdrError::Encapsulation { message: M::type_name(), found }),
    };
    let (message, used) = decoded.map_err(|source| CdrError::Decode {
        message: M::type_name(),
        length: bytes.len(),
        source,
    })?;
    if body.len() > used + 3 {
        return Err(CdrError::TrailingBytes {
            message: M::type_name(),
            used: used + 4,
            length: bytes.len(),
        });
    }
    Ok(message)
}
