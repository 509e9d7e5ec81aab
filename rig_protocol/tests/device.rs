//! The device's promises, whatever a host does.

use proptest::prelude::*;
use rig_protocol::{
    Cause, Channels, Device, DeviceMessage, Hello, HostMessage, Inputs, Name, Readings, Refusal, Session,
    State, VoltageCommand,
};

const LIMIT: i16 = 1000;
const VALIDITY: u32 = 20;
const TIMEOUT: u32 = 250;

fn hello() -> Hello {
    Hello {
        session: None,
        name: Name::new("test").unwrap(),
        firmware: [0, 1, 0],
        channels: Channels::default(),
        period_us: 1000,
        counts_per_turn: 4096,
        volts_per_count: 0.005,
        voltage_limit: LIMIT,
        tachometer_per_count: 0.0,
        potentiometer_per_count: 0.0,
        torque_per_count: 0.0,
        current_per_count: 0.0,
        validity_limit_us: VALIDITY * 1000,
        host_timeout_us: TIMEOUT * 1000,
    }
}

fn session(number: u32) -> Session {
    Session::new(number).unwrap()
}

fn command(sequence: u32, answers: u32, voltage: i16) -> HostMessage {
    HostMessage::Voltage(VoltageCommand { sequence, answers, voltage, validity_us: 20_000 })
}

/// A device with session 1, active.
fn active() -> Device {
    let mut device = Device::new(hello()).unwrap();
    device.tick(Inputs::default());
    device.receive(&HostMessage::Hello { session: session(1) }).unwrap();
    device.receive(&HostMessage::Activate { session: session(1) }).unwrap();
    device
}

fn volts(device: &mut Device) -> i16 {
    device.tick(Inputs::default()).voltage
}

#[test]
fn a_new_device_announces_itself_and_has_zero_volts_whatever_is_commanded() {
    let mut device = Device::new(hello()).unwrap();
    let first = device.tick(Inputs::default());
    assert!(first.announce && !first.stream && first.voltage == 0);
    assert_eq!(device.receive(&command(1, 1, 500)), Err(Refusal::NotActive));
    assert_eq!(
        device.receive(&HostMessage::Activate { session: session(7) }),
        Err(Refusal::OtherSession),
        "an activation from before the restart"
    );
    let announced = (0..1000).filter(|_| device.tick(Inputs::default()).announce).count();
    assert_eq!(announced, 10);
    let Ok(Some(DeviceMessage::Hello(answer))) = device.receive(&HostMessage::Hello { session: session(7) })
    else {
        panic!("no answer to hello")
    };
    assert_eq!(answer.session, Some(session(7)));
    let next = device.tick(Inputs::default());
    assert!(next.stream && !next.announce);
}

#[test]
fn a_command_holds_for_its_validity_after_the_measurement_it_answers_and_not_a_cycle_longer() {
    for (validity_us, cycles) in [(20_000, 20), (1, 1), (1000, 1), (1001, 2), (u32::MAX, VALIDITY)] {
        for delay in 0..cycles {
            let mut device = active();
            volts(&mut device);
            let answers = device.cycle();
            for _ in 0..delay {
                volts(&mut device);
            }
            let sent = VoltageCommand { sequence: 1, answers, voltage: 7, validity_us };
            device.receive(&HostMessage::Voltage(sent)).unwrap();
            let driven = (0..100).take_while(|_| volts(&mut device) == 7).count();
            assert_eq!(driven as u32, cycles - delay, "{validity_us} us, {delay} cycles late");
            let shown = device.measurement(0, Readings::default());
            assert!(shown.expired && shown.state == State::Active);
            assert_eq!((shown.voltage_asked, shown.command_sequence), (7, 1));
        }
    }
}

#[test]
fn what_lay_in_a_buffer_for_longer_than_its_validity_is_refused() {
    let mut device = active();
    let answers = device.cycle();
    for _ in 0..VALIDITY {
        volts(&mut device);
    }
    assert_eq!(device.receive(&command(1, answers, 500)), Err(Refusal::Stale));
    assert_eq!(device.receive(&command(1, device.cycle() + 1, 500)), Err(Refusal::FromTheFuture));
    assert_eq!(volts(&mut device), 0);
    assert_eq!(device.refused(), 2);
}

#[test]
fn duplicates_and_commands_out_of_order_are_refused_also_where_numbers_wrap() {
    let mut device = active();
    let now = device.cycle();
    device.receive(&command(u32::MAX, now, 1)).unwrap();
    assert_eq!(device.receive(&command(u32::MAX, now, 2)), Err(Refusal::NotNewer));
    device.receive(&command(0, now, 3)).unwrap();
    assert_eq!(device.receive(&command(u32::MAX, now, 4)), Err(Refusal::NotNewer));
    assert_eq!(volts(&mut device), 3);
}

#[test]
fn a_voltage_beyond_the_limit_is_cut_and_the_measurement_says_so() {
    let mut device = active();
    device.receive(&command(1, device.cycle(), i16::MIN)).unwrap();
    assert_eq!(volts(&mut device), -LIMIT);
    assert!(device.measurement(0, Readings::default()).saturated);
}

#[test]
fn a_silent_host_loses_the_device_until_it_activates_again() {
    let mut device = active();
    for _ in 0..TIMEOUT {
        assert_eq!(device.tick(Inputs::default()).report, None);
    }
    let report = device.tick(Inputs::default()).report.unwrap();
    assert_eq!((report.cause, report.state), (Cause::HostLost, State::Inactive));
    assert_eq!(device.receive(&command(1, device.cycle(), 500)), Err(Refusal::NotActive));
    device.receive(&HostMessage::Activate { session: session(1) }).unwrap();
    assert_eq!(volts(&mut device), 0, "no voltage from before");
    // Heartbeats alone keep it, those of another session do not.
    for cycle in 0..3 * TIMEOUT {
        if cycle % TIMEOUT == 0 {
            device.receive(&HostMessage::Heartbeat { session: session(1) }).unwrap();
        }
        volts(&mut device);
    }
    assert_eq!(device.state(), State::Active);
    let stranger = HostMessage::Heartbeat { session: session(2) };
    for _ in 0..=TIMEOUT {
        assert_eq!(device.receive(&stranger), Err(Refusal::OtherSession));
        volts(&mut device);
    }
    assert_eq!(device.state(), State::Inactive);
}

#[test]
fn an_emergency_stop_latches_until_the_session_clears_it_and_then_needs_activation() {
    let mut device = active();
    device.receive(&command(1, device.cycle(), 500)).unwrap();
    assert_eq!(volts(&mut device), 500);
    device.receive(&HostMessage::EmergencyStop).unwrap();
    let output = device.tick(Inputs::default());
    assert_eq!((output.voltage, output.report.unwrap().cause), (0, Cause::EmergencyStop));
    let activate = HostMessage::Activate { session: session(1) };
    assert_eq!(device.receive(&activate), Err(Refusal::Latched));
    device.receive(&HostMessage::Hello { session: session(2) }).unwrap();
    assert_eq!(device.state(), State::EmergencyStopped, "a new host does not clear it");
    assert_eq!(device.receive(&HostMessage::Clear { session: session(1) }), Err(Refusal::OtherSession));
    device.receive(&HostMessage::Clear { session: session(2) }).unwrap();
    assert_eq!(device.state(), State::Inactive);
    assert_eq!(volts(&mut device), 0);
    device.receive(&HostMessage::Activate { session: session(2) }).unwrap();
    assert_eq!(volts(&mut device), 0, "no voltage from before the stop");
}

#[test]
fn a_pressed_switch_stops_again_after_every_clear() {
    let mut device = active();
    let pressed = Inputs { emergency_stop: true, fault: None };
    for _ in 0..3 {
        device.tick(pressed);
        assert_eq!(device.state(), State::EmergencyStopped);
        device.receive(&HostMessage::Clear { session: session(1) }).unwrap();
        device.receive(&HostMessage::Activate { session: session(1) }).unwrap();
        device.receive(&command(1, device.cycle(), 500)).unwrap();
        assert_eq!(device.tick(pressed).voltage, 0);
    }
}

#[test]
fn a_description_that_cannot_be_is_refused_by_name() {
    for (wrong, field) in [
        (Hello { period_us: 0, ..hello() }, "period_us"),
        (Hello { voltage_limit: 0, ..hello() }, "voltage_limit"),
        (Hello { volts_per_count: f32::NAN, ..hello() }, "volts_per_count"),
        (Hello { torque_per_count: 1.0, ..hello() }, "torque_per_count"),
        (Hello { validity_limit_us: 999, ..hello() }, "validity_limit_us"),
        (Hello { host_timeout_us: 19_999, ..hello() }, "host_timeout_us"),
    ] {
        assert_eq!(Device::new(wrong).unwrap_err().field, field);
    }
}

/// What may happen to a device between two cycles.
#[derive(Debug, Clone, Copy)]
enum Happening {
    Cycle(Inputs),
    Says(HostMessage),
    /// A command that answers the cycle so many before the present one.
    Commands {
        sequence: u32,
        age: u32,
        voltage: i16,
        validity_us: u32,
    },
    Restart,
}

fn happening() -> impl Strategy<Value = Happening> {
    let who = || (1..3u32).prop_map(session);
    prop_oneof![
        12 => Just(Happening::Cycle(Inputs::default())),
        1 => (any::<bool>(), proptest::option::of(Just(Cause::Sensor)))
            .prop_map(|(emergency_stop, fault)| Happening::Cycle(Inputs { emergency_stop, fault })),
        8 => (0..2000u32, 0..30u32, any::<i16>(), 0..40_000u32).prop_map(|(sequence, age, voltage, validity_us)| {
            Happening::Commands { sequence, age, voltage, validity_us }
        }),
        1 => who().prop_map(|session| Happening::Says(HostMessage::Hello { session })),
        4 => who().prop_map(|session| Happening::Says(HostMessage::Activate { session })),
        2 => who().prop_map(|session| Happening::Says(HostMessage::Clear { session })),
        1 => Just(Happening::Says(HostMessage::Deactivate)),
        1 => Just(Happening::Says(HostMessage::EmergencyStop)),
        1 => Just(Happening::Restart),
    ]
}

proptest! {
    /// A second set of books, kept apart from the device's: volts only while a session's host activated and nothing stopped it since,
    /// only from a command within its validity, never beyond the limit.
    #[test]
    fn whatever_happens_the_motor_has_volts_only_by_a_valid_command_while_active(
        happenings in proptest::collection::vec(happening(), 0..300),
    ) {
        let mut device = Device::new(hello()).unwrap();
        let (mut allowed, mut latched, mut of) = (false, false, None);
        // Last cycle for which an accepted command is valid, and its voltage.
        let mut until: Option<(u32, i16)> = None;
        for happening in happenings {
            match happening {
                Happening::Restart => {
                    device = Device::new(hello()).unwrap();
                    (allowed, latched, of, until) = (false, false, None, None);
                }
                Happening::Says(message) => {
                    let accepted = device.receive(&message).is_ok();
                    match message {
                        HostMessage::Hello { session } => (allowed, of) = (false, Some(session)),
                        HostMessage::Activate { session } => {
                            prop_assert_eq!(accepted, of == Some(session) && !latched);
                            if accepted && !allowed {
                                (allowed, until) = (true, None);
                            }
                        }
                        HostMessage::Clear { session } => {
                            prop_assert_eq!(accepted, of == Some(session));
                            latched &= !accepted;
                        }
                        HostMessage::EmergencyStop => (allowed, latched) = (false, true),
                        _ => allowed = false,
                    }
                }
                Happening::Commands { sequence, age, voltage, validity_us } => {
                    let answers = device.cycle().wrapping_sub(age);
                    let message = HostMessage::Voltage(VoltageCommand { sequence, answers, voltage, validity_us });
                    if device.receive(&message).is_ok() {
                        prop_assert!(allowed);
                        let validity = validity_us.min(VALIDITY * 1000).div_ceil(1000);
                        until = Some((answers.wrapping_add(validity), voltage));
                    }
                }
                Happening::Cycle(inputs) => {
                    let output = device.tick(inputs);
                    latched |= inputs.emergency_stop || inputs.fault.is_some();
                    allowed &= !latched;
                    let ahead = until.is_some_and(|(end, _)| end.wrapping_sub(device.cycle()) < 1 << 31);
                    let expected = if allowed && ahead { until.map_or(0, |(_, v)| v.clamp(-LIMIT, LIMIT)) } else { 0 };
                    prop_assert_eq!(output.voltage, expected);
                }
            }
            prop_assert_eq!(device.state() == State::Active, allowed);
        }
    }
}
