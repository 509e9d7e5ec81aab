//! A friction model in a control loop: one step a period, from the measured velocity to the torque.

use friction_model::{LuGre, LuGreParameters, ModelError, Stepper, TimeStep};

fn main() -> Result<(), ModelError> {
    // A small servo: N m, rad, s. What no contact can have is refused here, and nowhere later.
    let friction = LuGre::try_from(LuGreParameters {
        f_s: 0.10,
        f_c: 0.09,
        v_s: 0.14,
        delta: 2.0,
        sigma0: 16.5,
        sigma1: 0.25,
        v_d: None,
        f_v: 0.04,
    })?;
    let mut contact = Stepper::new(friction, TimeStep::new(1e-3)?);

    // Two seconds of a slow sine. A step neither allocates nor panics, whatever a sensor says.
    let (mut lowest, mut highest) = (0.0f64, 0.0f64);
    for k in 0..2000 {
        let velocity = 0.3 * (3.0 * 1e-3 * f64::from(k)).sin();
        let torque = contact.step(velocity);
        (lowest, highest) = (lowest.min(torque), highest.max(torque));
        if k % 250 == 0 {
            let inside = contact.internals(velocity);
            println!("{velocity:6.3} rad/s: {torque:7.4} N m, {:?}", inside.regime);
        }
    }
    println!("from {lowest:.4} to {highest:.4} N m");
    assert!(lowest < -0.09 && highest > 0.09);
    Ok(())
}

#[test]
fn it_runs() -> Result<(), ModelError> {
    main()
}
