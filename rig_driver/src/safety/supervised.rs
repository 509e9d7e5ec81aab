//! A back end under supervision.

use super::{Fault, FaultReport, Request, SafetyLimits, SafetySupervisor, State};
use crate::{Measurement, Rig, RigError};

/// A rig whose every voltage goes through a [`SafetySupervisor`].
///
/// Its clock is the rig's own ([`Measurement::time`]) until [`tell_time`](Rig::tell_time) was
/// called; then it is the caller's, and cycles that come late are seen. Dropped, by whatever way,
/// it leaves zero volts.
#[derive(Debug, Clone)]
pub struct Supervised<R: Rig> {
    rig: R,
    supervisor: SafetySupervisor,
    told: Option<f64>,
    asked: f64,
    /// The back end was activated, and not told to rest since.
    may_move: bool,
}

impl<R: Rig> Supervised<R> {
    /// The rig in state unconfigured: its motor does not move before it is configured and
    /// activated.
    ///
    /// # Errors
    /// [`RigError::OutOfRange`] names the limit that cannot be; [`RigError::BeyondRange`] says that
    /// the rig cannot put the voltage out.
    pub fn new(rig: R, limits: SafetyLimits) -> Result<Self, RigError> {
        let range = rig.voltage_range();
        if limits.voltage > range {
            return Err(RigError::BeyondRange { limit: limits.voltage, range });
        }
        let supervisor = SafetySupervisor::new(limits, rig.period())?;
        Ok(Self { rig, supervisor, told: None, asked: 0.0, may_move: false })
    }

    /// The rig in state active, as simulated rigs start.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub fn activated(rig: R, limits: SafetyLimits) -> Result<Self, RigError> {
        let mut rig = Self::new(rig, limits)?;
        rig.request(Request::Configure)?;
        rig.request(Request::Activate)?;
        Ok(rig)
    }

    /// The supervisor, to be looked at.
    #[must_use]
    pub const fn supervisor(&self) -> &SafetySupervisor {
        &self.supervisor
    }

    /// Says how far the winding is above ambient \[K\], where that is known from before.
    pub fn warm(&mut self, rise: f64) {
        if let Some(motor) = self.supervisor.limits().motor {
            self.supervisor.warm(motor.ambient + rise);
        }
    }

    #[cfg(test)]
    pub(crate) const fn inner(&self) -> &R {
        &self.rig
    }

    #[cfg(test)]
    pub(crate) const fn inner_mut(&mut self) -> &mut R {
        &mut self.rig
    }

    #[cfg(test)]
    pub(crate) const fn may_move(&self) -> bool {
        self.may_move
    }

    /// Does what is asked for; leaving active puts the motor at zero volts at once and takes the
    /// back end's leave to move away. An emergency stop goes to the back end whatever the state,
    /// each time that it is asked for.
    ///
    /// # Errors
    /// [`RigError::Refused`] or [`RigError::Safety`] as [`SafetySupervisor::request`] has it, or
    /// what the back end says. After an error the supervisor holds zero volts none the less.
    pub fn request(&mut self, request: Request) -> Result<State, RigError> {
        let outcome = self.supervisor.request(request);
        if request == Request::EmergencyStop {
            self.may_move = false;
            self.rig.emergency_stop()?;
        }
        let state = outcome?;
        self.rest()?;
        if request == Request::Activate {
            // Whoever is told to move and answers with an error may move all the same.
            self.may_move = true;
            if let Err(error) = self.rig.activate() {
                self.back_end_fault();
                return Err(error);
            }
        }
        if request == Request::Clear
            && let Err(error) = self.rig.clear()
        {
            self.supervisor.fault(Fault::BackEnd, 0.0, 0.0);
            return Err(error);
        }
        Ok(state)
    }

    /// Latches a fault that somebody else found.
    pub fn fault(&mut self, fault: Fault, value: f64, limit: f64) {
        self.supervisor.fault(fault, value, limit);
        self.settle();
    }

    /// Takes a command of `volts` \[V\] that was made at `stamp` [s on the supervisor's clock], as
    /// it comes over a network: its age counts.
    pub fn command(&mut self, stamp: f64, volts: f64) {
        self.asked = if volts.is_finite() { volts } else { 0.0 };
        self.supervisor.command(stamp, volts);
    }

    /// Drives the motor for the coming period with the newest [`command`](Self::command), as far as
    /// the supervisor allows it. A fault is no error here: the motor is at zero volts, and
    /// [`supervisor`](Self::supervisor) says why.
    ///
    /// # Errors
    /// What the back end says to the voltage.
    pub fn drive(&mut self) -> Result<(), RigError> {
        let allowed = self.supervisor.output();
        if let Err(error) = self.rig.apply(allowed) {
            self.back_end_fault();
            return Err(error);
        }
        self.settle();
        Ok(())
    }

    /// Latches the back end's refusal and has it rest.
    fn back_end_fault(&mut self) {
        self.supervisor.fault(Fault::BackEnd, 0.0, 0.0);
        self.may_move = false;
        // The back end has just refused; that it refuses to rest as well is no other error.
        let _ = self.rig.deactivate();
    }

    /// Has the back end rest, once, where the supervisor does not let the motor move any more: a
    /// fault that latches here deactivates the device too.
    fn rest(&mut self) -> Result<(), RigError> {
        if self.may_move && !self.supervisor.state().moves() {
            self.may_move = false;
            self.rig.deactivate()?;
        }
        Ok(())
    }

    /// The same where nobody asked; what the back end refuses is a fault.
    fn settle(&mut self) {
        if self.rest().is_err() {
            self.supervisor.fault(Fault::BackEnd, 0.0, 0.0);
        }
    }

    /// Where it is the device that holds the motor, its own words say more than that it does.
    fn by_the_device(&self) -> Option<RigError> {
        let of_the_device = |report: &&FaultReport| report.fault == Fault::BackEnd;
        self.supervisor.latched().filter(of_the_device).and_then(|_| self.rig.held_by())
    }

    fn now(&self, seen: &Measurement) -> f64 {
        self.told.unwrap_or(seen.time)
    }
}

impl<R: Rig> Rig for Supervised<R> {
    fn beneath(&self) -> Option<&dyn Rig> {
        Some(&self.rig)
    }

    fn beneath_mut(&mut self) -> Option<&mut dyn Rig> {
        Some(&mut self.rig)
    }

    fn period(&self) -> f64 {
        self.rig.period()
    }

    fn tell_time(&mut self, now: f64) {
        self.told = Some(now);
        self.rig.tell_time(now);
    }

    fn measure(&mut self) -> Measurement {
        let mut seen = self.rig.measure();
        // What the back end found out by itself says more than that it has a fault.
        if let Some(FaultReport { fault, value, limit, .. }) = self.rig.latched_fault() {
            self.supervisor.fault(fault, value, limit);
        }
        self.supervisor.cycle(self.now(&seen), &seen);
        self.settle();
        self.supervisor.mark(&mut seen);
        seen.voltage_asked = self.asked;
        seen
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        self.asked = if volts.is_finite() { volts } else { 0.0 };
        // In lock-step a command is as old as the readings it answers to.
        let now = self.supervisor.now();
        self.supervisor.command(now, volts);
        let allowed = self.supervisor.output();
        if let Err(error) = self.rig.apply(allowed) {
            self.back_end_fault();
            return Err(error);
        }
        self.settle();
        match (self.supervisor.latched(), self.supervisor.state()) {
            (_, State::Active) => Ok(()),
            _ if volts == 0.0 => Ok(()),
            (Some(&report), _) => Err(self.by_the_device().unwrap_or(RigError::Safety(report))),
            (None, state) => Err(RigError::NotActive(state)),
        }
    }

    fn winding_rise(&self) -> Option<f64> {
        self.supervisor.rise()
    }

    fn halt(&mut self) -> Result<(), RigError> {
        self.asked = 0.0;
        self.supervisor.halt();
        self.rig.halt()
    }

    fn deactivate(&mut self) -> Result<(), RigError> {
        if self.supervisor.state().moves() {
            return Self::request(self, Request::Deactivate).map(drop);
        }
        self.halt()
    }

    fn emergency_stop(&mut self) -> Result<(), RigError> {
        self.asked = 0.0;
        Self::request(self, Request::EmergencyStop).map(drop)
    }

    fn request(&mut self, request: Request) -> Result<State, RigError> {
        Self::request(self, request)
    }

    fn latched_fault(&self) -> Option<FaultReport> {
        self.supervisor.latched().copied()
    }
}

impl<R: Rig> Drop for Supervised<R> {
    fn drop(&mut self) {
        // Nobody is left to be told.
        let _ = self.rig.halt();
    }
}
