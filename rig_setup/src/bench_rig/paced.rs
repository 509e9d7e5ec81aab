//! The rig at its pace.

use std::thread;
use std::time::{Duration, Instant, SystemTime};

use rig_driver::safety::{Request, SafetyLimits, Supervised};
use rig_driver::{Measurement, Rig, RigError};

use crate::Pace;

/// The rig, supervised, at its pace.
pub(super) struct Paced {
    pub(super) rig: Supervised<Box<dyn Rig + Send>>,
    pace: Pace,
    started: Instant,
    cycles: u64,
    /// When the rig was heard last, by a clock that goes on while the machine sleeps.
    pub(super) heard: SystemTime,
}

impl std::fmt::Debug for Paced {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Paced")
            .field("pace", &self.pace)
            .field("cycles", &self.cycles)
            .finish_non_exhaustive()
    }
}

impl Paced {
    /// The rig under its limits, inactive; its winding `rise` above ambient \[K\], where that is
    /// known.
    pub(super) fn configured(
        rig: Box<dyn Rig + Send>,
        limits: SafetyLimits,
        pace: Pace,
        rise: Option<f64>,
    ) -> Result<Self, RigError> {
        let mut rig = Supervised::new(rig, limits)?;
        if let Some(rise) = rise {
            rig.warm(rise);
        }
        rig.request(Request::Configure)?;
        Ok(Self { rig, pace, started: Instant::now(), cycles: 0, heard: SystemTime::now() })
    }

    /// Waits for the next cycle and reads it.
    pub(super) fn cycle(&mut self) -> Result<Measurement, RigError> {
        match self.pace {
            Pace::LockStep => {}
            Pace::Device => self.rig.wait()?,
            Pace::Clock => {
                self.cycles += 1;
                let due =
                    self.started + Duration::from_secs_f64(self.rig.period() * self.cycles as f64);
                match due.checked_duration_since(Instant::now()) {
                    Some(left) => thread::sleep(left),
                    // Cycles that were missed are not caught up.
                    None => {
                        self.cycles =
                            (self.started.elapsed().as_secs_f64() / self.rig.period()) as u64
                    }
                }
                self.rig.tell_time(self.started.elapsed().as_secs_f64());
            }
        }
        self.heard = SystemTime::now();
        Ok(self.rig.measure())
    }
}
