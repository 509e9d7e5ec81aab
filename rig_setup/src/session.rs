//! A rig that is driven step by step by a person, under the safety layer.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant, SystemTime};

use rig_driver::safety::{SafetyLimits, Supervised};
use rig_driver::{Measurement, Rig, RigError};

use super::{Heat, Opened, Pace, RigSetupError};

/// The rig, active and paced. Dropped, it leaves zero volts.
pub struct Session<'a> {
    rig: Supervised<Box<dyn Rig + Send>>,
    pace: Pace,
    stop: &'a AtomicBool,
    started: Instant,
    cycles: u32,
    max_volts: f64,
    on_cycle: Box<dyn FnMut(&Measurement) + 'a>,
    heat: Option<Heat>,
    heard: SystemTime,
}

impl<'a> Session<'a> {
    /// Activates the rig. No voltage of the session will be above `max_volts` \[V\]; once `stop` is
    /// set every step refuses.
    ///
    /// Encoder and tachometer are not held against each other: their signs may still be wrong.
    ///
    /// # Errors
    /// [`RigSetupError`] if a limit cannot be or the rig refuses.
    pub fn new(
        opened: Opened,
        max_volts: f64,
        stop: &'a AtomicBool,
    ) -> Result<Self, RigSetupError> {
        let Opened { rig, limits, pace, .. } = opened;
        if !(max_volts > 0.0 && max_volts <= limits.voltage) {
            return Err(RigSetupError::Rig(RigError::OutOfRange {
                name: "max_volts",
                value: max_volts,
                expected: "above 0 and at most the rig's voltage limit".into(),
            }));
        }
        // A plug that is out shows the same value for ever; the steps say that better than a fault
        // does.
        let mut limits = SafetyLimits { voltage: max_volts, ..limits }.before_calibration();
        limits.sensors.frozen_cycles = None;
        let heat = limits.motor.map(Heat);
        let rig = Supervised::activated(rig, limits)?;
        Ok(Self {
            rig,
            pace,
            stop,
            started: Instant::now(),
            cycles: 0,
            max_volts,
            on_cycle: Box::new(|_| {}),
            heat,
            heard: SystemTime::now(),
        })
    }

    /// Shows every cycle to `on_cycle`, in real time whatever the rig.
    #[must_use]
    pub fn shown(self, on_cycle: impl FnMut(&Measurement) + 'a) -> Self {
        let pace = if self.pace == Pace::LockStep { Pace::Clock } else { self.pace };
        Self { on_cycle: Box::new(on_cycle), pace, ..self }
    }

    /// Highest voltage of the session \[V\].
    #[must_use]
    pub const fn max_volts(&self) -> f64 {
        self.max_volts
    }

    /// Period of the cycle \[s\].
    #[must_use]
    pub fn period(&self) -> f64 {
        self.rig.period()
    }

    /// Says how far the winding is above ambient \[K\], where that is known from before.
    pub fn warm(&mut self, rise: f64) {
        self.rig.warm(rise);
    }

    /// How far it is above ambient \[K\]; none where nothing watches it.
    #[must_use]
    pub fn winding_rise(&self) -> Option<f64> {
        self.rig.winding_rise()
    }

    /// What it bears.
    #[must_use]
    pub const fn heat(&self) -> Option<Heat> {
        self.heat
    }

    /// When the rig was heard last, by a clock that goes on while the machine sleeps.
    #[must_use]
    pub const fn heard(&self) -> SystemTime {
        self.heard
    }

    /// Rests while the winding is warm.
    ///
    /// # Errors
    /// As for [`step`](Self::step).
    pub fn cool(&mut self) -> Result<(), RigSetupError> {
        let Some((heat, rise)) = self.heat.zip(self.winding_rise()) else { return Ok(()) };
        let pause = heat.pause(rise);
        if pause > 0.0 {
            self.hold(0.0, pause)?;
        }
        Ok(())
    }

    /// One cycle: reads, and puts out what `volts` says to the readings.
    ///
    /// # Errors
    /// [`RigSetupError::Stopped`], or what the rig refuses; it is at zero volts then.
    pub fn step(
        &mut self,
        volts: impl FnOnce(&Measurement) -> f64,
    ) -> Result<Measurement, RigSetupError> {
        if self.stop.load(Ordering::Relaxed) {
            self.rig.halt()?;
            return Err(RigSetupError::Stopped);
        }
        match self.pace {
            Pace::LockStep => {}
            Pace::Device => self.rig.wait()?,
            Pace::Clock => {
                self.cycles += 1;
                let due = self.started + Duration::from_secs_f64(self.rig.period()) * self.cycles;
                thread::sleep(due.saturating_duration_since(Instant::now()));
                self.rig.tell_time(self.started.elapsed().as_secs_f64());
            }
        }
        self.heard = SystemTime::now();
        let seen = self.rig.measure();
        (self.on_cycle)(&seen);
        self.rig.apply(volts(&seen))?;
        Ok(seen)
    }

    /// Holds `volts` \[V\] for `seconds`. Returns the readings.
    ///
    /// # Errors
    /// As for [`step`](Self::step).
    pub fn hold(&mut self, volts: f64, seconds: f64) -> Result<Vec<Measurement>, RigSetupError> {
        let cycles = (seconds / self.period()).round() as usize;
        (0..cycles).map(|_| self.step(|_| volts)).collect()
    }
}
