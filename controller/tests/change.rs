//! Changes while running: no jump of the voltage, and the new dynamics from there on.

use controller::{
    AccelerationFeedback, ControlMode, Controller, ControllerOptions, DerivativeOn, Feedback,
    LagGains, PiGains, PidGains, PlantInverse, Reference, VelocityLaw, design::LinearDrive,
};
use friction_model::Motor;

const DT: f64 = 1e-3;
const DRIVE: LinearDrive = LinearDrive::THESIS;

/// A drive without friction, integrated exactly.
#[derive(Default)]
struct Shaft {
    position: f64,
    velocity: f64,
}

impl Shaft {
    fn step(&mut self, controller: &mut Controller, reference: &Reference) -> f64 {
        self.step_with(controller, reference, 0.08)
    }

    fn step_with(
        &mut self,
        controller: &mut Controller,
        reference: &Reference,
        friction: f64,
    ) -> f64 {
        let feedback =
            Feedback { position: self.position, velocity: self.velocity, friction, cycle: None };
        let u = controller.step(reference, &feedback).total;
        // The compensated 0.08 N m are really there.
        let drive = u - 0.08 * 4.8426;
        let decay = (-DT / DRIVE.time_constant).exp();
        let end = DRIVE.gain * drive;
        self.position += end * DT + (self.velocity - end) * DRIVE.time_constant * (1.0 - decay);
        self.velocity = end + (self.velocity - end) * decay;
        u
    }
}

fn pi(k_p: f64, k_i: f64) -> VelocityLaw {
    VelocityLaw::Pi(PiGains { k_p, k_i })
}

/// Largest step of the voltage around a change after two seconds on a ramp of position, and the
/// largest step within the 100 cycles before it.
fn jump(from: ControllerOptions, to: ControllerOptions) -> (f64, f64) {
    let mut controller = Controller::new(from).unwrap();
    let mut shaft = Shaft::default();
    let at =
        |k: u32| Reference { position: 0.5 * DT * f64::from(k), velocity: 0.5, acceleration: 0.0 };
    let (mut last, mut usual) = (0.0, 0.0f64);
    for k in 0..2000 {
        let u = shaft.step(&mut controller, &at(k));
        if k > 1900 {
            usual = usual.max((u - last).abs());
        }
        last = u;
    }
    controller.change(to).unwrap();
    ((shaft.step(&mut controller, &at(2000)) - last).abs(), usual)
}

#[test]
fn no_change_of_gains_law_mode_inverse_or_compensation_makes_the_voltage_jump() {
    let velocity = ControllerOptions { velocity: pi(1.0, 20.0), ..Default::default() };
    let position = ControllerOptions { mode: ControlMode::Position, ..Default::default() };
    let mut half = velocity;
    half.compensation.scale = 0.5;
    let mut off = velocity;
    off.compensation.enabled = false;
    let without_integral = PidGains { k_i: 0.0, ..PidGains::THESIS };
    for (from, to, what) in [
        (velocity, ControllerOptions { velocity: pi(3.0, 90.0), ..velocity }, "gains"),
        (
            velocity,
            ControllerOptions { velocity: VelocityLaw::Lag(LagGains::THESIS), ..velocity },
            "pi to lag",
        ),
        (ControllerOptions::default(), velocity, "lag to pi"),
        (velocity, position, "velocity to position"),
        (position, velocity, "position to velocity"),
        (
            position,
            ControllerOptions { pid: PidGains { k_p: 9.0, k_i: 30.0, k_d: 0.2 }, ..position },
            "pid",
        ),
        (
            position,
            ControllerOptions { pid: without_integral, ..position },
            "no integral to take it",
        ),
        (
            position,
            ControllerOptions { derivative_on: DerivativeOn::Error, ..position },
            "derivative",
        ),
        (
            velocity,
            ControllerOptions { inverse: PlantInverse::Whole(DRIVE), ..velocity },
            "inverse",
        ),
        (velocity, half, "half the compensation"),
        (velocity, off, "compensation off"),
        (off, velocity, "compensation on"),
        (
            velocity,
            ControllerOptions {
                acceleration: Some(AccelerationFeedback { gain: 0.02, filter: 0.005 }),
                ..velocity
            },
            "acceleration",
        ),
    ] {
        let (jump, usual) = jump(from, to);
        // One cycle of the fade of .1 s moves the compensation by a hundredth of .39 V.
        assert!(jump < usual + 0.0055, "{what}: {jump} V, usually {usual} V");
    }
}

/// The whole compensation changes within the stated time, and in equal steps.
#[test]
fn the_compensation_fades_within_its_time() {
    let mut options = ControllerOptions { velocity: pi(1e-9, 0.0), ..Default::default() };
    let mut controller = Controller::new(options).unwrap();
    let feedback = Feedback { friction: 0.1, ..Default::default() };
    let mut friction = || {
        let mut parts = Vec::new();
        for _ in 0..150 {
            parts.push(controller.step(&Reference::default(), &feedback).friction);
        }
        options.compensation.enabled = false;
        controller.change(options).unwrap();
        parts
    };
    let (before, after) = (friction(), friction());
    // What overcomes 0.1 N m on the SRV-02.
    let whole = 0.1 * Motor::SRV02.volts_per_newton_metre();
    assert!(before.iter().all(|u| (u - whole).abs() < 1e-12));
    assert!((after[0] - whole).abs() < 1e-12 && (after[50] - 0.5 * whole).abs() < 1e-9);
    assert_eq!(after[100], 0.0);
}

/// After a change of PI gains the error follows `e(k+2) = -(a e(k+1) + b e(k))` with the
/// coefficients of the new gains, and no longer those of the old.
#[test]
fn after_the_change_the_poles_are_the_new_ones() {
    let characteristic = |k_p: f64, k_i: f64| {
        // (z - 1)(z - p) + K (1 - p) (c1 z + c0) with the trapezoidal PI (c1 z + c0) / (z - 1).
        let p = (-DT / DRIVE.time_constant).exp();
        let (c1, c0) = (k_p + 0.5 * k_i * DT, -k_p + 0.5 * k_i * DT);
        let b = DRIVE.gain * (1.0 - p);
        (-(1.0 + p) + b * c1, p + b * c0)
    };
    let mut controller =
        Controller::new(ControllerOptions { velocity: pi(0.5, 20.0), ..Default::default() })
            .unwrap();
    let mut shaft = Shaft::default();
    let reference = Reference { velocity: 0.5, ..Default::default() };
    let mut errors = Vec::new();
    for k in 0..60 {
        if k == 30 {
            controller
                .change(ControllerOptions { velocity: pi(1.5, 60.0), ..Default::default() })
                .unwrap();
        }
        errors.push(reference.velocity - shaft.velocity);
        shaft.step(&mut controller, &reference);
    }
    let residual = |(a, b): (f64, f64), range: std::ops::Range<usize>| {
        errors[range].windows(3).map(|e| (e[2] + a * e[1] + b * e[0]).abs()).fold(0.0, f64::max)
    };
    let (old, new) = (characteristic(0.5, 20.0), characteristic(1.5, 60.0));
    assert!(residual(old, 1..30) < 1e-12, "{}", residual(old, 1..30));
    assert!(residual(new, 31..60) < 1e-12, "{}", residual(new, 31..60));
    assert!(residual(old, 31..60) > 1e-6);
}

/// The lag has no integrator: it starts without a jump, and comes to its own output within its time
/// constant.
#[test]
fn a_lag_leaves_the_taken_over_voltage_for_its_own() {
    let lag = LagGains::THESIS;
    let mut from = ControllerOptions { velocity: pi(1.0, 1.0), ..Default::default() };
    from.compensation.enabled = false;
    let mut controller = Controller::new(from).unwrap();
    let reference = Reference { velocity: 0.01, ..Default::default() };
    let mut u = 0.0;
    for _ in 0..50_000 {
        u = controller.step(&reference, &Feedback::default()).total;
    }
    controller.change(ControllerOptions { velocity: VelocityLaw::Lag(lag), ..from }).unwrap();
    assert!((controller.step(&reference, &Feedback::default()).total - u).abs() < 1e-12);
    let seconds = 10.0 * lag.t_i / lag.gamma;
    for _ in 0..(seconds / DT) as usize {
        u = controller.step(&reference, &Feedback::default()).total;
    }
    assert!((u - 0.01 * lag.k_p / lag.gamma).abs() < 1e-4, "{u}");
}

#[test]
fn a_refused_change_leaves_the_controller_as_it_was() {
    let mut controller = Controller::new(ControllerOptions::default()).unwrap();
    let reference = Reference { velocity: 0.2, ..Default::default() };
    controller.step(&reference, &Feedback::default());
    let mut untouched = controller.clone();
    for wrong in [
        ControllerOptions { period: 2e-3, ..Default::default() },
        ControllerOptions { velocity: pi(-1.0, 0.0), ..Default::default() },
    ] {
        assert!(controller.change(wrong).is_err());
    }
    assert_eq!(
        controller.step(&reference, &Feedback::default()),
        untouched.step(&reference, &Feedback::default())
    );
}

/// A drive with 0.08 N m of friction, whose estimate goes away for a second and comes back.
#[test]
fn an_estimate_that_is_lost_and_comes_back_makes_no_jump() {
    let velocity = ControllerOptions { velocity: pi(1.0, 20.0), ..Default::default() };
    let position = ControllerOptions { mode: ControlMode::Position, ..Default::default() };
    let without_integral = PidGains { k_i: 0.0, ..PidGains::THESIS };
    for options in [
        velocity,
        ControllerOptions::default(),
        position,
        ControllerOptions { pid: without_integral, ..position },
    ] {
        let mut controller = Controller::new(options).unwrap();
        let mut shaft = Shaft::default();
        let (mut last, mut fastest, mut jump) = (0.0, 0.0f64, 0.0f64);
        for k in 0..5000u32 {
            let friction = if (2000..3000).contains(&k) { 0.0 } else { 0.08 };
            if k == 2000 || k == 3000 {
                controller.replace_estimate(friction);
            }
            let reference =
                Reference { position: 0.5 * DT * f64::from(k), velocity: 0.5, acceleration: 0.0 };
            let u = shaft.step_with(&mut controller, &reference, friction);
            if k > 1500 {
                jump = jump.max((u - last).abs());
                fastest = fastest.max(shaft.velocity);
            }
            last = u;
        }
        // The compensation itself is 0.39 V.
        assert!(jump < 0.02, "{options:?}: {jump} V");
        let allowed = if options.pid.k_i == 0.0 { 1.0 } else { 0.51 };
        assert!(fastest < allowed, "{options:?}: {fastest} rad/s");
        // The lag compensator holds to a hundredth.
        assert!((shaft.velocity - 0.5).abs() < 0.01, "{options:?}: {} rad/s", shaft.velocity);
    }
}

/// Where nothing is compensated, an estimate is of no importance.
#[test]
fn an_estimate_that_is_not_used_changes_nothing_when_it_is_lost() {
    let mut off = ControllerOptions { velocity: pi(1.0, 20.0), ..Default::default() };
    off.compensation.enabled = false;
    let mut controller = Controller::new(off).unwrap();
    let mut told = controller.clone();
    for k in 0..100u32 {
        let feedback =
            Feedback { position: 0.0, velocity: 0.01 * f64::from(k), friction: 0.08, cycle: None };
        let reference = Reference { velocity: 0.5, ..Reference::default() };
        told.replace_estimate(0.0);
        assert_eq!(controller.step(&reference, &feedback), told.step(&reference, &feedback));
    }
}
