//! Little-endian numbers in a payload.

/// Length of the longest payload \[byte\]: that of the device's hello.
pub(crate) const MAX_PAYLOAD: usize = 66;
/// Version and kind in front of a payload \[byte\].
pub(crate) const HEADER: usize = 2;
/// CRC behind a payload \[byte\].
pub(crate) const TRAILER: usize = 4;
/// Length of the longest frame before it is stuffed \[byte\].
pub(crate) const MAX_BODY: usize = HEADER + MAX_PAYLOAD + TRAILER;

/// A frame's body while it is put together. What does not fit is left out; the longest message
/// fits, which a test shows.
pub(crate) struct Writer {
    bytes: [u8; MAX_BODY],
    length: usize,
}

impl Writer {
    pub(crate) const fn new() -> Self {
        Self { bytes: [0; MAX_BODY], length: 0 }
    }

    pub(crate) fn put<const N: usize>(&mut self, bytes: [u8; N]) -> &mut Self {
        let end = self.length + N;
        debug_assert!(end <= MAX_BODY, "a message of more than {MAX_BODY} bytes");
        if let Some(place) = self.bytes.get_mut(self.length..end) {
            place.copy_from_slice(&bytes);
            self.length = end;
        }
        self
    }

    pub(crate) fn written(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or_default()
    }
}

/// What is left of a payload.
pub(crate) struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    pub(crate) const fn new(payload: &'a [u8]) -> Self {
        Self(payload)
    }

    /// The next `N` bytes; zeros past the end. The decoder has compared the payload's length with
    /// its kind's before.
    pub(crate) fn take<const N: usize>(&mut self) -> [u8; N] {
        match self.0.split_first_chunk::<N>() {
            Some((bytes, rest)) => {
                self.0 = rest;
                *bytes
            }
            None => [0; N],
        }
    }

    pub(crate) fn u8(&mut self) -> u8 {
        let [byte] = self.take();
        byte
    }

    pub(crate) fn u16(&mut self) -> u16 {
        u16::from_le_bytes(self.take())
    }

    pub(crate) fn i16(&mut self) -> i16 {
        i16::from_le_bytes(self.take())
    }

    pub(crate) fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    pub(crate) fn i32(&mut self) -> i32 {
        i32::from_le_bytes(self.take())
    }

    pub(crate) fn u64(&mut self) -> u64 {
        u64::from_le_bytes(self.take())
    }

    pub(crate) fn f32(&mut self) -> f32 {
        f32::from_le_bytes(self.take())
    }
}
