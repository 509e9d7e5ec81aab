//! The emergency stop, and its clearing.

use std::{
    sync::atomic::Ordering,
    time::{Duration, Instant},
};

use ros_node::lifecycle::{Lifecycle, Phase, Requested};

use super::{super::control::Asked, Axis, LOOK};
use crate::node::locked::locked;
use crate::{
    safety::Request,
    station::{ClearStep, Clearing, NodePhase, NotCleared, Stopped},
};

/// Longest time in which the control thread puts the motor at zero volts on an emergency stop. A
/// rig that takes longer hangs, and people are told so.
const STOPS: Duration = Duration::from_millis(500);
/// Longest time for which clearing waits for a transition that is under way: less than the time
/// after which callers ask again.
const CLEARS: Duration = Duration::from_millis(800);

impl Axis {
    /// Stops the motor. It takes no lock, so that nothing that is under way can keep it: the press
    /// is the first thing, the answer the last.
    pub(in super::super) fn emergency_stop(&self) -> Result<String, String> {
        let press = self.station.latch.press();
        let stopped = self.await_stop(press, STOPS);
        let go_on = "clear_fault, configure and activate to go on";
        match stopped {
            Some(Stopped::AtZeroVolts) => Ok(format!("the motor is at zero volts; {go_on}")),
            Some(Stopped::NoRig) => {
                Ok(format!("no rig is driven, and none will be until it is cleared; {go_on}"))
            }
            Some(Stopped::Opening) => {
                Ok(format!("the rig that is being opened is closed again, at zero volts; {go_on}"))
            }
            None => Err(format!(
                "the control thread did not confirm zero volts within {} ms: the rig hangs; take its power away. The stop stays set",
                STOPS.as_millis()
            )),
        }
    }

    /// For the last moment of a process: stops the motor, and waits no longer than that.
    pub(in super::super) fn stop_before_exit(&self, at_most: Duration) {
        self.station.permission.leave();
        self.await_stop(self.station.latch.press(), at_most);
    }

    fn await_stop(&self, press: u64, at_most: Duration) -> Option<Stopped> {
        let pressed = Instant::now();
        loop {
            let stopped = self.station.stopped(press);
            if stopped.is_some() || pressed.elapsed() >= at_most {
                return stopped;
            }
            std::thread::sleep(LOOK);
        }
    }

    pub(in super::super) fn clear(&self, lifecycle: &Lifecycle) -> Result<String, String> {
        if let Some(clearing) = Clearing::begin(&self.station) {
            return self.clear_stop(clearing, lifecycle);
        }
        let state = self.ask(Asked::Safety(Request::Clear))?;
        locked(&self.told).take();
        self.logger.info("the fault is cleared");
        Ok(format!("the driver is {state}; activate to go on"))
    }

    fn clear_stop(&self, clearing: Clearing, lifecycle: &Lifecycle) -> Result<String, String> {
        let begun = Instant::now();
        let mut refused = None;
        loop {
            let phase = match lifecycle.phase() {
                Phase::Unconfigured => NodePhase::Unconfigured,
                Phase::Inactive => NodePhase::Inactive,
                Phase::Active => NodePhase::Active,
                Phase::Finalized => NodePhase::Finalized,
                _ => NodePhase::Between,
            };
            let wanted = match clearing.step(&self.station, phase) {
                ClearStep::Deactivate => Requested::Deactivate,
                ClearStep::CleanUp => Requested::CleanUp,
                ClearStep::Done(Ok(())) => {
                    self.clears_back_end.store(true, Ordering::Relaxed);
                    self.logger.info("the emergency stop is cleared");
                    return Ok(
                        "the emergency stop is cleared; configure and activate to go on".to_owned()
                    );
                }
                ClearStep::Done(Err(NotCleared::UnderWay)) if begun.elapsed() < CLEARS => {
                    std::thread::sleep(LOOK);
                    continue;
                }
                ClearStep::Done(Err(why)) => return Err(why.to_string()),
            };
            // Somebody else may have had it first; the next step sees where that led to.
            if let Err(why) = lifecycle.request(wanted) {
                refused = Some(why.to_string());
            }
            if begun.elapsed() >= CLEARS {
                return Err(refused.unwrap_or_else(|| NotCleared::UnderWay.to_string()));
            }
        }
    }
}
