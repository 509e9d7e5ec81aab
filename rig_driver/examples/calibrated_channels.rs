//! A simulated rig with mistakes in its wiring, its readings put right by a calibration, and a
//! friction that drifts while it runs.
//!
//! `cargo run -p rig_driver --example calibrated_channels`

use std::error::Error;

use rig_driver::registry::RigSetup;
use rig_driver::{Calibration, FrictionDrift, Miswiring, Rig, RigAddress, Sign, SimulationOptions};

/// Turns the shaft by 2 V for a second, and says how far and how fast by its sensors.
fn turn(setup: &RigSetup) -> Result<(f64, f64), Box<dyn Error>> {
    let mut rig = RigAddress::simulated().open(setup)?.rig;
    for _ in 0..1000 {
        rig.measure();
        rig.apply(2.0)?;
    }
    let seen = rig.measure();
    Ok((seen.encoder_position, seen.tachometer_velocity))
}

/// Compares a rig that is right with one that is wired wrong, raw and calibrated.
pub fn main() -> Result<(), Box<dyn Error>> {
    let right = RigSetup::default();
    // The encoder's lines are swapped, and the tachometer shows a tenth too little.
    let wiring: Miswiring = "encoder,tachometer=0.9".parse()?;
    let wrong = RigSetup { wiring: Some(wiring), ..right };
    let calibration = Calibration {
        encoder_sign: Sign::Reversed,
        tachometer_gain: 1.0 / 0.9,
        ..Calibration::default()
    };
    let mended = RigSetup { calibration: Some(calibration), ..wrong };
    let (position, velocity) = turn(&right)?;
    for (name, setup) in [("right", &right), ("wired wrong", &wrong), ("calibrated", &mended)] {
        let (position, velocity) = turn(setup)?;
        println!("{name:<12} {position:7.3} rad {velocity:6.3} rad/s");
    }
    assert_eq!(turn(&wrong)?.0, -position);
    assert_eq!(turn(&mended)?.0, position);
    assert!((turn(&mended)?.1 - velocity).abs() < 0.01);

    // A fault that no calibration mends: the friction grows by half within the second.
    let drift = FrictionDrift { change: 0.5, start: 0.0, duration: 1.0 };
    let simulation = SimulationOptions { friction_drift: Some(drift), ..right.simulation };
    let (_, slower) = turn(&RigSetup { simulation, ..right })?;
    println!("with more friction     {slower:6.3} rad/s");
    assert!(slower < 0.9 * velocity);
    Ok(())
}
