//! A rig of one's own: two files for the back end, one line to make it known, and everything else
//! is there: its address, the safety layer, limits, calibration.
//!
//! `cargo run --manifest-path examples/own_rig/Cargo.toml`

mod factory;
mod flywheel;

use std::error::Error;

use rig_driver::registry::{RigRegistry, RigSetup};
use rig_driver::safety::{Request, RigLimits};
use rig_driver::{Rig, RigAddress};

use factory::FlywheelFactory;

/// Velocity that is asked for [rad/s], and the gain of the loop [V s/rad].
const WANTED: f64 = 3.0;
const GAIN: f64 = 2.0;

fn main() -> Result<(), Box<dyn Error>> {
    // From here on every address in this program may be a flywheel's.
    RigRegistry::standard().with(FlywheelFactory).install()?;
    println!("rigs: {}", RigRegistry::installed().grammar());

    let address: RigAddress = "flywheel:0.002".parse()?;
    let limits = RigLimits { voltage: Some(4.0), ..RigLimits::default() };
    let opened = address.open(&RigSetup { limits, ..RigSetup::default() })?;
    println!("{address}: {}", opened.about.as_deref().unwrap_or("it says nothing of itself"));

    // The motor moves only under supervision, and only once it is active.
    let mut rig = opened.supervised()?;
    assert!(rig.measure().voltage_applied == 0.0 && rig.apply(1.0).is_err());
    rig.request(Request::Configure)?;
    rig.request(Request::Activate)?;
    for _ in 0..1000 {
        let seen = rig.measure();
        rig.apply(GAIN * (WANTED - seen.tachometer_velocity) + 0.5 * WANTED)?;
    }
    println!("after 1 s it turns at {:.3} rad/s", rig.measure().tachometer_velocity);

    // A controller that has gone wrong stops the motor, and the fault says why.
    let fault = rig.apply(f64::NAN).and_then(|()| rig.apply(1.0)).unwrap_err();
    println!("{fault}");
    Ok(())
}
