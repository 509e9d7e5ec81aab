//! Where the rig is between two turns, and the keeper that reads it there.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use rig_driver::{Rig, RigError};

use super::locked;
use super::paced::Paced;
use crate::Pace;

/// The keeper leaves the rig alone for so long after each cycle: whoever wants it gets it then.
const ASIDE: Duration = Duration::from_micros(200);

/// Where the rig is between two turns.
#[derive(Debug)]
pub(super) struct Home {
    pub(super) rig: Mutex<Option<Paced>>,
    /// What went wrong between two turns.
    pub(super) failed: Mutex<Option<RigError>>,
    pub(super) stop: Arc<AtomicBool>,
    pub(super) over: AtomicBool,
    /// Where the shaft was by the rig's own count when the present turn began, and in its last
    /// cycle, as bits; what is no number is not known.
    origin: AtomicU64,
    place: AtomicU64,
}

impl Home {
    /// A rig between two turns.
    pub(super) fn new(paced: Paced, stop: Arc<AtomicBool>) -> Self {
        let unknown = || AtomicU64::new(f64::NAN.to_bits());
        Self {
            rig: Mutex::new(Some(paced)),
            failed: Mutex::new(None),
            stop,
            over: AtomicBool::new(false),
            origin: unknown(),
            place: unknown(),
        }
    }

    /// A turn begins where the shaft is.
    pub(super) fn begins_at(&self, position: f64) {
        self.origin.store(position.to_bits(), Ordering::Relaxed);
        self.is_at(position);
    }

    /// The shaft is there.
    pub(super) fn is_at(&self, position: f64) {
        self.place.store(position.to_bits(), Ordering::Relaxed);
    }

    /// Where the present turn began \[rad\].
    pub(super) fn origin(&self) -> Option<f64> {
        Some(f64::from_bits(self.origin.load(Ordering::Relaxed))).filter(|x| x.is_finite())
    }

    /// Where the shaft was seen last \[rad\].
    pub(super) fn place(&self) -> Option<f64> {
        Some(f64::from_bits(self.place.load(Ordering::Relaxed))).filter(|x| x.is_finite())
    }

    /// A thread that reads the rig between two turns; none in lock-step, where nothing happens
    /// then.
    pub(super) fn kept(home: &Arc<Self>, pace: Pace) -> Option<JoinHandle<()>> {
        let home = Arc::clone(home);
        (pace != Pace::LockStep).then(|| thread::spawn(move || home.keep()))
    }

    /// Reads the rig at zero volts while nobody has it.
    fn keep(&self) {
        while !self.over.load(Ordering::Relaxed) {
            let mut there = locked(&self.rig);
            if let Some(paced) = there.as_mut() {
                let failed = match paced.cycle() {
                    // Zero volts once more: it keeps the line to a device alive.
                    Ok(_) => paced.rig.apply(0.0).err(),
                    Err(error) => Some(error),
                };
                if let Some(error) = failed {
                    locked(&self.failed).get_or_insert(error);
                    return;
                }
            }
            drop(there);
            thread::sleep(ASIDE);
        }
    }
}
