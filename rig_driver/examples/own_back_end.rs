//! The safety layer around a back end of one's own, without any registry: three methods make a rig,
//! and every voltage for it goes through the supervisor.
//!
//! `cargo run -p rig_driver --example own_back_end`

use std::error::Error;

use rig_driver::safety::{Fault, Request, SafetyLimits, SensorChecks, State, Supervised};
use rig_driver::{Measurement, Rig, RigError};

/// A motor without a load: its speed follows the voltage at once.
struct Free {
    volts: f64,
    cycle: u32,
}

impl Rig for Free {
    fn period(&self) -> f64 {
        0.01
    }

    fn measure(&mut self) -> Measurement {
        let time = f64::from(self.cycle) * self.period();
        Measurement {
            cycle: self.cycle.into(),
            time,
            tachometer_velocity: 2.0 * self.volts,
            voltage_applied: self.volts,
            ..Measurement::default()
        }
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        self.volts = volts;
        self.cycle += 1;
        Ok(())
    }
}

/// Drives it too fast, and shows what the safety layer does.
pub fn main() -> Result<(), Box<dyn Error>> {
    let usual = SafetyLimits::default();
    let limits = SafetyLimits {
        voltage: 6.0,
        velocity: 8.0,
        // Cycles of 10 ms; a slope that reaches 6 V within three of them.
        slew: 200.0,
        // It has no encoder to compare with, and no torque sensor.
        sensors: SensorChecks { agreement: None, torque_range: None, frozen_cycles: None },
        ..usual
    };
    let mut rig = Supervised::activated(Free { volts: 0.0, cycle: 0 }, limits)?;

    // 3 V are 6 rad/s: allowed, and reached no faster than the slew rate lets them.
    for _ in 0..5 {
        let seen = rig.measure();
        println!("{:.2} V, {:.1} rad/s", seen.voltage_applied, seen.tachometer_velocity);
        rig.apply(3.0)?;
    }
    assert_eq!(rig.measure().tachometer_velocity, 6.0);

    // 5 V are 10 rad/s: the motor is stopped, and stays so until somebody clears the fault.
    while rig.apply(5.0).is_ok() {
        rig.measure();
    }
    let fault = rig.latched_fault().ok_or("a fault is latched")?;
    println!("{fault}");
    assert_eq!((fault.fault, rig.supervisor().state()), (Fault::Overspeed, State::Faulted));
    rig.measure();
    rig.request(Request::Clear)?;
    println!("cleared: {}", rig.supervisor().state());
    Ok(())
}
