//! Opens a rig by its address and reads it: `simulated`, `serial:/dev/ttyACM0`, `quanser:0`.
//!
//! `cargo run -p rig_driver --example open_by_address -- serial:/dev/ttyACM0`
//!
//! Nothing moves: the motor stays at zero volts until somebody activates the rig.

use std::error::Error;

use rig_driver::registry::{Pace, RigRegistry, RigSetup};
use rig_driver::{Rig, RigAddress};

/// Reads half a second of the rig of the command line, else of the simulated one.
pub fn main() -> Result<(), Box<dyn Error>> {
    for listed in RigRegistry::installed().listed() {
        println!("{:<13}  {}", listed.address, listed.about);
    }
    let asked = std::env::args().skip(1).find(|word| !word.starts_with('-'));
    let address = asked.map_or(Ok(RigAddress::simulated()), |text| text.parse())?;
    let opened = address.open(&RigSetup::default())?;
    println!("{address}: at most {} V, {} rad/s", opened.limits.voltage, opened.limits.velocity);

    let pace = opened.pace;
    let mut rig = opened.supervised()?;
    let mut seen = rig.measure();
    for _ in 0..(0.5 / rig.period()) as u32 {
        match pace {
            // A simulated rig goes on with each voltage.
            Pace::LockStep => {}
            Pace::Device => rig.wait()?,
            Pace::Clock => std::thread::sleep(std::time::Duration::from_secs_f64(rig.period())),
        }
        seen = rig.measure();
        rig.apply(0.0)?;
    }
    println!("at {:.3} rad, {:.3} rad/s", seen.encoder_position, seen.tachometer_velocity);
    assert_eq!(seen.voltage_applied, 0.0);
    Ok(())
}
