//! The whole controller: parts, limit, faults.

use controller::{
    AccelerationFeedback, Command, ControlFault, ControlMode, Controller, ControllerOptions,
    Dither, DitherShape, Feedback, Impulse, PiGains, PlantInverse, Reference, VelocityLaw,
    design::LinearDrive,
};
use friction_model::Motor;
use proptest::prelude::*;

/// Everything switched on.
fn everything() -> ControllerOptions {
    ControllerOptions {
        velocity: VelocityLaw::Pi(PiGains { k_p: 1.0, k_i: 10.0 }),
        inverse: PlantInverse::Whole(LinearDrive::THESIS),
        acceleration: Some(AccelerationFeedback { gain: 0.01, filter: 0.005 }),
        dither: Some(Dither { shape: DitherShape::Square, amplitude: 0.2, frequency: 100.0 }),
        impulse: Some(Impulse { height: 0.3, width: 0.002, period: 0.01 }),
        ..Default::default()
    }
}

fn sum(command: &Command) -> f64 {
    let Command { linear, inverse, friction, acceleration, dither, impulse, .. } = command;
    linear + inverse + friction + acceleration + dither + impulse
}

#[test]
fn the_parts_add_up() {
    let mut controller = Controller::new(everything()).unwrap();
    let mut seen = Command::default();
    for k in 0..100u32 {
        let w = 0.3 * (0.1 * f64::from(k)).sin();
        let reference = Reference { position: 0.0, velocity: 1.0, acceleration: 2.0 };
        let feedback = Feedback {
            velocity: w,
            friction: 0.1,
            cycle: Some(u64::from(k)),
            ..Default::default()
        };
        let command = controller.step(&reference, &feedback);
        assert!((command.inverse - (1.0 + 0.02388 * 2.0) / 1.863).abs() < 1e-12);
        assert!((command.friction - 0.1 * Motor::SRV02.volts_per_newton_metre()).abs() < 1e-12);
        assert!(!command.saturated && (command.total - sum(&command)).abs() < 1e-12);
        for (part, value) in [
            (&mut seen.acceleration, command.acceleration),
            (&mut seen.dither, command.dither),
            (&mut seen.impulse, command.impulse),
        ] {
            *part = part.max(value.abs());
        }
    }
    assert!(seen.acceleration > 0.1 && seen.dither == 0.2 && seen.impulse == 0.3, "{seen:?}");
}

#[test]
fn compensation_can_be_switched_off() {
    let mut options = ControllerOptions::default();
    options.compensation.enabled = false;
    let mut controller = Controller::new(options).unwrap();
    let command =
        controller.step(&Reference::default(), &Feedback { friction: 0.1, ..Default::default() });
    assert_eq!((command.friction, command.total), (0.0, 0.0));
}

#[test]
fn a_measurement_that_does_not_come_is_a_fault_until_reset() {
    let reference = Reference { velocity: 1.0, ..Default::default() };
    for bad in [
        Feedback { velocity: f64::NAN, ..Default::default() },
        Feedback { cycle: Some(3), ..Default::default() },
    ] {
        let why = if bad.cycle.is_some() { ControlFault::Stale } else { ControlFault::NotFinite };
        let good = |cycle| Feedback { cycle: Some(cycle), ..Default::default() };
        let mut controller = Controller::new(ControllerOptions::default()).unwrap();
        assert!(controller.step(&reference, &good(3)).total > 0.0);
        for missed in 1..=10 {
            let command = controller.step(&reference, &bad);
            assert_eq!((command.total, command.fault), (0.0, None), "{missed}");
        }
        assert!(controller.step(&reference, &good(4)).total > 0.0);
        let bad = Feedback { cycle: bad.cycle.map(|_| 4), ..bad };
        for _ in 0..11 {
            assert_eq!(controller.step(&reference, &bad).total, 0.0);
        }
        let command = controller.step(&reference, &good(5));
        assert_eq!((command.total, command.fault), (0.0, Some(why)));
        controller.reset();
        assert!(controller.step(&reference, &good(6)).total > 0.0);
    }
}

proptest! {
    /// Whatever comes in, the voltage stays within its limit and is a number.
    #[test]
    fn the_voltage_is_always_within_its_limit(
        position_mode in any::<bool>(),
        inputs in prop::collection::vec((any::<f64>(), any::<f64>(), any::<f64>(), any::<f64>()), 1..100),
    ) {
        let mode = if position_mode { ControlMode::Position } else { ControlMode::Velocity };
        let mut controller = Controller::new(ControllerOptions { mode, ..everything() }).unwrap();
        for (r, position, velocity, friction) in inputs {
            let reference = Reference { position: r, velocity: r, acceleration: r };
            let command = controller.step(&reference, &Feedback { position, velocity, friction, cycle: None });
            prop_assert!(command.total.abs() <= 6.0);
        }
    }

    /// A value that is not a number leaves no trace once it is gone.
    #[test]
    fn a_bad_reading_leaves_no_trace(mode in prop::sample::select(vec![ControlMode::Velocity, ControlMode::Position])) {
        let mut controller = Controller::new(ControllerOptions { mode, ..everything() }).unwrap();
        let reference = Reference { position: 0.1, velocity: 0.1, acceleration: 0.0 };
        controller.step(&reference, &Feedback::default());
        let mut untouched = controller.clone();
        let bad = Feedback { position: f64::NAN, velocity: f64::NAN, friction: 0.0, cycle: None };
        prop_assert_eq!(controller.step(&reference, &bad).total, 0.0);
        prop_assert_eq!(controller.step(&reference, &Feedback::default()), untouched.step(&reference, &Feedback::default()));
    }
}
