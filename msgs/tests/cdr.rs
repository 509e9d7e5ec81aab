//! Bytes on the wire: known layouts, round trips, and hostile input.

use msgs::{
    RosMessage,
    builtin_interfaces::Time,
    cdr::{self, CdrError},
    diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue},
    friction_msgs::{
        ControllerState, ExperimentStatus, FrictionEstimate, MotorVoltage, RigMeasurement,
    },
    sensor_msgs::JointState,
    std_msgs::Header,
};
use proptest::prelude::*;

#[test]
fn layout_is_little_endian_cdr_aligned_behind_the_header() {
    let message = MotorVoltage {
        header: Header { stamp: Time { sec: 1, nanosec: 2 }, frame_id: "ab".into() },
        voltage: 1.0,
    };
    #[rustfmt::skip]
    let expected = [
        0, 1, 0, 0,
        1, 0, 0, 0,  2, 0, 0, 0,
        3, 0, 0, 0,  b'a', b'b', 0,  0,
        0, 0, 0, 0, 0, 0, 0xf0, 0x3f,
    ];
    assert_eq!(cdr::encode(&message).unwrap(), expected);
}

#[test]
fn big_endian_is_read_too() {
    let bytes = [0, 0, 0, 0, 0, 0, 0, 7, 0, 0, 0, 9];
    assert_eq!(cdr::decode::<Time>(&bytes).unwrap(), Time { sec: 7, nanosec: 9 });
}

#[test]
fn padding_behind_the_message_is_allowed_and_more_is_not() {
    let mut bytes = cdr::encode(&Time { sec: 7, nanosec: 9 }).unwrap();
    bytes.extend([0; 3]);
    assert_eq!(cdr::decode::<Time>(&bytes).unwrap(), Time { sec: 7, nanosec: 9 });
    bytes.push(0);
    assert!(matches!(
        cdr::decode::<Time>(&bytes),
        Err(CdrError::TrailingBytes { used: 12, length: 16, .. })
    ));
}

#[test]
fn each_kind_of_bad_bytes_is_named() {
    assert!(matches!(cdr::decode::<Time>(&[0, 1]), Err(CdrError::TooShort { length: 2, .. })));
    assert!(matches!(
        cdr::decode::<Time>(&[0, 3, 0, 0, 1]),
        Err(CdrError::Encapsulation { found: [0, 3], .. })
    ));
    assert!(matches!(
        cdr::decode::<Time>(&[0, 1, 0, 0, 1]),
        Err(CdrError::Decode { length: 5, .. })
    ));
    // A sequence that claims four thousand million elements, and a string as long.
    let claims = [&[0, 1, 0, 0][..], &[0; 8], &[1, 0, 0, 0, 0, 0, 0, 0], &[0xff; 4]].concat();
    assert!(matches!(cdr::decode::<JointState>(&claims), Err(CdrError::Decode { .. })));
    let claims = [&[0, 1, 0, 0][..], &[0; 8], &[0xff; 4]].concat();
    assert!(matches!(cdr::decode::<Header>(&claims), Err(CdrError::Decode { .. })));
}

fn header() -> impl Strategy<Value = Header> {
    (any::<i32>(), any::<u32>(), ".{0,12}")
        .prop_map(|(sec, nanosec, frame_id)| Header { stamp: Time { sec, nanosec }, frame_id })
}

proptest! {
    #[test]
    fn joint_states_survive(
        header in header(),
        name in prop::collection::vec(".{0,8}", 0..4),
        position in prop::collection::vec(-1e9..1e9, 0..4),
        velocity in prop::collection::vec(-1e9..1e9, 0..4),
        effort in prop::collection::vec(-1e9..1e9, 0..4),
    ) {
        let message = JointState { header, name, position, velocity, effort };
        let bytes = cdr::encode(&message).unwrap();
        prop_assert_eq!(cdr::decode::<JointState>(&bytes).unwrap(), message);
    }

    #[test]
    fn diagnostics_survive(header in header(), level in 0_u8..4, texts in prop::collection::vec(".{0,9}", 5)) {
        let values = vec![KeyValue { key: texts[3].clone(), value: texts[4].clone() }; 2];
        let status = DiagnosticStatus {
            level,
            name: texts[0].clone(),
            message: texts[1].clone(),
            hardware_id: texts[2].clone(),
            values,
        };
        let message = DiagnosticArray { header, status: vec![status.clone(), status] };
        let bytes = cdr::encode(&message).unwrap();
        prop_assert_eq!(cdr::decode::<DiagnosticArray>(&bytes).unwrap(), message);
    }

    #[test]
    fn rig_measurements_survive(
        header in header(),
        cycle in any::<u64>(),
        encoder_counts in any::<i64>(),
        torque in -1e3..1e3,
        saturated in any::<bool>(),
    ) {
        let message = RigMeasurement { header, cycle, encoder_counts, torque, saturated, ..Default::default() };
        let bytes = cdr::encode(&message).unwrap();
        prop_assert_eq!(cdr::decode::<RigMeasurement>(&bytes).unwrap(), message);
    }

    #[test]
    fn hostile_bytes_are_an_error_or_a_message_but_never_a_panic(
        endianness in 0_u8..2,
        body in prop::collection::vec(any::<u8>(), 0..200),
    ) {
        let bytes = [&[0, endianness, 0, 0][..], &body].concat();
        fn check<M: RosMessage>(bytes: &[u8]) -> Result<(), TestCaseError> {
            if let Ok(message) = cdr::decode::<M>(bytes) {
                // What was accepted holds no more than what came in: nothing was invented.
                prop_assert!(cdr::encode(&message).unwrap().len() <= 2 * bytes.len());
            }
            Ok(())
        }
        check::<JointState>(&bytes)?;
        check::<DiagnosticArray>(&bytes)?;
        check::<FrictionEstimate>(&bytes)?;
        check::<ControllerState>(&bytes)?;
        check::<ExperimentStatus>(&bytes)?;
        check::<RigMeasurement>(&bytes)?;
    }

    #[test]
    fn a_cut_message_is_refused(cut in 1_usize..70) {
        let message = JointState {
            header: Header::at(1_600_000_000_000_000_000),
            name: vec!["load_shaft".into()],
            position: vec![1.0],
            velocity: vec![2.0],
            effort: vec![3.0],
        };
        let bytes = cdr::encode(&message).unwrap();
        prop_assert!(cdr::decode::<JointState>(&bytes[..bytes.len() - cut]).is_err());
    }
}
