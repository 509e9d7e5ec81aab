//! What tells the device to stop, until it says that it did.

use std::time::Instant;

use rig_protocol::{HostMessage, State};

use super::SerialRig;
use crate::safety::{self, Fault};
use crate::serial::SerialError;
use crate::serial::monitor::Finding;
use crate::serial::stopping::{AGAIN, Next, PATIENCE, Stopping};

impl SerialRig {
    /// Tells the device to stop, and to say that it did. Does not wait for that.
    pub(super) fn stop(&mut self, emergency: bool) -> Result<(), SerialError> {
        (self.active, self.asked, self.cut) = (false, 0.0, false);
        // An emergency stop that is on its way is not made less of.
        let emergency = emergency || self.stopping.is_some_and(|stopping| stopping.emergency);
        self.stopping = Some(Stopping::new(emergency, Instant::now()));
        self.tell_to_stop(emergency)
    }

    fn tell_to_stop(&mut self, emergency: bool) -> Result<(), SerialError> {
        if emergency {
            self.send(|_| HostMessage::EmergencyStop)?;
        }
        self.send(|_| HostMessage::Deactivate)
    }

    /// Sees to it that what was told to stop says so. `state` is what a new measurement shows.
    pub(super) fn see_to_the_stop(&mut self, state: Option<State>) {
        let now = Instant::now();
        if self.stopping.is_none()
            && state == Some(State::Active)
            && !self.active
            && !self.activating
        {
            // Nobody here let the motor move.
            self.stopping = Some(Stopping::new(false, now - AGAIN));
        }
        let Some(mut stopping) = self.stopping.take() else { return };
        let next = stopping.next(now, state);
        if next == Next::Done {
            return;
        }
        let overdue = stopping.overdue(now);
        self.stopping = Some(stopping);
        if next == Next::Again {
            // A line that is gone says so by itself.
            let _ = self.tell_to_stop(stopping.emergency);
        }
        if overdue {
            let seconds = PATIENCE.as_secs_f64();
            self.latch((Fault::StopNotAcknowledged, seconds, seconds));
        }
    }

    /// Latches what was found out, and has the device rest.
    pub(super) fn latch(&mut self, (fault, value, limit): Finding) {
        let time = self.newest.map_or(0.0, |(_, seen, _)| seen.time);
        self.finding.get_or_insert(safety::FaultReport { fault, time, value, limit });
        if self.stopping.is_none() {
            // A line that is gone says so by itself.
            let _ = self.stop(false);
        }
    }
}
