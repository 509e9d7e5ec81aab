//! The loop itself: the rig measures, the observer estimates, the controller decides, the rig
//! applies.
//!
//! One step is a function of state and input: no clock, no files, no allocation. Whoever calls it
//! decides whether time is the processor's (offline, in lock-step) or the wall's (live).

use controller::{Command, ControlMode, Controller, Feedback};
use friction_observer::{FrictionEstimator, Seen};
use rig_driver::{Measurement, Rig, RigError};

use crate::cycle::CycleSample;
use crate::profile::Excitation;
use crate::waveform::Waveform;

/// Time of cycle 0 of every offline run: 2017-11-01T00:00:00Z, the month of the thesis. Fixed, so
/// that bags are reproducible.
pub const EPOCH_NS: u64 = 1_509_494_400_000_000_000;

/// A loop that runs: here, or elsewhere and followed from here.
pub trait RunningLoop: Send {
    /// Period of the cycle \[s\].
    fn period(&self) -> f64;

    /// Stamp of cycle 0 [ns since the Unix epoch].
    fn start_ns(&self) -> u64;

    /// One cycle.
    ///
    /// # Errors
    /// [`RigError`] if the rig refuses or is lost; the motor is at zero volts then.
    fn step(&mut self) -> Result<CycleSample, RigError>;

    /// Leaves the motor at zero volts.
    ///
    /// # Errors
    /// [`RigError`] if the rig refuses.
    fn stop(&mut self) -> Result<(), RigError>;
}

impl<L: RunningLoop + ?Sized> RunningLoop for Box<L> {
    fn period(&self) -> f64 {
        (**self).period()
    }

    fn start_ns(&self) -> u64 {
        (**self).start_ns()
    }

    fn step(&mut self) -> Result<CycleSample, RigError> {
        (**self).step()
    }

    fn stop(&mut self) -> Result<(), RigError> {
        (**self).stop()
    }
}

impl RunningLoop for ControlLoop {
    fn period(&self) -> f64 {
        self.period()
    }

    fn start_ns(&self) -> u64 {
        self.start_ns()
    }

    fn step(&mut self) -> Result<CycleSample, RigError> {
        self.step()
    }

    fn stop(&mut self) -> Result<(), RigError> {
        self.stop()
    }
}

/// Rig, estimator and controller with a reference.
pub struct ControlLoop {
    rig: Box<dyn Rig + Send>,
    estimator: FrictionEstimator,
    controller: Controller,
    reference: Waveform,
    excitation: Option<Excitation>,
    start_ns: u64,
}

impl ControlLoop {
    /// A loop whose cycle 0 is stamped `start_ns` [ns since the Unix epoch].
    #[must_use]
    pub fn new(
        rig: Box<dyn Rig + Send>,
        estimator: FrictionEstimator,
        controller: Controller,
        reference: Waveform,
        start_ns: u64,
    ) -> Self {
        Self { rig, estimator, controller, reference, excitation: None, start_ns }
    }

    /// The same loop driven by `excitation` in place of its reference.
    #[must_use]
    pub fn excited(self, excitation: Excitation) -> Self {
        Self { excitation: Some(excitation), ..self }
    }

    /// The same loop around the same rig, reached through what `wrap` makes of it.
    #[must_use]
    pub fn through(self, wrap: impl FnOnce(Box<dyn Rig + Send>) -> Box<dyn Rig + Send>) -> Self {
        Self { rig: wrap(self.rig), ..self }
    }

    /// Tells the time on the caller's clock at the beginning of a cycle \[s\], so that late cycles
    /// are seen.
    pub fn tell_time(&mut self, now: f64) {
        self.rig.tell_time(now);
    }

    /// Readings and flags without a command, as after a fault.
    pub fn look(&mut self) -> Measurement {
        self.rig.measure()
    }

    /// Stamp of cycle 0 [ns since the Unix epoch].
    #[must_use]
    pub const fn start_ns(&self) -> u64 {
        self.start_ns
    }

    /// Period of the cycle \[s\].
    #[must_use]
    pub fn period(&self) -> f64 {
        self.rig.period()
    }

    /// Whether the rig sets the pace: [`wait`](Self::wait) returns when its next cycle has begun.
    #[must_use]
    pub fn keeps_time(&self) -> bool {
        self.rig.keeps_time()
    }

    /// Waits for the rig's next cycle; a rig in lock-step with its caller does not wait.
    ///
    /// # Errors
    /// [`RigError`] if the cycle does not come.
    pub fn wait(&mut self) -> Result<(), RigError> {
        self.rig.wait()
    }

    /// Lets the motor move.
    ///
    /// # Errors
    /// [`RigError`] if the rig does not.
    pub fn activate(&mut self) -> Result<(), RigError> {
        self.rig.activate()
    }

    /// One cycle. The controller's velocity is the tachometer's unless the estimator's options say
    /// otherwise, the position the encoder's.
    ///
    /// # Errors
    /// [`RigError`] if the rig refuses the voltage; it is at zero volts then.
    #[inline]
    pub fn step(&mut self) -> Result<CycleSample, RigError> {
        let measurement = self.rig.measure();
        let truth = self.rig.truth();
        let (reference, open_loop) = match &self.excitation {
            None => (self.reference.at(measurement.time), None),
            Some(excitation) => {
                let options = self.controller.options();
                let volts_per_newton_metre = options.compensation.volts_per_newton_metre;
                let open_loop = excitation.open_loop(measurement.time, volts_per_newton_metre);
                (excitation.reference(measurement.time), open_loop)
            }
        };
        let velocity = measurement.tachometer_velocity;
        let error = match self.controller.options().mode {
            ControlMode::Velocity => velocity - reference.velocity,
            ControlMode::Position => measurement.encoder_position - reference.position,
        };
        let estimate = self.estimator.estimate(&Seen {
            velocity,
            position: measurement.encoder_position,
            reference_velocity: reference.velocity,
            error,
            voltage: measurement.voltage_applied,
            torque: Some(measurement.torque),
        });
        let believed = self.estimator.velocity();
        let fed = self.estimator.options().feeds_controller && believed.is_finite();
        let feedback = Feedback {
            position: measurement.encoder_position,
            velocity: if fed { believed } else { velocity },
            friction: estimate.torque,
            cycle: Some(measurement.cycle),
        };
        let command = match open_loop {
            None => self.controller.step(&reference, &feedback),
            Some(volts) => {
                let limit = self.controller.options().voltage_limit;
                let total = volts.min(limit).max(-limit);
                Command { total, saturated: total != volts, ..Command::default() }
            }
        };
        self.rig.apply(command.total)?;
        let stamp_ns = self.start_ns + (measurement.time * 1e9).round() as u64;
        Ok(CycleSample { stamp_ns, measurement, reference, estimate, command, truth })
    }

    /// The estimator, for what an adaptation has come to.
    #[must_use]
    pub const fn estimator(&self) -> &FrictionEstimator {
        &self.estimator
    }

    /// Leaves the motor at zero volts.
    ///
    /// # Errors
    /// [`RigError`] if the rig refuses.
    pub fn stop(&mut self) -> Result<(), RigError> {
        self.rig.halt()
    }
}
