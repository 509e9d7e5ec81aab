//! The codec over messages drawn at random, arbitrary bytes, and the line's budget.

use proptest::prelude::*;
use rig_protocol::{
    Cause, Channels, Decoder, DeviceMessage, FaultReport, Hello, HostMessage, MAX_FRAME,
    Measurement, Message, Name, Origin, Readings, Rejection, Session, State, VoltageCommand,
};

fn session() -> impl Strategy<Value = Session> {
    (1..=u32::MAX).prop_map(|number| Session::new(number).unwrap())
}

fn origin() -> impl Strategy<Value = Origin> {
    (session(), any::<u32>()).prop_map(|(session, sequence)| Origin { session, sequence })
}

fn host_message() -> impl Strategy<Value = HostMessage> {
    prop_oneof![
        session().prop_map(|number| HostMessage::Hello { number }),
        (origin(), any::<(u32, i16, u32)>()).prop_map(
            |(origin, (answers, voltage, validity_us))| {
                HostMessage::Voltage(VoltageCommand { origin, answers, voltage, validity_us })
            }
        ),
        origin().prop_map(HostMessage::Heartbeat),
        origin().prop_map(HostMessage::Activate),
        Just(HostMessage::Deactivate),
        Just(HostMessage::EmergencyStop),
        origin().prop_map(HostMessage::Clear),
        origin().prop_map(HostMessage::Close),
    ]
}

fn hello() -> impl Strategy<Value = Hello> {
    let scale = || prop_oneof![1e-6..1.0f32, -1.0..-1e-6f32];
    (
        (
            proptest::option::of((session(), session())),
            "[ -~]{0,16}",
            any::<[u8; 3]>(),
            any::<[bool; 4]>(),
        ),
        (100..=10_000u32, 1..=u32::MAX, scale(), 1..=i16::MAX),
        (scale(), scale(), scale(), scale()),
        (10_000..=1_000_000u32, 1_000_000..=10_000_000u32),
    )
        .prop_map(|(who, cycle, scales, limits)| {
            let [tachometer, potentiometer, torque, current] = who.3;
            let of = |present, scale| if present { scale } else { 0.0 };
            Hello {
                answers: who.0.map(|(number, _)| number),
                session: who.0.map(|(_, session)| session),
                name: Name::new(&who.1).unwrap(),
                firmware: who.2,
                channels: Channels { tachometer, potentiometer, torque, current },
                period_us: cycle.0,
                counts_per_turn: cycle.1,
                volts_per_count: cycle.2,
                voltage_limit: cycle.3,
                tachometer_per_count: of(tachometer, scales.0),
                potentiometer_per_count: of(potentiometer, scales.1),
                torque_per_count: of(torque, scales.2),
                current_per_count: of(current, scales.3),
                validity_limit_us: limits.0,
                host_timeout_us: limits.1,
            }
        })
}

fn state() -> impl Strategy<Value = State> {
    proptest::sample::select(&State::ALL[..])
}

fn cause() -> impl Strategy<Value = Cause> {
    proptest::sample::select(&Cause::ALL[..])
}

fn measurement() -> impl Strategy<Value = Measurement> {
    (
        any::<(u32, u64, [i32; 5])>(),
        (any::<(i16, i16, u32, u16, u16)>(), proptest::option::of(session())),
        (state(), cause(), any::<bool>(), any::<bool>()),
    )
        .prop_map(
            |(
                (cycle, time_us, readings),
                (command, session),
                (state, cause, saturated, expired),
            )| {
                let [encoder, tachometer, potentiometer, torque, current] = readings;
                let (voltage_asked, voltage_applied, command_sequence, refused, foreign) = command;
                Measurement {
                    cycle,
                    time_us,
                    readings: Readings { encoder, tachometer, potentiometer, torque, current },
                    voltage_asked,
                    voltage_applied,
                    session,
                    command_sequence,
                    refused,
                    foreign,
                    state,
                    cause,
                    saturated,
                    expired,
                }
            },
        )
}

fn device_message() -> impl Strategy<Value = DeviceMessage> {
    prop_oneof![
        hello().prop_map(DeviceMessage::Hello),
        measurement().prop_map(DeviceMessage::Measurement),
        (any::<u32>(), cause(), state()).prop_map(|(cycle, cause, state)| DeviceMessage::Fault(
            FaultReport { cycle, cause, state }
        )),
    ]
}

/// Everything that `bytes` say.
fn decoded<M: Message>(decoder: &mut Decoder<M>, bytes: &[u8]) -> Vec<Result<M, Rejection>> {
    bytes.iter().filter_map(|byte| decoder.push(*byte).transpose()).collect()
}

proptest! {
    #[test]
    fn what_the_host_says_is_what_the_device_reads(message in host_message()) {
        let mut decoder = Decoder::new();
        prop_assert_eq!(decoded(&mut decoder, message.frame().as_bytes()), vec![Ok(message)]);
    }

    #[test]
    fn what_the_device_says_is_what_the_host_reads(message in device_message()) {
        let mut decoder = Decoder::new();
        prop_assert_eq!(decoded(&mut decoder, message.frame().as_bytes()), vec![Ok(message)]);
    }

    /// The frame that garbage runs into may be lost, the next is not, and the garbage itself says
    /// nothing.
    #[test]
    fn after_garbage_it_is_in_step_again_within_two_frames(
        garbage in proptest::collection::vec(any::<u8>(), 0..600),
        first in device_message(),
        second in device_message(),
    ) {
        let mut decoder = Decoder::<DeviceMessage>::new();
        let said = decoded(&mut decoder, &garbage);
        prop_assert!(said.iter().all(Result::is_err), "{:?}", said);
        let said: Vec<_> = [first, second]
            .iter()
            .flat_map(|message| decoded(&mut decoder, message.frame().as_bytes()))
            .filter_map(Result::ok)
            .collect();
        prop_assert!(said == [second] || said == [first, second], "{:?}", said);
    }

    /// A stream in which bytes were lost, changed and inserted yields only messages that were sent,
    /// and every one that was left alone between two zero bytes that were left alone.
    #[test]
    fn a_damaged_stream_says_nothing_that_was_not_said(
        messages in proptest::collection::vec(host_message(), 1..8),
        damages in proptest::collection::vec((any::<prop::sample::Index>(), 0..3u8, 1..=255u8), 0..6),
    ) {
        let mut stream: Vec<u8> = messages.iter().flat_map(|m| m.frame().as_bytes().to_vec()).collect();
        for (place, how, with) in damages {
            let at = place.index(stream.len());
            match how {
                0 if stream.len() > 1 => _ = stream.remove(at),
                1 => stream[at] ^= with,
                _ => stream.insert(at, with),
            }
        }
        let mut decoder = Decoder::<HostMessage>::new();
        let mut rest = messages.iter();
        for said in decoded(&mut decoder, &stream).into_iter().flatten() {
            prop_assert!(rest.any(|sent| *sent == said), "{:?} was not said, or not then", said);
        }
    }

    /// Any bytes: no panic, every frame's end is a message, a counted rejection or nothing.
    #[test]
    fn arbitrary_bytes_never_panic_and_every_rejection_is_counted(
        bytes in proptest::collection::vec(prop_oneof![4 => any::<u8>(), 1 => Just(0u8)], 0..2000),
    ) {
        fn run<M: Message>(bytes: &[u8]) -> (u64, u64, usize) {
            let mut decoder = Decoder::<M>::new();
            let told = decoded(&mut decoder, bytes).iter().filter(|said| said.is_err()).count();
            (told as u64, decoder.rejections().total(), bytes.iter().filter(|byte| **byte == 0).count())
        }
        for (told, counted, ends) in [run::<HostMessage>(&bytes), run::<DeviceMessage>(&bytes)] {
            prop_assert_eq!(told, counted);
            prop_assert!(told <= ends as u64);
        }
    }

    /// Bytes that pass framing and CRC, with any version, kind, length and content.
    #[test]
    fn well_framed_nonsense_never_panics(
        kind in prop_oneof![any::<u8>(), 0x01..=0x08u8, 0x81..=0x83u8],
        version in prop_oneof![3 => Just(rig_protocol::VERSION), 1 => any::<u8>()],
        payload in prop_oneof![
            proptest::collection::vec(any::<u8>(), 0..110),
            proptest::collection::vec(any::<u8>(), 51..=51),
            proptest::collection::vec(any::<u8>(), 66..=66),
        ],
    ) {
        let mut body = vec![version, kind];
        body.extend(&payload);
        body.extend(crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&body).to_le_bytes());
        let mut stream = vec![0; cobs::max_encoding_length(body.len()) + 1];
        let stuffed = cobs::encode(&body, &mut stream);
        let stream = &stream[..=stuffed];
        let mut decoder = Decoder::<DeviceMessage>::new();
        let said = decoded(&mut decoder, stream);
        prop_assert_eq!(said.len(), 1);
        match said[0] {
            Err(Rejection::Version(came)) => prop_assert!(came == version && version != rig_protocol::VERSION),
            // A message that was read says the same bytes again, unless a float in it is not a
            // number, which no rule lets pass.
            Ok(message) => {
                let again = message.frame();
                prop_assert_eq!(again.as_bytes(), stream);
            }
            Err(_) => prop_assert_eq!(version, rig_protocol::VERSION),
        }
        prop_assert_eq!(decoded(&mut Decoder::<HostMessage>::new(), stream).len(), 1);
    }
}

/// 8N1: ten bits a byte. A cycle of 1 ms on 2 Mbaud carries 200 bytes each way; half of that is the
/// limit.
#[test]
fn a_cycle_takes_at_most_100_bytes_each_way() {
    let session = Session::MAX;
    let longest = |messages: &[usize]| messages.iter().sum::<usize>();
    let origin = Origin { session, sequence: u32::MAX };
    let command = VoltageCommand { origin, answers: u32::MAX, voltage: -1, validity_us: u32::MAX };
    let from_host = longest(&[
        HostMessage::Voltage(command).frame().as_bytes().len(),
        HostMessage::Heartbeat(origin).frame().as_bytes().len(),
        HostMessage::EmergencyStop.frame().as_bytes().len(),
        HostMessage::Activate(origin).frame().as_bytes().len(),
    ]);
    let measurement = Measurement {
        cycle: u32::MAX,
        time_us: u64::MAX,
        readings: Readings {
            encoder: -1,
            tachometer: -1,
            potentiometer: -1,
            torque: -1,
            current: -1,
        },
        voltage_asked: -1,
        voltage_applied: -1,
        session: Some(session),
        command_sequence: u32::MAX,
        refused: u16::MAX,
        foreign: u16::MAX,
        state: State::Active,
        cause: Cause::Other,
        saturated: true,
        expired: true,
    };
    let report = FaultReport { cycle: u32::MAX, cause: Cause::Other, state: State::Fault };
    let from_device = longest(&[
        DeviceMessage::Measurement(measurement).frame().as_bytes().len(),
        DeviceMessage::Fault(report).frame().as_bytes().len(),
    ]);
    let bytes_a_cycle = 2_000_000 / 10 / 1000;
    for bytes in [from_host, from_device, MAX_FRAME] {
        assert!(bytes <= 100 && 2 * bytes <= bytes_a_cycle, "{bytes}");
    }
    // What PROTOCOL.md says: lengths do not depend on the content.
    assert_eq!(HostMessage::Voltage(command).frame().as_bytes().len(), 26);
    assert_eq!(DeviceMessage::Measurement(measurement).frame().as_bytes().len(), 59);
    assert_eq!(MAX_FRAME, 74);
}

#[test]
fn a_name_is_up_to_sixteen_printable_characters() {
    assert_eq!(Name::new("srv02 on rp2040").unwrap().as_str(), "srv02 on rp2040");
    assert_eq!(Name::new("0123456789abcdef").unwrap().as_str(), "0123456789abcdef");
    assert_eq!(Name::new("").unwrap().as_str(), "");
    for wrong in ["0123456789abcdefg", "tab\t", "µ", "a\0b"] {
        assert_eq!(Name::new(wrong), None, "{wrong:?}");
    }
}
