//! The device's promises, whatever a host does.

mod promises;

use promises::{LIMIT, Promises, of, session};
use proptest::prelude::*;
use rig_protocol::{
    Cause, Device, DeviceMessage, Hello, HostMessage, Inputs, Origin, Readings, Refusal, Session,
    State, VoltageCommand, WINDOW,
};

const VALIDITY: u32 = 20;
const TIMEOUT: u32 = 250;

fn hello() -> Hello {
    promises::hello(VALIDITY, TIMEOUT)
}

/// Of the present host.
fn own(device: &Device, sequence: u32) -> Origin {
    of(device.session().unwrap(), sequence)
}

/// A command of the present host.
fn command(device: &Device, sequence: u32, answers: u32, voltage: i16) -> HostMessage {
    HostMessage::Voltage(VoltageCommand {
        origin: own(device, sequence),
        answers,
        voltage,
        validity_us: 20_000,
    })
}

/// A device with session 1, active.
fn active() -> Device {
    let mut device = Device::new(hello(), 7).unwrap();
    device.tick(Inputs::default());
    device.receive(&HostMessage::Hello { number: session(1) }).unwrap();
    device.receive(&HostMessage::Activate(own(&device, 1))).unwrap();
    device
}

fn volts(device: &mut Device) -> i16 {
    device.tick(Inputs::default()).voltage
}

#[test]
fn a_new_device_announces_itself_and_has_zero_volts_whatever_is_commanded() {
    let mut device = Device::new(hello(), 7).unwrap();
    let first = device.tick(Inputs::default());
    assert!(first.announce && !first.stream && first.voltage == 0);
    assert_eq!(
        device.receive(&HostMessage::Activate(of(session(7), 1))),
        Err(Refusal::OtherSession),
        "an activation from before the restart"
    );
    let announced = (0..1000).filter(|_| device.tick(Inputs::default()).announce).count();
    assert_eq!(announced, 10);
    let Ok(Some(DeviceMessage::Hello(answer))) =
        device.receive(&HostMessage::Hello { number: session(7) })
    else {
        panic!("no answer to hello")
    };
    assert_eq!((answer.answers, answer.session), (Some(session(7)), device.session()));
    assert!(answer.session.is_some());
    let next = device.tick(Inputs::default());
    assert!(next.stream && !next.announce);
}

#[test]
fn a_command_holds_for_its_validity_after_the_measurement_it_answers_and_not_a_cycle_longer() {
    for (validity_us, cycles) in [(20_000, 20), (1, 1), (1000, 1), (1001, 2), (u32::MAX, VALIDITY)]
    {
        for delay in 0..cycles {
            let mut device = active();
            volts(&mut device);
            let answers = device.cycle();
            for _ in 0..delay {
                volts(&mut device);
            }
            let sent = VoltageCommand { origin: own(&device, 2), answers, voltage: 7, validity_us };
            device.receive(&HostMessage::Voltage(sent)).unwrap();
            let driven = (0..100).take_while(|_| volts(&mut device) == 7).count();
            assert_eq!(driven as u32, cycles - delay, "{validity_us} us, {delay} cycles late");
            let shown = device.measurement(0, Readings::default());
            assert!(shown.expired && shown.state == State::Active);
            assert_eq!((shown.voltage_asked, shown.command_sequence), (7, 2));
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
    assert_eq!(device.receive(&command(&device, 2, answers, 500)), Err(Refusal::Stale));
    assert_eq!(
        device.receive(&command(&device, 3, device.cycle() + 1, 500)),
        Err(Refusal::FromTheFuture)
    );
    assert_eq!(volts(&mut device), 0);
    assert_eq!(device.refused(), 2);
}

#[test]
fn duplicates_and_commands_out_of_order_or_too_far_ahead_are_refused_also_where_numbers_wrap() {
    let mut device = active();
    let now = device.cycle();
    let mut last = 1u32;
    while last != u32::MAX {
        last = last.saturating_add(WINDOW);
        device.receive(&command(&device, last, now, 1)).unwrap();
    }
    assert_eq!(device.receive(&command(&device, u32::MAX, now, 2)), Err(Refusal::NotNewer));
    device.receive(&command(&device, 1, now, 3)).unwrap();
    assert_eq!(device.receive(&command(&device, u32::MAX, now, 4)), Err(Refusal::NotNewer));
    assert_eq!(device.receive(&command(&device, 2 + WINDOW, now, 5)), Err(Refusal::TooFarAhead));
    assert_eq!(volts(&mut device), 3);
    assert_eq!((device.refused(), device.foreign()), (3, 0));
}

/// A number counts once, also if its message was refused: nobody can keep it for later.
#[test]
fn a_command_that_was_refused_is_not_obeyed_when_it_comes_again() {
    let mut device = active();
    device.receive(&HostMessage::Deactivate).unwrap();
    let sent = command(&device, 2, device.cycle(), 500);
    assert_eq!(device.receive(&sent), Err(Refusal::NotActive));
    device.receive(&HostMessage::Activate(own(&device, 3))).unwrap();
    assert_eq!(device.receive(&sent), Err(Refusal::NotNewer));
    assert_eq!(volts(&mut device), 0);
}

/// A second host gets in only when the first is gone: closed, or silent for the host timeout. Until
/// then nothing that it says moves the motor or stops it, but for the two messages that may stop
/// it.
#[test]
fn a_hello_does_not_take_the_device_from_a_host_that_is_alive() {
    let mut device = active();
    device.receive(&command(&device, 2, device.cycle(), 500)).unwrap();
    let other = HostMessage::Hello { number: session(2) };
    assert_eq!(device.receive(&other), Err(Refusal::Held));
    assert_eq!(
        device.receive(&HostMessage::Activate(of(session(2), 1))),
        Err(Refusal::OtherSession)
    );
    assert_eq!(volts(&mut device), 500, "the host that is there goes on");
    device.receive(&HostMessage::Deactivate).unwrap();
    assert_eq!(device.receive(&other), Err(Refusal::Held), "stopping it does not let anybody in");
    assert_eq!(device.foreign(), 3);
    for _ in 1..TIMEOUT {
        volts(&mut device);
        assert_eq!(device.receive(&other), Err(Refusal::Held));
    }
    volts(&mut device);
    assert!(
        matches!(device.receive(&other), Ok(Some(DeviceMessage::Hello(_)))),
        "its host is silent"
    );
    device.receive(&HostMessage::Close(own(&device, 1))).unwrap();
    let shown = device.tick(Inputs::default());
    assert!(!shown.stream, "nobody listens");
    device.receive(&HostMessage::Hello { number: session(1) }).unwrap();
}

/// The answer to a hello may be lost, so that it is said again. Whoever replays it stops the motor,
/// but does not make old frames new.
#[test]
fn the_same_hello_again_stops_the_motor_and_leaves_the_numbers_as_they_were() {
    let mut device = active();
    let sent = command(&device, 2, device.cycle(), 500);
    device.receive(&sent).unwrap();
    assert_eq!(volts(&mut device), 500);
    assert!(device.receive(&HostMessage::Hello { number: session(1) }).is_ok());
    assert_eq!(device.state(), State::Inactive);
    assert_eq!(
        device.receive(&HostMessage::Activate(own(&device, 1))),
        Err(Refusal::NotNewer),
        "a replay"
    );
    assert_eq!(device.receive(&sent), Err(Refusal::NotNewer));
    assert_eq!(volts(&mut device), 0);
}

#[test]
fn a_voltage_beyond_the_limit_is_cut_and_the_measurement_says_so() {
    let mut device = active();
    device.receive(&command(&device, 2, device.cycle(), i16::MIN)).unwrap();
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
    assert_eq!(device.receive(&command(&device, 2, device.cycle(), 500)), Err(Refusal::NotActive));
    device.receive(&HostMessage::Activate(own(&device, 3))).unwrap();
    assert_eq!(volts(&mut device), 0, "no voltage from before");
    // Heartbeats alone keep it, those of another session do not.
    for cycle in 0..3 * TIMEOUT {
        if cycle % TIMEOUT == 0 {
            device.receive(&HostMessage::Heartbeat(own(&device, 4 + cycle))).unwrap();
        }
        volts(&mut device);
    }
    assert_eq!(device.state(), State::Active);
    let stranger = HostMessage::Heartbeat(of(session(2), 1000));
    for _ in 0..=TIMEOUT {
        assert_eq!(device.receive(&stranger), Err(Refusal::OtherSession));
        volts(&mut device);
    }
    assert_eq!(device.state(), State::Inactive);
}

#[test]
fn an_emergency_stop_latches_until_the_session_clears_it_and_then_needs_activation() {
    let mut device = active();
    device.receive(&command(&device, 2, device.cycle(), 500)).unwrap();
    assert_eq!(volts(&mut device), 500);
    device.receive(&HostMessage::EmergencyStop).unwrap();
    let output = device.tick(Inputs::default());
    assert_eq!((output.voltage, output.report.unwrap().cause), (0, Cause::EmergencyStop));
    assert_eq!(device.receive(&HostMessage::Activate(own(&device, 3))), Err(Refusal::Latched));
    let (earlier, close) = (own(&device, 5), HostMessage::Close(own(&device, 4)));
    device.receive(&close).unwrap();
    device.receive(&HostMessage::Hello { number: session(2) }).unwrap();
    assert_eq!(device.state(), State::EmergencyStopped, "a new host does not clear it");
    assert_eq!(device.receive(&HostMessage::Clear(earlier)), Err(Refusal::OtherSession));
    device.receive(&HostMessage::Clear(own(&device, 1))).unwrap();
    assert_eq!(device.state(), State::Inactive);
    assert_eq!(volts(&mut device), 0);
    device.receive(&HostMessage::Activate(own(&device, 2))).unwrap();
    assert_eq!(volts(&mut device), 0, "no voltage from before the stop");
}

#[test]
fn a_pressed_switch_stops_again_after_every_clear() {
    let mut device = active();
    let pressed = Inputs { emergency_stop: true, fault: None };
    for round in 0..3 {
        let number = 2 + 3 * round;
        device.tick(pressed);
        assert_eq!(device.state(), State::EmergencyStopped);
        device.receive(&HostMessage::Clear(own(&device, number))).unwrap();
        device.receive(&HostMessage::Activate(own(&device, number + 1))).unwrap();
        device.receive(&command(&device, number + 2, device.cycle(), 500)).unwrap();
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
        assert_eq!(Device::new(wrong, 7).unwrap_err().field, field);
    }
}

/// What may happen to a device between two cycles.
#[derive(Debug, Clone, Copy)]
enum Happening {
    Cycle(Inputs),
    /// So many cycles, mostly fewer than lose the host.
    Pass(u32),
    Says(HostMessage),
    /// A message of a session, its number so far ahead of the last one's.
    Next(u32, i32, What),
    Restart,
}

#[derive(Debug, Clone, Copy)]
enum What {
    Activate,
    Clear,
    Close,
    Heartbeat,
    /// A command that answers the cycle so many before the present one.
    Command {
        age: u32,
        voltage: i16,
        validity_us: u32,
    },
}

fn happening() -> impl Strategy<Value = Happening> {
    let what = prop_oneof![
        4 => Just(What::Activate),
        2 => Just(What::Clear),
        1 => Just(What::Close),
        1 => Just(What::Heartbeat),
        12 => (0..30u32, any::<i16>(), 0..40_000u32)
            .prop_map(|(age, voltage, validity_us)| What::Command { age, voltage, validity_us }),
    ];
    let ahead = prop_oneof![12 => Just(1), 2 => -3..5i32, 1 => any::<i32>()];
    prop_oneof![
        12 => Just(Happening::Cycle(Inputs::default())),
        1 => (0..300u32).prop_map(Happening::Pass),
        1 => (any::<bool>(), proptest::option::of(Just(Cause::Sensor)))
            .prop_map(|(emergency_stop, fault)| Happening::Cycle(Inputs { emergency_stop, fault })),
        16 => (1..3u32, ahead, what).prop_map(|(number, ahead, what)| Happening::Next(number, ahead, what)),
        2 => (1..3u32).prop_map(|number| Happening::Says(HostMessage::Hello { number: session(number) })),
        1 => Just(Happening::Says(HostMessage::Deactivate)),
        1 => Just(Happening::Says(HostMessage::EmergencyStop)),
        1 => Just(Happening::Restart),
    ]
}

proptest! {
    /// Longer than the search of all sequences can be, with any numbers: the device does what the
    /// promises' own books say.
    #[test]
    fn whatever_happens_the_motor_has_volts_only_by_a_valid_command_while_active(
        happenings in proptest::collection::vec(happening(), 0..300),
    ) {
        let mut device = Device::new(hello(), 7).unwrap();
        let mut promises = Promises::new(VALIDITY, TIMEOUT);
        // What each of two hosts was granted last; before that it can only guess.
        let mut granted: [Session; 2] = [session(1), session(2)];
        for happening in happenings {
            let message = match happening {
                Happening::Restart => {
                    device = Device::new(hello(), 7).unwrap();
                    promises = Promises::new(VALIDITY, TIMEOUT);
                    None
                }
                Happening::Cycle(inputs) => {
                    prop_assert_eq!(device.tick(inputs).voltage, promises.ticks(inputs));
                    None
                }
                Happening::Pass(cycles) => {
                    for _ in 0..cycles {
                        prop_assert_eq!(volts(&mut device), promises.ticks(Inputs::default()));
                    }
                    None
                }
                Happening::Says(message) => Some(message),
                Happening::Next(number, ahead, what) => {
                    let origin = of(granted[number as usize - 1], promises.last.wrapping_add_signed(ahead));
                    Some(match what {
                        What::Activate => HostMessage::Activate(origin),
                        What::Clear => HostMessage::Clear(origin),
                        What::Close => HostMessage::Close(origin),
                        What::Heartbeat => HostMessage::Heartbeat(origin),
                        What::Command { age, voltage, validity_us } => HostMessage::Voltage(VoltageCommand {
                            origin,
                            answers: device.cycle().saturating_sub(age),
                            voltage,
                            validity_us,
                        }),
                    })
                }
            };
            if let Some(message) = message {
                let answer = device.receive(&message);
                let grant = match answer {
                    Ok(Some(DeviceMessage::Hello(hello))) => hello.session,
                    _ => None,
                };
                prop_assert_eq!(answer.is_ok(), promises.says(&message, grant), "{:?}", message);
                if let (HostMessage::Hello { number }, Some(grant)) = (message, grant) {
                    granted[number.get() as usize - 1] = grant;
                }
            }
            prop_assert_eq!(device.state() == State::Active, promises.active);
            prop_assert_eq!((device.refused(), device.foreign()), (promises.refused, promises.foreign));
        }
    }
}
