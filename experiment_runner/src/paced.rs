//! A rig in lock-step, driven at the pace of the clock.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use rig_driver::{Measurement, Rig, RigError};

/// A loop that is further behind than this does not catch up any more.
const HOPELESS: Duration = Duration::from_millis(100);

/// Waits for each cycle's turn on the clock, and stops the motor in the cycle after it is told to.
///
/// The pace is good enough to look on: a rig that needs better keeps its own time.
pub struct Paced {
    rig: Box<dyn Rig + Send>,
    stop: Arc<AtomicBool>,
    next: Option<Instant>,
}

impl Paced {
    /// Drives `rig` at the pace of the clock until `stop` is set.
    #[must_use]
    pub fn new(rig: Box<dyn Rig + Send>, stop: Arc<AtomicBool>) -> Self {
        Self { rig, stop, next: None }
    }
}

impl Rig for Paced {
    fn beneath(&self) -> Option<&dyn Rig> {
        Some(&self.rig)
    }

    fn beneath_mut(&mut self) -> Option<&mut dyn Rig> {
        Some(&mut self.rig)
    }

    fn period(&self) -> f64 {
        self.rig.period()
    }

    fn measure(&mut self) -> Measurement {
        let now = Instant::now();
        let due =
            self.next.filter(|due| now.saturating_duration_since(*due) < HOPELESS).unwrap_or(now);
        thread::sleep(due.saturating_duration_since(now));
        self.next = Some(due + Duration::from_secs_f64(self.rig.period()));
        self.rig.measure()
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        if self.stop.load(Ordering::Relaxed) {
            self.rig.halt()?;
            return Err(RigError::Stopped);
        }
        self.rig.apply(volts)
    }
}

#[cfg(test)]
mod tests {
    use friction_model::{AnyModel, ModelName};
    use rig_driver::SimulationOptions;

    use super::*;

    fn paced() -> (Paced, Arc<AtomicBool>) {
        let rig =
            SimulationOptions::default().build(AnyModel::test_bed(ModelName::Proposed)).unwrap();
        let stop: Arc<AtomicBool> = Arc::default();
        (Paced::new(rig, Arc::clone(&stop)), stop)
    }

    #[test]
    fn a_cycle_never_begins_before_its_turn() {
        let (mut rig, _) = paced();
        let begun = Instant::now();
        for _ in 0..50 {
            rig.measure();
            rig.apply(1.0).unwrap();
        }
        // The first cycle is due at once, the fiftieth 49 periods later.
        assert!(begun.elapsed().as_secs_f64() >= 49.0 * rig.period());
    }

    #[test]
    fn the_cycle_after_a_stop_is_at_zero_volts_and_the_last() {
        let (mut rig, stop) = paced();
        rig.measure();
        rig.apply(3.0).unwrap();
        // The converter has steps of 5 mV.
        assert!((rig.measure().voltage_applied - 3.0).abs() < 0.005);
        stop.store(true, Ordering::Relaxed);
        assert_eq!(rig.apply(3.0), Err(RigError::Stopped));
        assert_eq!(rig.measure().voltage_applied, 0.0);
    }
}
