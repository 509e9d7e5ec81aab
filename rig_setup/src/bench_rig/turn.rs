//! One run's hold of the rig.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use rig_driver::safety::Request;
use rig_driver::{Measurement, Rig, RigError};

use super::home::Home;
use super::paced::Paced;
use super::{REST, locked};

/// One run's hold of the rig.
pub(super) struct Turn {
    /// `None` only while it is being given back.
    paced: Option<Paced>,
    home: Arc<Home>,
    /// The reading that the run's own begin from.
    origin: Option<Measurement>,
    last: Measurement,
    failed: Option<RigError>,
}

impl Turn {
    /// A turn that begins: the shaft has come to rest and the rig is active.
    pub(super) fn begun(paced: Paced, home: Arc<Home>) -> Result<Self, RigError> {
        let last = Measurement::default();
        let mut turn = Self { paced: Some(paced), home, origin: None, last, failed: None };
        turn.begin()?;
        Ok(turn)
    }

    fn begin(&mut self) -> Result<(), RigError> {
        let Some(paced) = &mut self.paced else { return Err(RigError::Lent) };
        for _ in 0..(REST / paced.rig.period()).round() as u64 {
            if self.home.stop.load(Ordering::Relaxed) {
                return Err(RigError::Stopped);
            }
            let seen = paced.cycle()?;
            self.home.begins_at(seen.encoder_position);
            paced.rig.apply(0.0)?;
        }
        // What stopped it says more than that it cannot be activated.
        match paced.rig.request(Request::Activate) {
            Ok(_) => Ok(()),
            Err(refused) => {
                let latched = || paced.rig.latched_fault().map(RigError::Safety);
                Err(paced.rig.held_by().or_else(latched).unwrap_or(refused))
            }
        }
    }

    /// A reading counted from the turn's first.
    fn relative(&mut self, seen: Measurement) -> Measurement {
        let origin = *self.origin.get_or_insert_with(|| {
            self.home.begins_at(seen.encoder_position);
            seen
        });
        self.home.is_at(seen.encoder_position);
        Measurement {
            cycle: seen.cycle - origin.cycle.min(seen.cycle),
            time: seen.time - origin.time,
            encoder_counts: seen.encoder_counts - origin.encoder_counts,
            encoder_position: seen.encoder_position - origin.encoder_position,
            potentiometer_position: seen.potentiometer_position - origin.potentiometer_position,
            ..seen
        }
    }
}

impl Rig for Turn {
    fn period(&self) -> f64 {
        self.paced.as_ref().map_or(f64::NAN, |paced| paced.rig.period())
    }

    fn voltage_range(&self) -> f64 {
        self.paced.as_ref().map_or(0.0, |paced| paced.rig.voltage_range())
    }

    /// Waits for the next cycle: whoever drives an experiment need not know that time is real. If
    /// no cycle comes the reading is the last one, marked as a fault, and [`apply`](Rig::apply)
    /// says why.
    fn measure(&mut self) -> Measurement {
        let seen = match self.paced.as_mut().map(Paced::cycle) {
            Some(Ok(seen)) => seen,
            Some(Err(error)) => {
                self.failed.get_or_insert(error);
                return Measurement { fault: true, ..self.last };
            }
            None => return Measurement { fault: true, ..self.last },
        };
        self.last = self.relative(seen);
        self.last
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        let Some(paced) = &mut self.paced else { return Err(RigError::Lent) };
        if let Some(error) = &self.failed {
            return Err(error.clone());
        }
        if self.home.stop.load(Ordering::Relaxed) {
            paced.rig.halt()?;
            return Err(RigError::Stopped);
        }
        paced.rig.apply(volts)
    }

    fn halt(&mut self) -> Result<(), RigError> {
        self.paced.as_mut().map_or(Err(RigError::Lent), |paced| paced.rig.halt())
    }

    fn winding_rise(&self) -> Option<f64> {
        self.paced.as_ref().and_then(|paced| paced.rig.winding_rise())
    }

    fn truth(&self) -> Option<rig_driver::Truth> {
        self.paced.as_ref().and_then(|paced| paced.rig.truth())
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        let Some(mut paced) = self.paced.take() else { return };
        // Out of active, by whatever way the run ended. Where a fault took it out already the
        // request is refused, and the motor is at zero volts.
        let deactivated = paced.rig.request(Request::Deactivate).map(drop);
        let failed = self.failed.take().or(match deactivated {
            Err(RigError::Refused(_)) => None,
            other => other.err(),
        });
        if let Some(error) = failed {
            locked(&self.home.failed).get_or_insert(error);
        }
        *locked(&self.home.rig) = Some(paced);
    }
}
