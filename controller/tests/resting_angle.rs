//! An integral that stands still while the reference does, so that friction holds the shaft.

use controller::{ControlMode, Controller, ControllerOptions, Feedback, PidGains, Reference};

fn controller(resting_angle: f64) -> Controller {
    Controller::new(ControllerOptions {
        mode: ControlMode::Position,
        pid: PidGains { k_p: 10.0, k_i: 50.0, k_d: 0.0 },
        resting_angle,
        ..ControllerOptions::default()
    })
    .unwrap()
}

/// Voltage after a second with a shaft that stands `error` short of a reference of that velocity.
fn after_a_second(resting_angle: f64, error: f64, velocity: f64) -> f64 {
    let mut controller = controller(resting_angle);
    let reference = Reference { position: error, velocity, acceleration: 0.0 };
    let feedback =
        |cycle| Feedback { position: 0.0, velocity: 0.0, friction: 0.0, cycle: Some(cycle) };
    (0..1000).map(|cycle| controller.step(&reference, &feedback(cycle)).total).last().unwrap()
}

#[test]
fn within_the_angle_the_integral_stands_still_and_beyond_it_works() {
    assert!((after_a_second(0.01, 0.005, 0.0) - 0.05).abs() < 1e-3);
    // 50 V/(rad s) x 0.02 rad x 1 s beside 10 V/rad x 0.02 rad.
    assert!((after_a_second(0.01, 0.02, 0.0) - 1.2).abs() < 2e-3);
    assert!((after_a_second(0.0, 0.005, 0.0) - 0.3).abs() < 1e-3);
}

#[test]
fn a_reference_that_moves_has_its_integral_however_small_the_error() {
    assert!((after_a_second(0.01, 0.005, 0.1) - 0.3).abs() < 1e-3);
}

#[test]
fn an_angle_below_zero_is_refused() {
    let options = ControllerOptions { resting_angle: -1.0, ..ControllerOptions::default() };
    assert!(Controller::new(options).unwrap_err().to_string().contains("resting_angle"));
}
