//! A real rig that the runs of an experiment take in turns.
//!
//! Between two turns a keeper goes on reading it at zero volts, so that no watchdog expires and a
//! fault is noticed when it happens.

mod home;
mod paced;
mod reconnect;
mod turn;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use rig_driver::safety::{MotorThermal, SafetyLimits};
use rig_driver::{Rig, RigError};

use self::home::Home;
use self::paced::Paced;
use self::turn::Turn;
use super::{Opened, RigDescription, RigSetupError, SensorsPresent};

/// Time for the shaft to come to rest before each turn \[s\].
pub const REST: f64 = 1.0;

/// Opens the rig once more, as it was opened.
pub type Reopen = Box<dyn Fn() -> Result<Opened, RigSetupError> + Send + Sync>;

/// A rig that is lent out, one turn at a time. Dropped, it leaves zero volts.
#[derive(Debug)]
pub struct BenchRig {
    home: Arc<Home>,
    keeper: Mutex<Option<JoinHandle<()>>>,
    reopen: Option<Again>,
    /// The voltage limit holds whatever the device says of itself later.
    limits: SafetyLimits,
    description: Option<RigDescription>,
    period: f64,
    voltage_limit: f64,
    voltage_range: f64,
    sensors: SensorsPresent,
}

/// How the rig is opened once more.
struct Again(Reopen);

impl std::fmt::Debug for Again {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Again")
    }
}

impl BenchRig {
    /// Takes the rig over, inactive. Once `stop` is set every turn ends with [`RigError::Stopped`].
    ///
    /// # Errors
    /// [`RigError`] if the limits cannot be or the rig refuses.
    pub fn new(opened: Opened, stop: Arc<AtomicBool>) -> Result<Self, RigError> {
        Self::opened(opened, stop, None)
    }

    /// The same, for a rig that `reopen` opens once more where its line fails.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub fn reopening(
        opened: Opened,
        stop: Arc<AtomicBool>,
        reopen: Reopen,
    ) -> Result<Self, RigError> {
        Self::opened(opened, stop, Some(Again(reopen)))
    }

    fn opened(
        opened: Opened,
        stop: Arc<AtomicBool>,
        reopen: Option<Again>,
    ) -> Result<Self, RigError> {
        let Opened { rig, limits, pace, sensors, description, .. } = opened;
        let paced = Paced::configured(rig, limits, pace, None)?;
        let (period, voltage_range) = (paced.rig.period(), paced.rig.voltage_range());
        let home = Arc::new(Home::new(paced, stop));
        let keeper = Mutex::new(Home::kept(&home, pace));
        Ok(Self {
            home,
            keeper,
            reopen,
            limits,
            description,
            period,
            voltage_limit: limits.voltage,
            voltage_range,
            sensors,
        })
    }

    /// Period of the cycle \[s\].
    #[must_use]
    pub const fn period(&self) -> f64 {
        self.period
    }

    /// What the rig can put out \[V\].
    #[must_use]
    pub const fn voltage_range(&self) -> f64 {
        self.voltage_range
    }

    /// What the safety layer allows \[V\].
    #[must_use]
    pub const fn voltage_limit(&self) -> f64 {
        self.voltage_limit
    }

    /// Which sensors there are.
    #[must_use]
    pub const fn sensors(&self) -> SensorsPresent {
        self.sensors
    }

    /// Whether it can be opened anew.
    #[must_use]
    pub const fn reopens(&self) -> bool {
        self.reopen.is_some()
    }

    /// The winding, where the safety layer watches it.
    #[must_use]
    pub const fn winding(&self) -> Option<MotorThermal> {
        self.limits.motor
    }

    /// How far the winding is above ambient \[K\]; none while the rig is lent, or where nothing
    /// watches it.
    #[must_use]
    pub fn winding_rise(&self) -> Option<f64> {
        locked(&self.home.rig).as_ref().and_then(|paced| paced.rig.winding_rise())
    }

    /// Says how far the winding is above ambient \[K\], where that is known from before.
    pub fn warm(&self, rise: f64) {
        if let Some(paced) = locked(&self.home.rig).as_mut() {
            paced.rig.warm(rise);
        }
    }

    /// Where the shaft was by the rig's own count when the present turn, or the last one, began
    /// \[rad\]; none before the first. Readings of a turn are counted from there.
    #[must_use]
    pub fn origin(&self) -> Option<f64> {
        self.home.origin()
    }

    /// Where the shaft was by the rig's own count in the last cycle of a turn \[rad\]; none before
    /// the first.
    #[must_use]
    pub fn place(&self) -> Option<f64> {
        self.home.place()
    }

    /// The rig for one run: at rest, active, its time and position counted from here.
    ///
    /// # Errors
    /// [`RigError`] if it has failed meanwhile, may not move, or somebody has it already.
    pub fn lend(&self) -> Result<Box<dyn Rig + Send>, RigError> {
        if let Some(error) = locked(&self.home.failed).clone() {
            return Err(error);
        }
        let Some(paced) = locked(&self.home.rig).take() else { return Err(RigError::Lent) };
        Ok(Box::new(Turn::begun(paced, Arc::clone(&self.home))?))
    }
}

impl Drop for BenchRig {
    fn drop(&mut self) {
        self.home.over.store(true, Ordering::Relaxed);
        if let Some(keeper) = locked(&self.keeper).take() {
            // A keeper that panicked has dropped the rig already.
            let _ = keeper.join();
        }
    }
}

/// What a lock protects here is whole even if somebody panicked beside it.
fn locked<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests;
