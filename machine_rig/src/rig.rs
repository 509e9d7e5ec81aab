//! A machine as a rig.

use std::sync::{Arc, Mutex};

use rig_driver::{Measurement, Miswired, Rig, RigError, Truth};

use crate::simulated::{Simulated, locked};
use crate::{Break, Machine, MachineError};

/// A machine that somebody opened. Dropped, the motor has zero volts and the machine stays.
pub struct MachineRig {
    simulated: Arc<Mutex<Simulated>>,
    period: f64,
    voltage_range: f64,
    voltage_limit: f64,
    voltage_resolution: f64,
    /// Cycles before it was opened.
    before: u64,
    asked: f64,
    applied: f64,
    saturated: bool,
    fault: bool,
}

/// Time between two openings, in which the shaft comes to rest \[s\].
const BETWEEN: f64 = 1.0;

impl Machine {
    /// The machine as a rig of its own, cold and at zero, with the mistakes in its wiring; limits and
    /// calibration are whoever's drives it.
    ///
    /// # Errors
    /// [`MachineError`] says what cannot be.
    pub fn rig(self) -> Result<Box<dyn Rig + Send>, MachineError> {
        let (wiring, range) = (self.wiring()?, self.voltage_range);
        let simulated = Arc::new(Mutex::new(Simulated::new(self)?));
        let rig: Box<dyn Rig + Send> = Box::new(MachineRig::open(simulated, false, range));
        Ok(match wiring {
            Some(wiring) => Box::new(Miswired::new(rig, wiring)),
            None => rig,
        })
    }
}

impl MachineRig {
    pub(crate) fn open(simulated: Arc<Mutex<Simulated>>, again: bool, voltage_limit: f64) -> Self {
        let mut there = locked(&simulated);
        let period = there.machine.period;
        if again {
            (0..(BETWEEN / period) as u32).for_each(|_| there.advance(0.0));
        }
        let before = there.cycle;
        let voltage_range = there.machine.voltage_range;
        let voltage_resolution = there.machine.sensors.voltage_resolution;
        drop(there);
        Self {
            simulated,
            period,
            voltage_range,
            voltage_limit,
            voltage_resolution,
            before,
            asked: 0.0,
            applied: 0.0,
            saturated: false,
            fault: false,
        }
    }
}

impl Rig for MachineRig {
    fn period(&self) -> f64 {
        self.period
    }

    fn voltage_range(&self) -> f64 {
        self.voltage_range
    }

    fn measure(&mut self) -> Measurement {
        let mut simulated = locked(&self.simulated);
        let cycle = simulated.cycle - self.before;
        Measurement {
            cycle,
            time: cycle as f64 * self.period,
            voltage_asked: self.asked,
            voltage_applied: self.applied,
            saturated: self.saturated,
            fault: self.fault,
            ..simulated.measure()
        }
    }

    fn truth(&self) -> Option<Truth> {
        Some(locked(&self.simulated).truth())
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        let mut simulated = locked(&self.simulated);
        if simulated.is_broken(Break::Unplugged) {
            self.fault = true;
            simulated.advance(0.0);
            return Err(RigError::LineGone);
        }
        let refused =
            if volts.is_finite() { None } else { Some(RigError::VoltageNotFinite(volts)) };
        self.fault |= refused.is_some();
        self.asked = if refused.is_some() { 0.0 } else { volts };
        let cut = self.asked.clamp(-self.voltage_limit, self.voltage_limit);
        self.saturated = cut != self.asked;
        let step = self.voltage_resolution;
        let rounded = if step > 0.0 { (cut / step).round() * step } else { cut };
        self.applied = if self.fault { 0.0 } else { rounded };
        simulated.advance(self.applied);
        let truth = simulated.truth();
        if !(truth.position.is_finite() && truth.velocity.is_finite()) {
            self.fault = true;
            return Err(RigError::Description(
                "the machine is too stiff for its simulation, which left the finite numbers: more `substeps`, a shorter `period` or a softer contact help".to_owned(),
            ));
        }
        refused.map_or(Ok(()), Err)
    }
}
