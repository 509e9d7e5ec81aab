//! The back end: a flywheel on an ideal motor, worked out in this process. Yours would talk to a
//! board, a card or a simulator instead.

use rig_driver::{Measurement, Rig, RigError};

/// Torque per volt at the load [N m/V], and the back-EMF constant [V s/rad].
const TORQUE_PER_VOLT: f64 = 0.2;
const BACK_EMF: f64 = 0.5;

/// The flywheel at its present speed.
#[derive(Debug, Clone)]
pub struct Flywheel {
    inertia: f64,
    velocity: f64,
    position: f64,
    volts: f64,
    cycle: u64,
}

impl Flywheel {
    /// At rest, with this inertia [kg m^2].
    #[must_use]
    pub const fn new(inertia: f64) -> Self {
        Self { inertia, velocity: 0.0, position: 0.0, volts: 0.0, cycle: 0 }
    }
}

impl Rig for Flywheel {
    fn period(&self) -> f64 {
        1e-3
    }

    fn voltage_range(&self) -> f64 {
        5.0
    }

    fn measure(&mut self) -> Measurement {
        Measurement {
            cycle: self.cycle,
            time: self.cycle as f64 * self.period(),
            encoder_counts: (self.position * 1000.0).round() as i64,
            encoder_position: self.position,
            tachometer_velocity: self.velocity,
            voltage_asked: self.volts,
            voltage_applied: self.volts,
            ..Measurement::default()
        }
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        if !volts.is_finite() {
            self.volts = 0.0;
            return Err(RigError::VoltageNotFinite(volts));
        }
        self.volts = volts;
        let torque = TORQUE_PER_VOLT * (volts - BACK_EMF * self.velocity);
        self.velocity += torque / self.inertia * self.period();
        self.position += self.velocity * self.period();
        self.cycle += 1;
        Ok(())
    }
}
