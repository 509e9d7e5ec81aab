//! The supervisor: readings and commands in, a voltage that can do no harm out.

use super::sensors::SensorMonitor;
use super::standstill::StandstillMonitor;
use super::temperature::Winding;
use super::{Event, Fault, FaultReport, Reaction, Refused, Request, SafetyLimits, State, next};
use crate::{Measurement, RigError};

/// Cycles in a row above the speed limit that count: one reading may be a spark of the brushes.
const OVERSPEED_CYCLES: u32 = 3;

/// Stands between a controller and a motor. Pure: time comes in as numbers \[s\] on one clock that
/// does not run backwards.
///
/// Once a cycle: [`cycle`](Self::cycle) with the readings, [`command`](Self::command) if there is a
/// new one, and [`output`](Self::output), whose voltage goes to the motor. In a loop in lock-step
/// all three carry the same time; where commands come over a network, `command` carries the time at
/// which the command was made, and its age counts.
#[derive(Debug, Clone)]
pub struct SafetySupervisor {
    limits: SafetyLimits,
    period: f64,
    state: State,
    latched: Option<FaultReport>,
    sensors: SensorMonitor,
    winding: Option<Winding>,
    standstill: StandstillMonitor,
    overspeed_cycles: u32,
    /// Time of the cycle before and of this one \[s\].
    now: Option<f64>,
    cycle_late: Option<f64>,
    position: f64,
    command: Option<Command>,
    applied: f64,
    /// What the last output was held back by.
    held_back: Option<FaultReport>,
}

#[derive(Debug, Clone, Copy)]
struct Command {
    stamp: f64,
    volts: f64,
}

impl SafetySupervisor {
    /// A supervisor in state unconfigured for a rig with cycles of `period` \[s\].
    ///
    /// # Errors
    /// [`RigError::OutOfRange`] names the limit that cannot be.
    pub fn new(limits: SafetyLimits, period: f64) -> Result<Self, RigError> {
        limits.check(period)?;
        Ok(Self {
            limits,
            period,
            state: State::Unconfigured,
            latched: None,
            sensors: SensorMonitor::new(limits.sensors, period),
            winding: limits.motor.map(|motor| Winding::new(motor, limits.voltage)),
            standstill: StandstillMonitor::new(limits.standstill),
            overspeed_cycles: 0,
            now: None,
            cycle_late: None,
            position: 0.0,
            command: None,
            applied: 0.0,
            held_back: None,
        })
    }

    /// The state.
    #[must_use]
    pub const fn state(&self) -> State {
        self.state
    }

    /// The limits.
    #[must_use]
    pub const fn limits(&self) -> &SafetyLimits {
        &self.limits
    }

    /// The fault that holds the motor, the first one since the last clearing.
    #[must_use]
    pub const fn latched(&self) -> Option<&FaultReport> {
        self.latched.as_ref()
    }

    /// What held the last output back without latching: a cut, a late command, a late cycle.
    #[must_use]
    pub const fn held_back(&self) -> Option<&FaultReport> {
        self.held_back.as_ref()
    }

    /// The last output \[V\].
    #[must_use]
    pub const fn applied(&self) -> f64 {
        self.applied
    }

    /// Temperature of the winding by its model [degrees C].
    #[must_use]
    pub fn temperature(&self) -> Option<f64> {
        self.winding.map(|winding| winding.temperature())
    }

    /// The winding above ambient by its model \[K\].
    #[must_use]
    pub fn rise(&self) -> Option<f64> {
        Some(self.temperature()? - self.limits.motor?.ambient)
    }

    /// Says how warm the winding is [degrees C], where that is known from before.
    pub fn warm(&mut self, temperature: f64) {
        if let Some(winding) = &mut self.winding {
            winding.set(temperature);
        }
    }

    /// Does what is asked for, if the table of transitions has it.
    ///
    /// # Errors
    /// [`RigError::Refused`] with what the state allows; [`RigError::Safety`] if a fault was to be
    /// cleared whose cause is still there.
    pub fn request(&mut self, request: Request) -> Result<State, RigError> {
        let to = next(self.state, Event::Asked(request))?;
        if request == Request::Clear {
            if let (Some(winding), Some(report)) = (&self.winding, self.latched)
                && report.fault == Fault::MotorHot
                && !winding.has_cooled()
            {
                return Err(RigError::Safety(FaultReport {
                    value: winding.temperature(),
                    ..report
                }));
            }
            self.latched = None;
            self.sensors.restart();
            self.overspeed_cycles = 0;
        }
        self.enter(to);
        Ok(to)
    }

    fn enter(&mut self, state: State) {
        if state == self.state {
            return;
        }
        self.state = state;
        // A command from before never moves the motor after.
        self.command = None;
        if !state.moves() {
            self.applied = 0.0;
        }
    }

    /// Latches a fault that somebody else found: the back end, or the device behind it.
    pub fn fault(&mut self, fault: Fault, value: f64, limit: f64) {
        let report = FaultReport { fault, time: self.now.unwrap_or(0.0), value, limit };
        if let Ok(to) = next(self.state, Event::Fault) {
            self.latched.get_or_insert(report);
            self.enter(to);
        }
    }

    /// Begins the cycle at `now` \[s\] with the readings.
    pub fn cycle(&mut self, now: f64, seen: &Measurement) {
        let gap = self.now.map_or(0.0, |before| now - before);
        if !now.is_finite() || gap < 0.0 || gap > self.limits.cycle_lost {
            self.fault(Fault::CycleLost, gap, self.limits.cycle_lost);
        }
        if now.is_finite() {
            self.now = Some(self.now.map_or(now, |before| before.max(now)));
        }
        self.cycle_late = (gap > self.limits.cycle_late).then_some(gap);
        if self.state == State::Unconfigured || self.state == State::Finalized {
            return;
        }
        let velocity = self.sensors.velocity(seen);
        if let Some(winding) = &mut self.winding
            && gap > 0.0
            && gap.is_finite()
        {
            let velocity = if velocity.is_finite() { velocity } else { 0.0 };
            let current = seen.motor_current.filter(|current| current.is_finite());
            winding.advance(gap, self.applied, velocity, current);
            if winding.is_hot() {
                let (temperature, limit) =
                    (winding.temperature(), self.limits.motor.map_or(0.0, |motor| motor.limit));
                self.fault(Fault::MotorHot, temperature, limit);
            }
        }
        if seen.fault {
            self.fault(Fault::BackEnd, 0.0, 0.0);
        }
        if let Some((fault, value, limit)) = self.sensors.check(seen, self.cycle_late.is_some()) {
            self.fault(fault, value, limit);
        }
        let (applied, moves, late) = (self.applied, self.state.moves(), self.cycle_late.is_some());
        if let Some((fault, value, limit)) =
            self.standstill.check(gap.max(0.0), applied, seen, moves, late)
        {
            self.fault(fault, value, limit);
        }
        self.check_motion(seen);
    }

    fn check_motion(&mut self, seen: &Measurement) {
        let by_encoder = self.sensors.encoder_velocity().unwrap_or(0.0);
        let tachometer = seen.tachometer_velocity;
        let fastest = if by_encoder.abs() > tachometer.abs() { by_encoder } else { tachometer };
        if fastest.abs() > self.limits.velocity {
            self.overspeed_cycles += 1;
            if self.overspeed_cycles >= OVERSPEED_CYCLES {
                self.fault(Fault::Overspeed, fastest, self.limits.velocity);
            }
        } else {
            self.overspeed_cycles = 0;
        }
        self.position = seen.encoder_position;
        if let Some(travel) = self.limits.travel {
            let end = if self.position > travel.max { travel.max } else { travel.min };
            if self.position > travel.max + travel.margin
                || self.position < travel.min - travel.margin
            {
                self.fault(Fault::TravelExceeded, self.position, end);
            }
        }
    }

    /// Time of the present cycle \[s\].
    pub(super) fn now(&self) -> f64 {
        self.now.unwrap_or(0.0)
    }

    /// Forgets the command: zero volts until the next one.
    pub(super) fn halt(&mut self) {
        self.command = None;
        self.applied = 0.0;
    }

    /// Takes a command of `volts` \[V\] that was made at `stamp` \[s\]. One from the future counts
    /// as made now.
    pub fn command(&mut self, stamp: f64, volts: f64) {
        if !(volts.is_finite() && stamp.is_finite()) {
            self.fault(Fault::CommandNotFinite, if volts.is_finite() { stamp } else { volts }, 0.0);
            return;
        }
        if self.state.moves() {
            // Before the first cycle too: a stamp ahead would let a command count for as long as it
            // is ahead.
            let stamp = stamp.min(self.now());
            // An old command that comes late does not replace a newer one.
            if self.command.is_none_or(|before| stamp >= before.stamp) {
                self.command = Some(Command { stamp, volts });
            }
        }
    }

    /// The voltage for the coming period \[V\]: within the limits, and zero in every state but
    /// active.
    pub fn output(&mut self) -> f64 {
        let (before, now) = (self.applied, self.now.unwrap_or(0.0));
        let mut note = None;
        let wanted = self.wanted(now, &mut note);
        let allowed = self.cut(before, wanted, now, &mut note);
        self.held_back = note;
        self.applied = if self.state.moves() { allowed } else { 0.0 };
        self.applied
    }

    /// The command, as far as it still counts.
    fn wanted(&mut self, now: f64, note: &mut Option<FaultReport>) -> f64 {
        if !self.state.moves() {
            return 0.0;
        }
        // Without any command since the activation the motor waits; that is no fault.
        let Some(Command { stamp, volts }) = self.command else { return 0.0 };
        let limits = self.limits;
        let age = now - stamp;
        if age > limits.command_lost {
            self.fault(Fault::CommandLost, age, limits.command_lost);
            return 0.0;
        }
        let mut late =
            |fault, value, limit| *note = Some(FaultReport { fault, time: now, value, limit });
        if age > limits.command_age {
            late(Fault::CommandLate, age, limits.command_age);
            return 0.0;
        }
        if let Some(gap) = self.cycle_late {
            late(Fault::CycleLate, gap, limits.cycle_late);
            return 0.0;
        }
        volts
    }

    /// The voltage cut to what travel, limit and slew allow.
    fn cut(&self, before: f64, wanted: f64, now: f64, note: &mut Option<FaultReport>) -> f64 {
        let limits = &self.limits;
        let mut cut = |fault, value, limit| {
            note.get_or_insert(FaultReport { fault, time: now, value, limit });
        };
        if let Some(travel) = limits.travel {
            let outwards = if self.position > travel.max {
                wanted > 0.0
            } else {
                self.position < travel.min && wanted < 0.0
            };
            if outwards {
                let end = if wanted > 0.0 { travel.max } else { travel.min };
                cut(Fault::EndOfTravel, self.position, end);
                return 0.0;
            }
        }
        let within = wanted.clamp(-limits.voltage, limits.voltage);
        if within != wanted {
            cut(Fault::VoltageBeyondLimit, wanted, limits.voltage);
        }
        // The magnitude may fall at once; from there it grows with the slew limit.
        let from = if before * within > 0.0 { before.abs() } else { 0.0 };
        let steepest = from + limits.slew * self.period;
        if within.abs() > steepest {
            cut(Fault::VoltageTooSteep, within, steepest);
            return steepest.copysign(within);
        }
        within
    }

    /// What the last cycle's output adds to the flags of a measurement.
    pub(super) fn mark(&self, seen: &mut Measurement) {
        if let Some(report) = &self.held_back {
            match report.fault.rule().reaction {
                Reaction::Cut => seen.saturated = true,
                Reaction::ZeroWhileItLasts | Reaction::ZeroUntilCleared => {
                    seen.watchdog_expired = true
                }
            }
        }
        let lost =
            |report: &FaultReport| matches!(report.fault, Fault::CommandLost | Fault::CycleLost);
        seen.watchdog_expired |= self.latched.as_ref().is_some_and(lost);
        seen.fault |= matches!(self.state, State::Faulted | State::EmergencyStopped);
    }
}

impl From<Refused> for RigError {
    fn from(refused: Refused) -> Self {
        Self::Refused(refused)
    }
}
