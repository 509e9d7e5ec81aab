//! A board's loop, run on the host: a device that answers hello, is activated, drives one command,
//! and stops by itself when no further command comes.
//!
//! `examples/firmware.rs` is the same for a real board, with clock, sensors and faults.
//! `cargo run -p rig_protocol --example board_loop`

use rig_protocol::{
    Channels, Decoder, Device, DeviceMessage, Hello, HelloError, HostMessage, Inputs, Message,
    Name, Origin, Readings, Session, VoltageCommand,
};

/// What the board is; scales turn counts of its converters into SI units.
fn description() -> Hello {
    Hello {
        answers: None,
        session: None,
        name: Name::new("bench").unwrap_or_default(),
        firmware: [0, 1, 0],
        channels: Channels::default(),
        period_us: 1000,
        counts_per_turn: 4096,
        volts_per_count: 0.012,
        voltage_limit: 500,
        tachometer_per_count: 0.0,
        potentiometer_per_count: 0.0,
        torque_per_count: 0.0,
        current_per_count: 0.0,
        validity_limit_us: 20_000,
        host_timeout_us: 250_000,
    }
}

/// One cycle: hear, decide, drive, report. Returns the motor's voltage \[count\].
fn cycle(
    device: &mut Device,
    decoder: &mut Decoder<HostMessage>,
    heard: &[u8],
    said: &mut Vec<DeviceMessage>,
) -> i16 {
    for &byte in heard {
        match decoder.push(byte) {
            Ok(Some(message)) => {
                // A message that may not be is counted, and nothing comes of it.
                if let Ok(Some(answer)) = device.receive(&message) {
                    said.push(answer);
                }
            }
            Ok(None) => {}
            Err(rejection) => device.reject(&rejection),
        }
    }
    let output = device.tick(Inputs { emergency_stop: false, fault: None });
    if output.stream {
        said.push(DeviceMessage::Measurement(device.measurement(0, Readings::default())));
    }
    output.voltage
}

/// A conversation of a host with the board.
///
/// # Errors
/// [`HelloError`] if the description breaks a rule.
pub fn main() -> Result<(), HelloError> {
    let mut device = Device::new(description(), 2017)?;
    let mut decoder = Decoder::new();
    let mut said = Vec::new();

    // Hello: the device answers with what it is, and with the session that may drive it.
    let hello = HostMessage::Hello { number: Session::MIN };
    cycle(&mut device, &mut decoder, hello.frame().as_bytes(), &mut said);
    let granted = said.iter().find_map(|message| match message {
        DeviceMessage::Hello(hello) => hello.session,
        _ => None,
    });
    let Some(session) = granted else { panic!("no session: {said:?}") };

    // Activation, and one command. It answers the latest measurement.
    let answers = said.iter().rev().find_map(|message| match message {
        DeviceMessage::Measurement(measurement) => Some(measurement.cycle),
        _ => None,
    });
    let messages = [
        HostMessage::Activate(Origin { session, sequence: 1 }),
        HostMessage::Voltage(VoltageCommand {
            origin: Origin { session, sequence: 2 },
            answers: answers.unwrap_or_default(),
            voltage: 250,
            validity_us: 20_000,
        }),
    ];
    let bytes: Vec<u8> =
        messages.iter().flat_map(|message| message.frame().as_bytes().to_vec()).collect();
    let mut voltage = cycle(&mut device, &mut decoder, &bytes, &mut said);

    // The host falls silent: the voltage ends with its validity.
    let mut driven = 0;
    while voltage != 0 {
        driven += 1;
        voltage = cycle(&mut device, &mut decoder, &[], &mut said);
    }
    println!("one command, then silence: {driven} cycles with 3 V, then none");
    assert!((1..=20).contains(&driven), "{driven}");
    Ok(())
}
