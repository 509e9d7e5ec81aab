//! From a message to the bytes on the line and back, and what becomes of bytes that were damaged.
//!
//! `cargo run -p rig_protocol --example frames`

use rig_protocol::{Decoder, HostMessage, Message, Origin, Rejection, Session, VoltageCommand};

/// Says one command and hears it, whole and damaged.
pub fn main() {
    // A host that has been granted session 7 commands 250 counts of voltage. The command answers
    // the measurement of cycle 1234 and holds for 20 ms from there.
    let Some(session) = Session::new(7) else { return };
    let command = HostMessage::Voltage(VoltageCommand {
        origin: Origin { session, sequence: 1 },
        answers: 1234,
        voltage: 250,
        validity_us: 20_000,
    });
    let frame = command.frame();
    println!("{} bytes on the line: {:02x?}", frame.as_bytes().len(), frame.as_bytes());

    // A decoder takes byte after byte, wherever the stream begins. No byte of a frame is zero but
    // the last, so a frame that is cut costs itself alone.
    let mut decoder = Decoder::<HostMessage>::new();
    let cut = &frame.as_bytes()[9..];
    let mut heard = Vec::new();
    for &byte in cut.iter().chain(frame.as_bytes()) {
        match decoder.push(byte) {
            Ok(Some(message)) => heard.push(message),
            Ok(None) => {}
            Err(rejection) => println!("thrown away: {rejection}"),
        }
    }
    println!("heard: {heard:?}");
    assert_eq!(heard, [command]);

    // One bit that flips does not pass the CRC, and nothing moves.
    let mut bytes = frame.as_bytes().to_vec();
    bytes[12] ^= 0b1000;
    let said: Vec<_> = bytes.iter().filter_map(|&byte| decoder.push(byte).err()).collect();
    println!("one bit flipped: {said:?}");
    assert_eq!(said, [Rejection::Crc]);
}
