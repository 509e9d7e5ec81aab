//! Opens a session with the device on a port.

use std::{
    hash::{BuildHasher, RandomState},
    time::{Duration, Instant},
};

use rig_protocol::{Decoder, DeviceMessage, Hello, HostMessage, Message, Rejection, Session};

use super::{SerialError, port::Port};

/// Time between two hellos.
const AGAIN: Duration = Duration::from_millis(50);

/// A number that no earlier hello had, in all likelihood.
fn draw() -> Session {
    // The standard library seeds its hashers from the system's randomness.
    let number = RandomState::new().hash_one("hello") as u32;
    Session::new(number).unwrap_or(Session::MIN)
}

/// A session that a device has agreed to.
pub(super) struct Agreed {
    pub(super) session: Session,
    pub(super) hello: Hello,
    pub(super) decoder: Decoder<DeviceMessage>,
    /// What came behind the device's hello.
    pub(super) rest: Vec<u8>,
}

/// Says hello until the device answers, but not longer than `patience`.
pub(super) fn handshake(port: &Port, baud: u32, patience: Duration) -> Result<Agreed, SerialError> {
    let number = draw();
    // Somebody else's session, by the measurements that the device sends to it.
    let mut held = false;
    let mut decoder = Decoder::new();
    let mut buffer = [0; 512];
    let end = Instant::now() + patience;
    // Ends whatever half a frame the device has from before.
    port.send(&[0])?;
    loop {
        let now = Instant::now();
        if now >= end {
            let path = port.path().to_owned();
            let rejections = *decoder.rejections();
            return Err(if held {
                SerialError::Held { path }
            } else if rejections.total() > 0 {
                SerialError::Garbage { path, baud, rejections }
            } else {
                SerialError::NoAnswer { path }
            });
        }
        port.send(HostMessage::Hello { number }.frame().as_bytes())?;
        let again = now + AGAIN;
        while let Some(left) = again.checked_duration_since(Instant::now()) {
            if !port.wait(left)? {
                continue;
            }
            let mut bytes = port.read(&mut buffer)?.iter();
            while let Some(byte) = bytes.next() {
                match decoder.push(*byte) {
                    Ok(Some(DeviceMessage::Hello(hello))) if hello.answers == Some(number) => {
                        // A hello that answers has both numbers, which was checked when it was
                        // read.
                        if let Some(session) = hello.session {
                            return Ok(Agreed {
                                session,
                                hello,
                                decoder,
                                rest: bytes.copied().collect(),
                            });
                        }
                    }
                    Ok(Some(DeviceMessage::Measurement(_))) => held = true,
                    Err(Rejection::Version(theirs)) => {
                        return Err(SerialError::WrongVersion {
                            path: port.path().to_owned(),
                            theirs,
                        });
                    }
                    // From an earlier session, or the rest of a frame from before.
                    Ok(_) | Err(_) => {}
                }
            }
        }
    }
}
