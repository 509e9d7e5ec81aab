//! What viewers are told in bytes, little endian behind an opcode.

use bytes::{BufMut, Bytes, BytesMut};

use crate::Playback;

/// A message of a subscription, with its time [ns since the epoch].
pub(crate) fn message(subscription: u32, time: u64, payload: &[u8]) -> Bytes {
    let mut bytes = BytesMut::with_capacity(13 + payload.len());
    bytes.put_u8(1);
    bytes.put_u32_le(subscription);
    bytes.put_u64_le(time);
    bytes.put_slice(payload);
    bytes.freeze()
}

/// What time it is [ns since the epoch].
pub(crate) fn time(now: u64) -> Bytes {
    let mut bytes = BytesMut::with_capacity(9);
    bytes.put_u8(2);
    bytes.put_u64_le(now);
    bytes.freeze()
}

/// The answer to a call, as JSON.
pub(crate) fn answer(service: u32, call: u32, payload: &[u8]) -> Bytes {
    let mut bytes = BytesMut::with_capacity(17 + payload.len());
    bytes.put_u8(3);
    bytes.put_u32_le(service);
    bytes.put_u32_le(call);
    bytes.put_u32_le(4);
    bytes.put_slice(b"json");
    bytes.put_slice(payload);
    bytes.freeze()
}

/// How a recording is played.
pub(crate) fn playback(playback: &Playback) -> Bytes {
    let mut bytes = BytesMut::with_capacity(19 + playback.id.len());
    bytes.put_u8(5);
    bytes.put_u8(playback.status as u8);
    bytes.put_u64_le(playback.now);
    bytes.put_f32_le(playback.speed);
    bytes.put_u8(playback.sought.into());
    bytes.put_u32_le(u32::try_from(playback.id.len()).unwrap_or(0));
    bytes.put_slice(playback.id.as_bytes());
    bytes.freeze()
}
