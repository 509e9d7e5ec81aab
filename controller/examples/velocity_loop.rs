//! A velocity loop with friction compensation on a simple drive: the command holds the reference
//! although the drive has Coulomb friction.

use controller::{Controller, ControllerError, ControllerOptions, Feedback, Reference};
use friction_model::Motor;

fn main() -> Result<(), ControllerError> {
    let mut controller = Controller::new(ControllerOptions::default())?;
    let (dt, motor) = (1e-3, Motor::SRV02);
    let (friction, mut velocity) = (0.09, 0.0);
    for _ in 0..2000 {
        let reference = Reference { velocity: 1.0, ..Reference::default() };
        let feedback = Feedback { velocity, friction, ..Feedback::default() };
        let volts = controller.step(&reference, &feedback).total;
        // The drive: T w' + w = K (u - r F).
        let driving = volts - motor.volts_per_newton_metre() * friction;
        velocity += dt / motor.time_constant() * (motor.gain() * driving - velocity);
    }
    println!("{velocity:.4} rad/s, wanted 1.0000");
    // The lag compensator leaves one per cent.
    assert!((velocity - 1.0).abs() < 0.02);
    Ok(())
}

#[test]
fn it_runs() {
    main().unwrap();
}
