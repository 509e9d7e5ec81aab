//! The whole controller: linear part, plant inverse, friction compensation, additions and the
//! voltage limit.

use crate::acceleration_feedback::AccelerationEstimator;
use crate::dither::DitherGenerator;
use crate::error::{non_negative, positive};
use crate::fault::FaultLatch;
use crate::guard::CompensationGuard;
use crate::impulse::Knocker;
use crate::ramp::Ramp;
use crate::velocity_law::VelocityController;
use crate::{
    Command, ControlFault, ControlMode, ControllerError, ControllerOptions, DerivativeOn, Feedback,
    Pid, Reference,
};

/// A controller running at a fixed period.
#[derive(Debug, Clone)]
pub struct Controller {
    options: ControllerOptions,
    velocity: VelocityController,
    pid: Pid,
    acceleration: Option<AccelerationEstimator>,
    dither: Option<DitherGenerator>,
    knocker: Option<Knocker>,
    guard: Option<CompensationGuard>,
    faults: FaultLatch,
    /// Volts of compensation per newton metre of estimated friction, on the way to what the options
    /// say.
    weight: Ramp,
    /// What is left of a jump that the linear law could not take into its state \[V\].
    bump: Ramp,
    /// What the last cycle saw and gave; `None` before the first.
    last: Option<Last>,
}

#[derive(Debug, Clone, Copy)]
struct Last {
    reference: Reference,
    feedback: Feedback,
    /// Limited sum without what alternates by itself, dither and impulses \[V\].
    steady: f64,
}

impl Controller {
    /// A controller at rest.
    ///
    /// # Errors
    /// [`ControllerError::OutOfRange`] names the gain, limit or period.
    pub fn new(options: ControllerOptions) -> Result<Self, ControllerError> {
        positive("voltage_limit", options.voltage_limit)?;
        positive("volts_per_newton_metre", options.compensation.volts_per_newton_metre)?;
        non_negative("fade", options.fade)?;
        non_negative("resting_angle", options.resting_angle)?;
        if !(0.0..=2.0).contains(&options.compensation.scale) {
            return Err(ControllerError::OutOfRange {
                name: "scale",
                value: options.compensation.scale,
                expected: "from 0 to 2 (1 compensates the whole estimate)".into(),
            });
        }
        options.inverse.check()?;
        options.load.check()?;
        let dt = options.period;
        Ok(Self {
            velocity: VelocityController::new(options.velocity, dt)?,
            pid: Pid::new(options.pid, options.derivative_on, options.derivative_filter, dt)?,
            acceleration: options
                .acceleration
                .map(|a| AccelerationEstimator::new(a, dt))
                .transpose()?,
            dither: options.dither.map(|dither| DitherGenerator::new(dither, dt)).transpose()?,
            knocker: options.impulse.map(|impulse| Knocker::new(impulse, dt)).transpose()?,
            guard: options.guard.map(|guard| CompensationGuard::new(guard, dt)).transpose()?,
            faults: FaultLatch::new(options.tolerated_cycles),
            weight: Ramp::at(options.compensation.weight()),
            bump: Ramp::at(0.0),
            last: None,
            options,
        })
    }

    /// The options.
    #[must_use]
    pub const fn options(&self) -> &ControllerOptions {
        &self.options
    }

    /// Changes mode, law, gains, inverse, compensation or additions while running, without a jump
    /// of the voltage.
    ///
    /// The linear law starts with the state that gives the voltage of the last cycle once more for
    /// the same reference and measurement: for a PI or PID with integral gain that is its integral,
    /// for a lag its state, which it leaves again with its time constant `T_i / gamma`. A PID
    /// without integral gain has no such state; what it lacks is added and faded to zero within
    /// `fade`. The weight of the friction compensation moves from the old to the new in equal steps
    /// within `fade`. Dither and impulses alternate by themselves and are left out of this; they
    /// start anew if they change. A lower voltage limit cuts at once. A latched fault stays.
    ///
    /// # Errors
    /// [`ControllerError::OutOfRange`] for options that cannot be, or another period; the
    /// controller then goes on as it was.
    pub fn change(&mut self, options: ControllerOptions) -> Result<(), ControllerError> {
        if options.period != self.options.period {
            return Err(ControllerError::OutOfRange {
                name: "period",
                value: options.period,
                expected: "what it was when the controller was built: the period cannot change while it runs".into(),
            });
        }
        let before = &self.options;
        let mut next = Self::new(options)?;
        let cycles = options.fade_cycles();
        next.weight = Ramp::new(self.weight.value(), options.compensation.weight(), cycles);
        next.faults = self.faults.clone();
        next.faults.tolerate(options.tolerated_cycles);
        if before.dither == options.dither {
            next.dither.clone_from(&self.dither);
        }
        if before.impulse == options.impulse {
            next.knocker.clone_from(&self.knocker);
        }
        if before.guard == options.guard && before.compensation == options.compensation {
            next.guard.clone_from(&self.guard);
        }
        if let (Some(new), Some(old)) = (&mut next.acceleration, &self.acceleration) {
            new.take_over(old);
        }
        if let Some(last) = self.last {
            next.start_from(last, &self.pid, before, cycles);
        }
        *self = next;
        Ok(())
    }

    /// The friction estimate is lost, or comes back: from the next cycle on it is `friction`
    /// \[N m\], zero for none.
    ///
    /// The voltage does not jump. The linear law starts with the state that gives the last cycle's
    /// voltage once more, as in [`change`](Self::change): it takes up what the compensation no
    /// longer gives, and sheds what the compensation gives again.
    pub fn replace_estimate(&mut self, friction: f64) {
        let Some(mut last) = self.last.filter(|_| self.weight.value() != 0.0) else { return };
        last.feedback.friction = friction;
        let (before, pid) = (self.options, self.pid.clone());
        let cycles = before.fade_cycles();
        self.bump = Ramp::at(0.0);
        self.start_from(last, &pid, &before, cycles);
    }

    /// Sets the state of the linear law so that the last cycle's voltage comes out once more.
    fn start_from(&mut self, last: Last, pid: &Pid, before: &ControllerOptions, cycles: u32) {
        let Last { reference, feedback, steady } = last;
        let limit = self.options.voltage_limit;
        let wanted = steady.clamp(-limit, limit)
            - self.fed_forward(&reference)
            - self.compensation(&feedback)
            - self.acceleration.as_ref().map_or(0.0, |a| a.output(feedback.velocity));
        let (error, seen) = self.error(&reference, &feedback);
        let given = match self.options.mode {
            ControlMode::Velocity => {
                self.velocity.preload(wanted, error);
                self.velocity.output(error)
            }
            ControlMode::Position => {
                let rate = match self.options.derivative_on {
                    on if before.mode == ControlMode::Position && on == before.derivative_on => {
                        pid.derivative()
                    }
                    DerivativeOn::Error => reference.velocity - feedback.velocity,
                    DerivativeOn::Measurement => -feedback.velocity,
                };
                self.pid.preload(wanted, error, seen, rate);
                let crate::PidGains { k_p, k_i, k_d } = self.options.pid;
                if k_i > 0.0 { wanted } else { k_p * error + k_d * rate }
            }
        };
        let left = wanted - given;
        // A rounding is no jump.
        if left.abs() > 1e-9 * limit {
            self.bump = Ramp::new(left, 0.0, cycles);
        }
        self.last = Some(last);
    }

    #[inline]
    fn error(&self, reference: &Reference, feedback: &Feedback) -> (f64, f64) {
        let (target, seen) = match self.options.mode {
            ControlMode::Velocity => (reference.velocity, feedback.velocity),
            ControlMode::Position => (reference.position, feedback.position),
        };
        (target - seen, seen)
    }

    /// What the reference asks for by itself, of the drive and of its load \[V\].
    #[inline]
    fn fed_forward(&self, reference: &Reference) -> f64 {
        let Self { options, .. } = self;
        options.inverse.volts(reference) + options.load.volts(options.mode, reference)
    }

    /// Compensating voltage \[V\].
    #[inline]
    fn compensation(&self, feedback: &Feedback) -> f64 {
        let weight = self.weight.value();
        // What is not compensated need not be a number.
        if weight == 0.0 {
            return 0.0;
        }
        weight * feedback.friction * self.guard.as_ref().map_or(1.0, CompensationGuard::scale)
    }

    /// Voltage for this cycle, in its parts.
    ///
    /// If anything it is told is not a finite number, or the measurement is the one before once
    /// more, the command is zero volts and the controller's state stays as it was; more than
    /// `tolerated_cycles` of these in a row latch a [`ControlFault`], and the command is zero volts
    /// until [`reset`](Self::reset).
    #[inline]
    pub fn step(&mut self, reference: &Reference, feedback: &Feedback) -> Command {
        let mode = self.options.mode;
        let (error, seen) = self.error(reference, feedback);
        let nothing = Command {
            mode,
            reference: error + seen,
            feedback: seen,
            error,
            fault: self.faults.latched(),
            held_back: 1.0 - self.guard.as_ref().map_or(1.0, CompensationGuard::scale),
            diagnosis: self.guard.as_ref().and_then(CompensationGuard::diagnosis),
            ..Command::default()
        };
        if nothing.fault.is_some() {
            return nothing;
        }
        let law = match mode {
            ControlMode::Velocity => self.velocity.output(error),
            ControlMode::Position => self.pid.output(error, seen),
        };
        let linear = law + self.bump.value();
        let inverse = self.fed_forward(reference);
        let friction = self.compensation(feedback);
        let acceleration = self.acceleration.as_ref().map_or(0.0, |a| a.output(feedback.velocity));
        let dither = self.dither.as_ref().map_or(0.0, DitherGenerator::output);
        let impulse = self.knocker.as_ref().map_or(0.0, |knocker| knocker.output(linear + inverse));
        let sum = linear + inverse + friction + acceleration + dither + impulse;
        let stale = self.faults.is_stale(feedback.cycle);
        if stale || !sum.is_finite() {
            let why = if stale { ControlFault::Stale } else { ControlFault::NotFinite };
            self.faults.missed(feedback.cycle, why);
            return Command { fault: self.faults.latched(), ..nothing };
        }
        self.faults.seen(feedback.cycle);
        let limit = self.options.voltage_limit;
        let total = sum.clamp(-limit, limit);
        let saturated = total != sum;
        let limited = if saturated { sum.signum() } else { 0.0 };
        match mode {
            ControlMode::Velocity => self.velocity.update(error, limited),
            ControlMode::Position => {
                let rests = reference.velocity == 0.0 && error.abs() <= self.options.resting_angle;
                // An integral that must not grow is one whose command is cut on its side.
                let limited = if rests { error.signum() } else { limited };
                self.pid.update(error, seen, limited);
            }
        }
        if let Some(acceleration) = &mut self.acceleration {
            acceleration.update(feedback.velocity);
        }
        if let Some(dither) = &mut self.dither {
            dither.advance();
        }
        if let Some(knocker) = &mut self.knocker {
            knocker.advance(linear + inverse);
        }
        if let Some(guard) = &mut self.guard {
            guard.watch(friction, error, reference.velocity, limited);
        }
        self.weight.advance();
        self.bump.advance();
        let steady = (sum - dither - impulse).clamp(-limit, limit);
        self.last = Some(Last { reference: *reference, feedback: *feedback, steady });
        Command {
            linear,
            inverse,
            friction,
            acceleration,
            dither,
            impulse,
            total,
            saturated,
            ..nothing
        }
    }

    /// Back to rest; a latched fault is forgotten.
    pub fn reset(&mut self) {
        self.velocity.reset();
        self.pid.reset();
        self.acceleration.iter_mut().for_each(AccelerationEstimator::reset);
        self.dither.iter_mut().for_each(DitherGenerator::reset);
        self.knocker.iter_mut().for_each(Knocker::reset);
        self.guard.iter_mut().for_each(CompensationGuard::reset);
        self.faults.reset();
        self.weight.finish();
        self.bump = Ramp::at(0.0);
        self.last = None;
    }
}
