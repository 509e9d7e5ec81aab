//! What viewers say in bytes.

use crate::PlaybackRequest;

/// One thing that a viewer says.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Bytes<'a> {
    /// A message on a channel of its own.
    Message { channel: u32, payload: &'a [u8] },
    /// A call.
    Call { service: u32, call: u32, encoding: &'a str, payload: &'a [u8] },
    /// Play, pause, seek.
    Play(PlaybackRequest),
}

/// Reads it; `None` for what is nothing of the kind.
pub(crate) fn read(bytes: &[u8]) -> Option<Bytes<'_>> {
    let mut rest = Rest(bytes);
    match rest.u8()? {
        1 => Some(Bytes::Message { channel: rest.u32()?, payload: rest.0 }),
        2 => {
            let (service, call) = (rest.u32()?, rest.u32()?);
            let encoding = rest.text()?;
            Some(Bytes::Call { service, call, encoding, payload: rest.0 })
        }
        3 => {
            let play = match rest.u8()? {
                0 => true,
                1 => false,
                _ => return None,
            };
            let speed = f32::from_bits(rest.u32()?);
            let has_seek = rest.u8()? != 0;
            let seek = rest.u64()?;
            let id = rest.text()?.to_owned();
            let seek = has_seek.then_some(seek);
            Some(Bytes::Play(PlaybackRequest { play, speed, seek, id }))
        }
        _ => None,
    }
}

/// What is not read yet.
struct Rest<'a>(&'a [u8]);

impl<'a> Rest<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    fn u8(&mut self) -> Option<u8> {
        Some(self.take(1)?[0])
    }

    fn u32(&mut self) -> Option<u32> {
        Some(u32::from_le_bytes(self.take(4)?.try_into().ok()?))
    }

    fn u64(&mut self) -> Option<u64> {
        Some(u64::from_le_bytes(self.take(8)?.try_into().ok()?))
    }

    fn text(&mut self) -> Option<&'a str> {
        let length = usize::try_from(self.u32()?).ok()?;
        std::str::from_utf8(self.take(length)?).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_call_is_read() {
        let bytes = b"\x02\x05\0\0\0\x06\0\0\0\x04\0\0\0json{}";
        assert_eq!(
            read(bytes),
            Some(Bytes::Call { service: 5, call: 6, encoding: "json", payload: b"{}" })
        );
    }

    #[test]
    fn nothing_panics_whatever_is_cut() {
        let whole = b"\x03\0\0\0\x80\x3f\x01\x09\0\0\0\0\0\0\0\x02\0\0\0ab";
        assert!(matches!(read(whole), Some(Bytes::Play(request)) if request.seek == Some(9)));
        for length in 0..whole.len() {
            assert_eq!(read(&whole[..length]), None);
        }
        assert_eq!(read(b"\x02\0\0\0\0\0\0\0\0\xff\xff\xff\xffx"), None);
        assert_eq!(read(b"\x09"), None);
    }
}
