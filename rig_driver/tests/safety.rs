//! The safety layer's promises: every fault does what its table says, and under any commands and
//! readings the voltage stays within its limits, is zero in every state but active, and zero once
//! the last command is too old.

use proptest::prelude::*;
use proptest::test_runner::FileFailurePersistence;
use rig_driver::safety::{
    Event, FAULTS, Fault, MotorThermal, Reaction, Request, SafetyLimits, SafetySupervisor,
    SensorChecks, State, Supervised, Travel, next,
};
use rig_driver::{Measurement, Rig, RigError};

const PERIOD: f64 = 1e-3;

fn limits() -> SafetyLimits {
    SafetyLimits {
        travel: Some(Travel { min: -2.0, max: 3.0, margin: 0.1 }),
        ..SafetyLimits::default()
    }
}

/// A supervisor with readings of a shaft at rest, a little noise on the analogue channels.
struct Bench {
    supervisor: SafetySupervisor,
    cycle: u64,
    now: f64,
}

impl Bench {
    fn new(limits: SafetyLimits) -> Self {
        Self { supervisor: SafetySupervisor::new(limits, PERIOD).unwrap(), cycle: 0, now: 0.0 }
    }

    fn active(limits: SafetyLimits) -> Self {
        let mut bench = Self::new(limits);
        bench.supervisor.request(Request::Configure).unwrap();
        bench.supervisor.request(Request::Activate).unwrap();
        bench
    }

    /// One cycle a period later, with the readings that `change` makes of those at rest, and a
    /// command of now.
    fn step(&mut self, volts: Option<f64>, change: impl Fn(&mut Measurement, u64)) -> f64 {
        self.step_after(PERIOD, volts, change)
    }

    fn step_after(
        &mut self,
        gap: f64,
        volts: Option<f64>,
        change: impl Fn(&mut Measurement, u64),
    ) -> f64 {
        self.cycle += 1;
        self.now += gap;
        let mut seen = noisy(self.cycle, self.now);
        change(&mut seen, self.cycle);
        self.supervisor.cycle(self.now, &seen);
        if let Some(volts) = volts {
            self.supervisor.command(self.now, volts);
        }
        self.supervisor.output()
    }

    fn run(
        &mut self,
        cycles: u32,
        volts: Option<f64>,
        change: impl Fn(&mut Measurement, u64) + Copy,
    ) -> f64 {
        (0..cycles).map(|_| self.step(volts, change)).last().unwrap_or(0.0)
    }
}

fn noisy(cycle: u64, time: f64) -> Measurement {
    let noise = if cycle.is_multiple_of(2) { 0.005 } else { -0.005 };
    Measurement { cycle, time, tachometer_velocity: noise, torque: noise, ..Measurement::default() }
}

fn at_rest(_: &mut Measurement, _: u64) {}

/// Drives an active bench into the fault. Every fault has its own way, so that a new one cannot go
/// untested.
fn provoke(bench: &mut Bench, fault: Fault) -> f64 {
    bench.run(5, Some(1.0), at_rest);
    match fault {
        Fault::VoltageBeyondLimit => bench.run(10, Some(50.0), at_rest),
        Fault::VoltageTooSteep => bench.step(Some(-5.0), at_rest),
        Fault::EndOfTravel => bench.step(Some(1.0), |seen, _| seen.encoder_position = 3.05),
        Fault::CommandLate => bench.run(22, None, at_rest),
        Fault::CycleLate => bench.step_after(0.03, Some(1.0), at_rest),
        Fault::CommandLost => bench.run(502, None, at_rest),
        Fault::CycleLost => bench.step_after(0.6, Some(1.0), at_rest),
        Fault::CommandNotFinite => bench.step(Some(f64::NAN), at_rest),
        Fault::Overspeed => bench.run(3, Some(1.0), |seen, _| seen.tachometer_velocity = -9.6),
        Fault::TravelExceeded => bench.step(Some(1.0), |seen, _| seen.encoder_position = -2.2),
        Fault::MotorHot => {
            (0..9_000).find(|_| bench.step(Some(6.0), at_rest) == 0.0);
            bench.step(Some(6.0), at_rest)
        }
        Fault::ReadingNotFinite => bench.step(Some(1.0), |seen, _| seen.torque = f64::INFINITY),
        Fault::SensorsDisagree => {
            bench.run(110, Some(1.0), |seen, _| seen.tachometer_velocity += 0.5)
        }
        Fault::TorqueSaturated => bench.run(10, Some(1.0), |seen, _| seen.torque = -23.0),
        Fault::TachometerFrozen => {
            bench.run(201, Some(1.0), |seen, _| seen.tachometer_velocity = 0.0)
        }
        Fault::TorqueFrozen => bench.run(201, Some(1.0), |seen, _| seen.torque = 0.01),
        Fault::RigClockStopped => bench.run(21, Some(1.0), |seen, _| seen.time = 7.0),
        Fault::BackEnd => bench.step(Some(1.0), |seen, _| seen.fault = true),
        Fault::MotionAtZero => {
            bench.run(800, Some(0.0), |seen, cycle| {
                seen.tachometer_velocity += 1.5;
                seen.encoder_position = 1.5e-3 * cycle as f64;
            });
            bench.step(Some(1.0), at_rest)
        }
        // Found by the node, and by the back end itself, which watches its line: they have tests of
        // their own.
        Fault::PermissionWithdrawn
        | Fault::UnknownEcho
        | Fault::ForeignFrames
        | Fault::CommandsRefused
        | Fault::VoltageDiffers
        | Fault::CycleJump
        | Fault::StopNotAcknowledged => {
            bench.supervisor.fault(fault, 1.0, 0.5);
            bench.step(Some(1.0), at_rest)
        }
    }
}

#[test]
fn every_fault_does_what_its_line_in_the_table_says() {
    for rule in FAULTS {
        let name = rule.name;
        let mut bench = Bench::active(limits());
        let volts = provoke(&mut bench, rule.fault);
        let supervisor = &mut bench.supervisor;
        match rule.reaction {
            Reaction::Cut => {
                assert_eq!(supervisor.held_back().map(|report| report.fault), Some(rule.fault));
                assert_eq!(supervisor.state(), State::Active, "{name}");
                let allowed = match rule.fault {
                    Fault::VoltageBeyondLimit => 6.0,
                    Fault::VoltageTooSteep => -2.0,
                    _ => 0.0,
                };
                assert_eq!(volts, allowed, "{name}");
            }
            Reaction::ZeroWhileItLasts => {
                assert_eq!(supervisor.held_back().map(|report| report.fault), Some(rule.fault));
                assert_eq!((volts, supervisor.state()), (0.0, State::Active), "{name}");
                assert!(
                    bench.step(Some(1.0), at_rest) > 0.0,
                    "{name}: a fresh command moves it again"
                );
            }
            Reaction::ZeroUntilCleared => {
                assert_eq!(
                    supervisor.latched().map(|report| report.fault),
                    Some(rule.fault),
                    "{name}"
                );
                assert_eq!((volts, supervisor.state()), (0.0, State::Faulted), "{name}");
                assert!(supervisor.request(Request::Activate).is_err(), "{name}");
                assert_eq!(bench.run(50, Some(1.0), at_rest), 0.0, "{name}: it stays");
                if rule.fault == Fault::MotorHot {
                    let refused = bench.supervisor.request(Request::Clear).unwrap_err();
                    assert!(
                        matches!(refused, RigError::Safety(report) if report.fault == Fault::MotorHot)
                    );
                    bench.run(4_000, None, at_rest);
                }
                assert_eq!(bench.supervisor.request(Request::Clear), Ok(State::Inactive), "{name}");
                assert_eq!(bench.run(3, Some(1.0), at_rest), 0.0, "{name}: cleared is not active");
                bench.supervisor.request(Request::Activate).unwrap();
                assert_eq!(bench.step(None, at_rest), 0.0, "{name}: no command of before moves it");
                assert_eq!(bench.step(Some(1.0), at_rest), 1.0, "{name}");
            }
        }
    }
}

#[test]
fn just_inside_each_limit_nothing_happens() {
    let wide = Some(Travel { min: -2000.0, max: 2000.0, margin: 0.1 });
    let mut bench = Bench::active(SafetyLimits { travel: wide, motor: None, ..limits() });
    for cycle in 0..3_000u32 {
        let (sine, cosine) = (f64::from(cycle) * 0.01).sin_cos();
        let volts = bench.step(Some(5.9 * sine), |seen, _| {
            seen.tachometer_velocity += 9.3 * sine;
            seen.encoder_position = 9.3 * 1e-3 / 0.01 * (1.0 - cosine);
            seen.torque += 0.3 * sine;
        });
        assert!(
            (volts - 5.9 * sine).abs() < 1e-12,
            "cycle {cycle}: {:?}",
            bench.supervisor.held_back()
        );
    }
    assert_eq!(bench.supervisor.latched(), None);
    // Two readings too fast are a spark of the brushes; commands may be 20 ms old, cycles 20 ms
    // long.
    let rest = 0.93 * (1.0 - (3_000.0f64 * 0.01).cos());
    let at_rest = |seen: &mut Measurement, _: u64| seen.encoder_position = rest;
    bench.run(2, Some(1.0), |seen, _| {
        seen.tachometer_velocity = 9.6;
        seen.encoder_position = rest;
    });
    bench.step(Some(1.0), at_rest);
    assert_eq!(bench.run(19, None, at_rest), 1.0);
    assert_eq!(bench.step_after(0.019, Some(1.0), at_rest), 1.0);
    assert_eq!(bench.supervisor.latched(), None);
}

/// A reading of exactly zero for ever is no tachometer: a shaft that turns is not as hot as one that
/// is held.
#[test]
fn a_rig_without_a_tachometer_is_as_warm_as_its_encoder_says() {
    let limits = SafetyLimits {
        velocity: 50.0,
        travel: None,
        sensors: SensorChecks { agreement: None, torque_range: None, frozen_cycles: None },
        ..limits()
    };
    let rise = |speed: f64| {
        let mut supervisor = SafetySupervisor::new(limits, 1e-3).unwrap();
        supervisor.request(Request::Configure).unwrap();
        supervisor.request(Request::Activate).unwrap();
        for cycle in 0..20_000 {
            let time = 1e-3 * cycle as f64;
            let encoder_position = speed * time;
            let seen = Measurement { cycle, time, encoder_position, ..Measurement::default() };
            supervisor.cycle(time, &seen);
            supervisor.command(time, 2.5);
            supervisor.output();
        }
        assert_eq!(supervisor.latched(), None);
        supervisor.rise().unwrap()
    };
    let back_emf = limits.motor.unwrap().back_emf;
    let (held, turning) = (rise(0.0), rise(0.9 * 2.5 / back_emf));
    assert!(held > 30.0 && turning < 0.02 * held, "{held} {turning}");
}

/// Measurements that are lost on a busy machine's way from the device, most of them while the shaft
/// turns back: the tachometer was averaged by samples, the encoder by time, and sensors that agree
/// stopped the motor.
#[test]
fn sensors_that_agree_may_lose_measurements() {
    let stopped_by = |gain: f64| {
        let mut supervisor = SafetySupervisor::new(limits(), 1e-3).unwrap();
        supervisor.request(Request::Configure).unwrap();
        supervisor.request(Request::Activate).unwrap();
        let speed = std::f64::consts::TAU / 0.05;
        for cycle in 0..3000 {
            let time = 1e-3 * cycle as f64;
            let (sin, cos) = (speed * time).sin_cos();
            if sin < 0.0 && cycle % 5 != 0 {
                continue;
            }
            let seen = Measurement {
                cycle,
                time,
                encoder_position: 6.0 / speed * (1.0 - cos),
                tachometer_velocity: gain * 6.0 * sin + 1e-6 * cycle as f64,
                torque: 1e-6 * cycle as f64,
                ..Measurement::default()
            };
            supervisor.cycle(time, &seen);
            supervisor.command(time, 0.5);
            supervisor.output();
        }
        supervisor.latched().map(|report| report.fault)
    };
    assert_eq!(stopped_by(1.0), None);
    assert_eq!(stopped_by(-1.0), Some(Fault::SensorsDisagree));
}

#[test]
fn at_the_end_of_the_travel_only_the_way_back_is_free() {
    let mut bench = Bench::active(limits());
    let beyond = |seen: &mut Measurement, _: u64| seen.encoder_position = 3.05;
    assert_eq!(bench.run(3, Some(2.0), beyond), 0.0);
    assert_eq!(bench.step(Some(-2.0), beyond), -2.0);
    assert_eq!(bench.supervisor.state(), State::Active);
}

#[test]
fn an_older_command_does_not_replace_a_newer_one_and_none_comes_from_the_future() {
    let mut bench = Bench::active(limits());
    bench.step(Some(1.0), at_rest);
    bench.supervisor.command(bench.now - 0.005, -1.0);
    assert_eq!(bench.supervisor.output(), 1.0);
    // A stamp far ahead does not make a command valid for long.
    bench.supervisor.command(bench.now + 1e6, 1.5);
    assert_eq!(bench.run(25, None, at_rest), 0.0);
}

#[test]
fn an_emergency_stop_holds_from_every_state_until_it_is_cleared_and_all_is_set_up_again() {
    for state in [State::Unconfigured, State::Inactive, State::Active, State::Faulted] {
        let mut bench = Bench::new(limits());
        if state != State::Unconfigured {
            bench.supervisor.request(Request::Configure).unwrap();
        }
        if state == State::Active {
            bench.supervisor.request(Request::Activate).unwrap();
        }
        if state == State::Faulted {
            bench.supervisor.fault(Fault::BackEnd, 0.0, 0.0);
        }
        assert_eq!(bench.supervisor.state(), state);
        bench.run(3, Some(2.0), at_rest);
        assert_eq!(bench.supervisor.request(Request::EmergencyStop), Ok(State::EmergencyStopped));
        assert_eq!(bench.run(3, Some(2.0), at_rest), 0.0);
        assert!(bench.supervisor.request(Request::Activate).is_err());
        assert_eq!(bench.supervisor.request(Request::Clear), Ok(State::Unconfigured));
        assert_eq!(bench.run(3, Some(2.0), at_rest), 0.0);
        bench.supervisor.request(Request::Configure).unwrap();
        bench.supervisor.request(Request::Activate).unwrap();
        assert_eq!(bench.step(Some(2.0), at_rest), 2.0);
    }
}

/// A rig that keeps what its motor got and what it was told, and can refuse.
#[derive(Debug, Default)]
struct Recording {
    cycle: u64,
    applied: std::rc::Rc<std::cell::RefCell<Vec<f64>>>,
    told: std::rc::Rc<std::cell::RefCell<Vec<&'static str>>>,
    refuse_at: Option<u64>,
}

impl Rig for Recording {
    fn period(&self) -> f64 {
        PERIOD
    }

    fn measure(&mut self) -> Measurement {
        noisy(self.cycle, self.cycle as f64 * PERIOD)
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        self.cycle += 1;
        if self.refuse_at == Some(self.cycle) {
            return Err(RigError::VoltageNotFinite(volts));
        }
        self.applied.borrow_mut().push(volts);
        Ok(())
    }

    fn activate(&mut self) -> Result<(), RigError> {
        self.told.borrow_mut().push("activate");
        Ok(())
    }

    fn deactivate(&mut self) -> Result<(), RigError> {
        self.told.borrow_mut().push("deactivate");
        self.halt()
    }

    fn emergency_stop(&mut self) -> Result<(), RigError> {
        self.told.borrow_mut().push("emergency stop");
        self.halt()
    }
}

#[test]
fn a_back_end_is_told_to_rest_once_when_a_fault_latches_and_of_every_emergency_stop() {
    let rig = Recording::default();
    let told = rig.told.clone();
    let mut rig = Supervised::new(rig, SafetyLimits::default()).unwrap();
    let heard = || std::mem::take(&mut *told.borrow_mut());
    rig.request(Request::Configure).unwrap();
    rig.request(Request::Activate).unwrap();
    rig.measure();
    rig.apply(1.0).unwrap();
    assert_eq!(heard(), ["activate"]);
    assert!(rig.apply(f64::NAN).is_err());
    for _ in 0..3 {
        rig.measure();
        let _ = rig.apply(0.0);
    }
    assert_eq!(heard(), ["deactivate"], "a fault that latches here deactivates the device, once");
    rig.request(Request::Clear).unwrap();
    rig.request(Request::Activate).unwrap();
    rig.request(Request::Deactivate).unwrap();
    assert_eq!(heard(), ["activate", "deactivate"]);
    rig.request(Request::Activate).unwrap();
    rig.request(Request::EmergencyStop).unwrap();
    rig.request(Request::EmergencyStop).unwrap();
    rig.measure();
    assert_eq!(heard(), ["activate", "emergency stop", "emergency stop"]);
}

#[test]
fn a_supervised_rig_stops_when_its_back_end_refuses_and_says_so() {
    let rig = Recording { refuse_at: Some(5), ..Recording::default() };
    let applied = rig.applied.clone();
    let mut rig = Supervised::activated(rig, SafetyLimits::default()).unwrap();
    for attempt in 1..=8 {
        rig.measure();
        let result = rig.apply(1.0);
        match attempt {
            1..5 => assert_eq!(result, Ok(())),
            5 => assert!(matches!(result, Err(RigError::VoltageNotFinite(_)))),
            _ => assert!(
                matches!(result, Err(RigError::Safety(report)) if report.fault == Fault::BackEnd)
            ),
        }
    }
    assert!(rig.measure().fault);
    assert_eq!(*applied.borrow(), [1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
}

#[test]
fn a_supervised_rig_leaves_zero_volts_when_it_is_dropped_or_its_owner_panics() {
    let rig = Recording::default();
    let applied = rig.applied.clone();
    let mut rig = Supervised::activated(rig, SafetyLimits::default()).unwrap();
    let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(move || {
        rig.measure();
        rig.apply(1.5).unwrap();
        std::panic::panic_any("a controller with a mistake");
    }));
    assert!(outcome.is_err());
    assert_eq!(*applied.borrow(), [1.5, 0.0]);
}

#[test]
fn flags_of_the_measurement_tell_what_held_the_voltage_back() {
    let mut rig = Supervised::activated(Recording::default(), SafetyLimits::default()).unwrap();
    rig.tell_time(10.0);
    rig.measure();
    rig.apply(5.0).unwrap();
    rig.tell_time(10.001);
    let seen = rig.measure();
    assert!(seen.saturated && !seen.watchdog_expired && !seen.fault, "{seen:?}");
    assert_eq!(seen.voltage_asked, 5.0);
    rig.apply(1.0).unwrap();
    rig.tell_time(10.050);
    rig.measure();
    rig.apply(1.0).unwrap();
    rig.tell_time(10.051);
    let seen = rig.measure();
    assert!(!seen.saturated && seen.watchdog_expired && !seen.fault, "{seen:?}");
    assert!(rig.apply(f64::NAN).is_err());
    rig.tell_time(10.052);
    assert!(rig.measure().fault);
    assert!(rig.apply(0.0).is_ok(), "zero volts are never refused");
}

#[test]
fn a_rig_that_was_not_activated_refuses_to_move_and_says_what_to_do() {
    let mut rig = Supervised::new(Recording::default(), SafetyLimits::default()).unwrap();
    rig.measure();
    let text = rig.apply(1.0).unwrap_err().to_string();
    assert!(text.contains("unconfigured") && text.contains("activate"), "{text}");
}

/// What can happen in a cycle.
#[derive(Debug, Clone)]
struct Happening {
    gap: f64,
    command: Option<(f64, f64)>,
    request: Option<Request>,
    velocity: f64,
    encoder_step: f64,
    torque: f64,
    back_end_fault: bool,
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        20 => -7.0..7.0,
        3 => -1e3..1e3,
        1 => prop::sample::select(vec![f64::NAN, f64::INFINITY, -f64::INFINITY, 1e308, -0.0]),
    ]
}

fn happening() -> impl Strategy<Value = Happening> {
    let gap = prop_oneof![30 => Just(PERIOD), 3 => 0.0..0.05, 1 => -0.01..2.0, 1 => Just(f64::NAN)];
    let stamp = prop_oneof![20 => Just(0.0), 5 => -0.05..0.05, 1 => Just(f64::NAN), 1 => -1e3..1e3];
    // Requests that bring it back to active are more frequent, so that much of the time it is;
    // shutting down would end the case.
    let request = prop_oneof![
        1 => prop::sample::select(vec![Request::CleanUp, Request::Deactivate, Request::EmergencyStop]),
        2 => Just(Request::Clear),
        3 => Just(Request::Configure),
        3 => Just(Request::Activate)
    ];
    let reading = prop_oneof![60 => -0.02..0.02, 2 => -12.0..12.0, 1 => number()];
    (
        gap,
        proptest::option::weighted(0.8, (stamp, number())),
        proptest::option::weighted(0.2, request),
        reading,
        -0.002..0.002f64,
        prop_oneof![60 => -0.2..0.2, 1 => number()],
        proptest::bool::weighted(0.005),
    )
        .prop_map(|(gap, command, request, velocity, encoder_step, torque, back_end_fault)| {
            Happening { gap, command, request, velocity, encoder_step, torque, back_end_fault }
        })
}

proptest! {
    #![proptest_config(ProptestConfig {
        failure_persistence: Some(Box::new(FileFailurePersistence::WithSource("regressions"))),
        ..ProptestConfig::default()
    })]

    /// The promises, from the outside: only what goes in and what comes out is looked at.
    #[test]
    fn under_any_commands_requests_and_readings_the_voltage_can_do_no_harm(
        happenings in prop::collection::vec(happening(), 1..400),
        voltage in 1.0..10.0f64,
        slew in 100.0..5000.0f64,
    ) {
        let motor = MotorThermal { time_constant: 0.5, ..SafetyLimits::default().motor.unwrap() };
        let limits = SafetyLimits { voltage, slew, motor: Some(motor), ..limits() };
        let mut supervisor = SafetySupervisor::new(limits, PERIOD).unwrap();
        supervisor.request(Request::Configure).unwrap();
        supervisor.request(Request::Activate).unwrap();
        supervisor.cycle(0.0, &noisy(0, 0.0));
        let (mut now, mut position, mut before) = (0.0f64, 0.0, 0.0f64);
        // Stamp of the newest command since the activation, as the rules have it.
        let mut newest: Option<f64> = None;
        for (cycle, happening) in (0u64..).zip(happenings) {
            let was = supervisor.state();
            let told = now + happening.gap;
            if told.is_finite() { now = now.max(told); }
            position += happening.encoder_step;
            let seen = Measurement {
                cycle,
                time: told,
                encoder_position: position,
                tachometer_velocity: happening.velocity,
                torque: happening.torque,
                fault: happening.back_end_fault,
                ..Measurement::default()
            };
            supervisor.cycle(told, &seen);
            let mut cleared = false;
            if let Some(request) = happening.request {
                let state = supervisor.state();
                if let Ok(to) = supervisor.request(request) {
                    prop_assert_eq!(next(state, Event::Asked(request)), Ok(to));
                    cleared = request == Request::Clear;
                    newest = None;
                }
            }
            let mut not_a_number = false;
            if let Some((offset, volts)) = happening.command {
                not_a_number = !(volts.is_finite() && offset.is_finite());
                if !not_a_number && supervisor.state().moves() {
                    let stamp = (now + offset).min(now);
                    newest = Some(newest.map_or(stamp, |before| before.max(stamp)));
                }
                supervisor.command(now + offset, volts);
            }
            let volts = supervisor.output();

            prop_assert!(volts.abs() <= voltage, "{} V, {} V are allowed", volts, voltage);
            let from = if volts * before > 0.0 { before.abs() } else { 0.0 };
            prop_assert!(volts.abs() <= from + slew * PERIOD + 1e-12, "from {} V to {} V", before, volts);
            if !supervisor.state().moves() {
                prop_assert_eq!(volts, 0.0, "{}", supervisor.state());
                newest = None;
            }
            if newest.is_none_or(|stamp| now - stamp > limits.command_age) {
                prop_assert_eq!(volts, 0.0, "the newest command is of {:?}, it is {}", newest, now);
            }
            if happening.gap > limits.cycle_late {
                prop_assert_eq!(volts, 0.0, "after a cycle of {} s", happening.gap);
            }
            let unreadable = !(happening.velocity.is_finite() && happening.torque.is_finite());
            if (unreadable || happening.back_end_fault) && !cleared && was != State::Unconfigured {
                prop_assert_eq!(volts, 0.0, "{:?}", seen);
                prop_assert!(!supervisor.state().moves());
            }
            if not_a_number {
                prop_assert!(!supervisor.state().moves());
            }
            if supervisor.state().moves() && !was.moves() {
                prop_assert_eq!(happening.request, Some(Request::Activate));
            }
            before = volts;
        }
    }

    /// Whatever speed and direction, sensors that agree raise no alarm; a gain that is off by half,
    /// and a wrong sign, do.
    #[test]
    fn agreement_of_the_sensors_is_told_from_disagreement(speed in 1.5..8.5f64, forwards: bool, gain in 0.9..1.1f64) {
        let speed = if forwards { speed } else { -speed };
        let disagree = Some(Fault::SensorsDisagree);
        for (gain, alarm) in [(gain, None), (0.5, disagree), (-1.0, disagree)] {
            let mut bench = Bench::active(SafetyLimits::default());
            bench.run(300, Some(1.0), |seen, cycle| {
                let turned = speed * cycle as f64 * PERIOD;
                let step = std::f64::consts::TAU / 4096.0;
                seen.encoder_position = (turned / step).floor() * step;
                seen.tachometer_velocity += gain * speed;
            });
            prop_assert_eq!(bench.supervisor.latched().map(|report| report.fault), alarm);
        }
    }
}
