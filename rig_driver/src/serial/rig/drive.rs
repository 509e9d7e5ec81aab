//! The rig as whoever drives it sees it.

use std::time::{Duration, Instant};

use rig_protocol::{HostMessage, State, VoltageCommand};

use super::{Link, SerialRig};
use crate::safety;
use crate::serial::{SerialError, scheduling, supervision};
use crate::{Measurement, Rig, RigError};

/// Longest wait for the acknowledgement of an emergency stop. The thread that drives is in it, with
/// the motor at zero volts.
const STOPS_WITHIN: Duration = Duration::from_millis(20);

impl Rig for SerialRig {
    fn period(&self) -> f64 {
        self.scaling.period()
    }

    fn voltage_range(&self) -> f64 {
        supervision::voltage_range(self.hello())
    }

    fn keeps_time(&self) -> bool {
        true
    }

    fn wait(&mut self) -> Result<(), RigError> {
        if !self.seen {
            self.follow();
        }
        self.see_to_the_stop(None);
        if !self.active
            && self.last_sent.elapsed() >= self.sign_of_life()
            && matches!(self.link, Link::Up(..))
        {
            // A line that is gone says so by itself.
            let _ = self.heartbeat();
        }
        let end = Instant::now() + Duration::from_secs_f64(self.options.silence);
        // Measurements that lie there already: the newest counts. If none does, wait for the next.
        let mut fresh = false;
        while let Ok(event) = self.events.try_recv() {
            let measured = self.take(event)?;
            self.statistics.skipped += u64::from(measured && fresh);
            fresh |= measured;
        }
        // Who comes late to a full queue finds only old ones in it; the device would refuse the
        // answer.
        fresh &= self.age().is_some_and(|age| age < 0.5 * self.options.validity);
        if fresh || self.next(end)? {
            self.waited = true;
            if let Some(age) = self.age() {
                let age_us = (age * 1e6) as u64;
                self.statistics.longest_age_us = self.statistics.longest_age_us.max(age_us);
            }
            return Ok(());
        }
        Err(match &self.link {
            Link::Down(error) => error.clone(),
            Link::Up(..) => self.silent(),
        }
        .into())
    }

    /// The newest measurement. Without a [`wait`](Rig::wait) before, it waits itself; if no cycle
    /// comes, the measurement is the last one, marked as a fault.
    fn measure(&mut self) -> Measurement {
        let failed = !self.waited && self.wait().is_err();
        (self.waited, self.seen) = (false, true);
        let seen = self.newest.map(|(_, seen, _)| seen).unwrap_or_default();
        Measurement { fault: seen.fault || self.fault || self.finding.is_some() || failed, ..seen }
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        self.fault |= !volts.is_finite();
        self.asked = if volts.is_finite() { volts } else { 0.0 };
        let (mut voltage, cut) = self.scaling.counts(self.asked);
        self.cut = cut;
        if self.fault {
            voltage = 0;
        }
        let answers = match (&self.link, self.newest) {
            (Link::Down(error), _) => return Err(error.clone().into()),
            (Link::Up(..), Some((device, ..))) if self.active => device.cycle,
            // A motor that may not move has zero volts already.
            (Link::Up(..), _) if voltage == 0 && volts.is_finite() => return Ok(()),
            (Link::Up(..), Some((device, ..))) => {
                return Err(
                    SerialError::NotActive { state: device.state, cause: device.cause }.into()
                );
            }
            (Link::Up(..), None) => return Err(self.silent().into()),
        };
        let validity_us = (self.options.validity * 1e6).round() as u32;
        self.statistics.commands += 1;
        self.send(|origin| {
            HostMessage::Voltage(VoltageCommand { origin, answers, voltage, validity_us })
        })?;
        if volts.is_finite() { Ok(()) } else { Err(RigError::VoltageNotFinite(volts)) }
    }

    fn activate(&mut self) -> Result<(), RigError> {
        self.follow();
        if let Some(report) = self.finding {
            return Err(RigError::Safety(report));
        }
        (self.stopping, self.activating) = (None, true);
        let outcome = self.request(
            HostMessage::Activate,
            |state| state == State::Active,
            |state| matches!(state, State::Fault | State::EmergencyStopped),
        );
        self.activating = false;
        if let Err(error) = outcome {
            // It may have gone active all the same.
            let _ = self.stop(false);
            return Err(error.into());
        }
        (self.active, self.asked, self.cut) = (true, 0.0, false);
        if !self.seen {
            // Time begins with the cycle that follows.
            self.scaling.restart_clock();
        }
        Ok(())
    }

    /// Tells the device to rest, without waiting for it to say so; if it does not within 0.1 s,
    /// that is a fault.
    fn halt(&mut self) -> Result<(), RigError> {
        Ok(self.stop(false)?)
    }

    /// Latches an emergency stop in the device. Waits up to 20 ms for a measurement that shows it;
    /// the device is told again every 10 ms until one does, and if none does within 0.1 s, that is
    /// a fault.
    fn emergency_stop(&mut self) -> Result<(), RigError> {
        self.stop(true)?;
        let end = Instant::now() + STOPS_WITHIN;
        while self.stopping.is_some() && Instant::now() < end {
            self.next(end)?;
        }
        if self.stopping.is_none() {
            return Ok(());
        }
        let milliseconds = STOPS_WITHIN.as_millis() as u64;
        Err(SerialError::StopNotAcknowledged { path: self.path.clone(), milliseconds }.into())
    }

    /// Clears what is latched in the device, a voltage here that was not a number, and what was
    /// found out about the line. The motor stays at zero volts until activated.
    fn clear(&mut self) -> Result<(), RigError> {
        (self.fault, self.finding, self.stopping) = (false, None, None);
        self.monitor.restart();
        self.request(
            HostMessage::Clear,
            |state| matches!(state, State::Inactive | State::Active),
            |_| false,
        )?;
        Ok(())
    }

    /// By its clock and by its cycles, whichever says less: either may wrap around.
    fn powered_for(&self) -> Option<f64> {
        let (device, ..) = self.newest?;
        let by_cycles = f64::from(device.cycle) * self.scaling.period();
        Some(by_cycles.min(device.time_us as f64 / 1e6))
    }

    fn held_by(&self) -> Option<RigError> {
        let (device, ..) = self.newest?;
        let latched = matches!(device.state, State::Fault | State::EmergencyStopped);
        latched.then(|| SerialError::NotActive { state: device.state, cause: device.cause }.into())
    }

    fn latched_fault(&self) -> Option<safety::FaultReport> {
        self.finding
    }
}

impl SerialRig {
    /// The reader has the class of the thread that waits for it.
    fn follow(&self) {
        if let Some(reader) = &self.reader {
            // Refused, it stays as it is: late, which the supervisor sees.
            let _ = scheduling::follow(reader);
        }
    }
}
