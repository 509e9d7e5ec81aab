//! A real rig that the runs of an experiment take in turns.
//!
//! Between two turns a keeper goes on reading it at zero volts, so that no watchdog expires and a
//! fault is noticed when it happens.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant, SystemTime};

use rig_driver::safety::{Request, SafetyLimits, Supervised};
use rig_driver::{Measurement, Rig, RigError};

use super::{NotReopened, Opened, Pace, RigDescription, RigSetupError, SensorsPresent};

/// Time for the shaft to come to rest before each turn [s].
pub const REST: f64 = 1.0;

/// Longest time in which a line that failed may come back [s].
pub const PATIENCE: f64 = 30.0;

/// Pause between two attempts to open it.
const RETRY: Duration = Duration::from_millis(100);

/// Opens the rig once more, as it was opened.
pub type Reopen = Box<dyn Fn() -> Result<Opened, RigSetupError> + Send + Sync>;

/// The keeper leaves the rig alone for so long after each cycle: whoever wants it gets it then.
const ASIDE: Duration = Duration::from_micros(200);

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

/// Where the rig is between two turns.
#[derive(Debug)]
struct Home {
    rig: Mutex<Option<Paced>>,
    /// What went wrong between two turns.
    failed: Mutex<Option<RigError>>,
    stop: Arc<AtomicBool>,
    over: AtomicBool,
}

/// The rig, supervised, at its pace.
struct Paced {
    rig: Supervised<Box<dyn Rig + Send>>,
    pace: Pace,
    started: Instant,
    cycles: u64,
    /// When the rig was heard last, by a clock that goes on while the machine sleeps.
    heard: SystemTime,
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
    /// The rig under its limits, inactive; its winding `rise` above ambient [K], where that is
    /// known.
    fn configured(
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
    fn cycle(&mut self) -> Result<Measurement, RigError> {
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

    /// Time since the rig was heard [s]; 0 where the clock was set back.
    fn silence(heard: SystemTime) -> f64 {
        heard.elapsed().map_or(0.0, |since| since.as_secs_f64())
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
        let home = Arc::new(Home {
            rig: Mutex::new(Some(paced)),
            failed: Mutex::new(None),
            stop,
            over: AtomicBool::new(false),
        });
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

    /// Period of the cycle [s].
    #[must_use]
    pub const fn period(&self) -> f64 {
        self.period
    }

    /// What the rig can put out [V].
    #[must_use]
    pub const fn voltage_range(&self) -> f64 {
        self.voltage_range
    }

    /// What the safety layer allows [V].
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

    /// Opens the rig anew after its line failed, up to [`PATIENCE`] after it was heard last:
    /// inactive, at zero volts, its motor as warm as it was. Nothing of the old session stays; a
    /// fault that is latched in the device is not cleared. The time that it took [s].
    ///
    /// # Errors
    /// [`NotReopened`] says why: it did not come back, another device came back, the travel is limited, or
    /// there is no way to open it.
    pub fn reconnect(&self) -> Result<f64, NotReopened> {
        let not = |why: String| Err(NotReopened(why));
        let Some(Again(reopen)) = &self.reopen else {
            return not("this rig is not opened again".to_owned());
        };
        if self.limits.travel.is_some() {
            return not("its travel is limited, and nobody knows whether its encoder counted on: look where the shaft is, and begin again".to_owned());
        }
        // A keeper that failed has ended; one that waits for the rig ends as it finds none.
        self.home.over.store(true, Ordering::Relaxed);
        if let Some(keeper) = locked(&self.keeper).take() {
            let _ = keeper.join();
        }
        let old = locked(&self.home.rig).take();
        let rise = old.as_ref().and_then(|old| old.rig.supervisor().rise());
        let heard = old.as_ref().map_or(SystemTime::UNIX_EPOCH, |old| old.heard);
        // A program that was stopped, or slept with its machine, must not surprise who stands at
        // the rig by now.
        let too_late = || Paced::silence(heard) > PATIENCE;
        // Zero volts, and the end of the session.
        drop(old);
        let opened = loop {
            if self.home.stop.load(Ordering::Relaxed) {
                return not(RigError::Stopped.to_string());
            }
            match reopen() {
                Ok(opened) => break opened,
                Err(error @ RigSetupError::OtherDevice { .. }) => return not(error.to_string()),
                Err(error) if too_late() => {
                    return not(format!("it did not come back within {PATIENCE} s: {error}"));
                }
                Err(_) => thread::sleep(RETRY),
            }
        };
        if too_late() {
            return not(format!(
                "it was not heard for more than {PATIENCE} s, and nobody knows who is at the rig by now"
            ));
        }
        if let Some(before) = &self.description {
            let difference = opened.description.as_ref().and_then(|now| before.differs_from(now));
            if let Some(what) = difference {
                return not(format!("another device came back: {what}"));
            }
        }
        if opened.rig.period() != self.period {
            return not("another device came back: its cycle is another".to_owned());
        }
        let pace = opened.pace;
        let paced = Paced::configured(opened.rig, self.limits, pace, rise)
            .map_err(|error| NotReopened(error.to_string()))?;
        *locked(&self.home.rig) = Some(paced);
        locked(&self.home.failed).take();
        self.home.over.store(false, Ordering::Relaxed);
        *locked(&self.keeper) = Home::kept(&self.home, pace);
        Ok(Paced::silence(heard))
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
        let mut turn = Turn {
            paced: Some(paced),
            home: Arc::clone(&self.home),
            origin: None,
            last: Measurement::default(),
            failed: None,
        };
        turn.begin()?;
        Ok(Box::new(turn))
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

impl Home {
    /// A thread that reads the rig between two turns; none in lock-step, where nothing happens
    /// then.
    fn kept(home: &Arc<Self>, pace: Pace) -> Option<JoinHandle<()>> {
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

/// What a lock protects here is whole even if somebody panicked beside it.
fn locked<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// One run's hold of the rig.
struct Turn {
    /// `None` only while it is being given back.
    paced: Option<Paced>,
    home: Arc<Home>,
    /// The reading that the run's own begin from.
    origin: Option<Measurement>,
    last: Measurement,
    failed: Option<RigError>,
}

impl Turn {
    fn begin(&mut self) -> Result<(), RigError> {
        let Some(paced) = &mut self.paced else { return Err(RigError::Lent) };
        for _ in 0..(REST / paced.rig.period()).round() as u64 {
            if self.home.stop.load(Ordering::Relaxed) {
                return Err(RigError::Stopped);
            }
            paced.cycle()?;
            paced.rig.apply(0.0)?;
        }
        paced.rig.request(Request::Activate).map(drop)
    }

    /// A reading counted from the turn's first.
    fn relative(&mut self, seen: Measurement) -> Measurement {
        let origin = *self.origin.get_or_insert(seen);
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

#[cfg(test)]
mod tests {
    use friction_model::{AnyModel, ModelName};

    use super::*;
    use crate::{RigChoice, RigSetup};

    fn bench(stop: &Arc<AtomicBool>) -> BenchRig {
        let friction = AnyModel::test_bed(ModelName::LuGre);
        BenchRig::new(
            RigChoice::Simulated.open(&RigSetup { friction, ..RigSetup::default() }).unwrap(),
            Arc::clone(stop),
        )
        .unwrap()
    }

    #[test]
    fn every_turn_begins_at_rest_and_counts_from_its_own_zero() {
        let bench = bench(&Arc::default());
        for _ in 0..3 {
            let mut turn = bench.lend().unwrap();
            let first = turn.measure();
            assert_eq!((first.cycle, first.time, first.encoder_counts), (0, 0.0, 0));
            assert!(first.tachometer_velocity.abs() < 0.1, "{first:?}");
            for _ in 0..500 {
                turn.apply(2.0).unwrap();
                turn.measure();
            }
            let last = turn.measure();
            assert!(last.encoder_position > 0.5 && (last.time - 0.5).abs() < 0.01, "{last:?}");
        }
    }

    #[test]
    fn nobody_takes_it_while_it_is_lent() {
        let bench = bench(&Arc::default());
        let turn = bench.lend().unwrap();
        assert_eq!(bench.lend().err(), Some(RigError::Lent));
        drop(turn);
        assert!(bench.lend().is_ok());
    }

    #[test]
    fn told_to_stop_it_goes_to_zero_volts_at_once_and_moves_no_more() {
        let stop = Arc::new(AtomicBool::new(false));
        let bench = bench(&stop);
        let mut turn = bench.lend().unwrap();
        turn.measure();
        turn.apply(3.0).unwrap();
        stop.store(true, Ordering::Relaxed);
        turn.measure();
        assert_eq!(turn.apply(3.0), Err(RigError::Stopped));
        turn.measure();
        assert_eq!(turn.measure().voltage_applied, 0.0);
        drop(turn);
        assert_eq!(bench.lend().err(), Some(RigError::Stopped));
    }

    #[test]
    fn a_fault_ends_the_turn_and_is_told_to_the_next() {
        let bench = bench(&Arc::default());
        let mut turn = bench.lend().unwrap();
        turn.measure();
        assert!(turn.apply(f64::NAN).is_err());
        drop(turn);
        let refused = bench.lend().err().unwrap().to_string();
        assert!(refused.contains("activate") || refused.contains("fault"), "{refused}");
    }
}
