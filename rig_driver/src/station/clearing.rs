//! Clearing an emergency stop.

use super::{Presence, Station};

/// Where the node is, as far as clearing cares.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum NodePhase {
    Unconfigured,
    Inactive,
    Active,
    Finalized,
    /// On its way from one to another.
    Between,
}

/// Why a stop is not cleared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, thiserror::Error)]
pub(crate) enum NotCleared {
    #[error("a transition of the node is under way; clear the emergency stop when it is over")]
    UnderWay,
    #[error(
        "the motor was not seen at zero volts since the emergency stop: the rig hangs. Take its power away, clean the node up (or start the program again), then clear"
    )]
    NotSeen,
    #[error("the emergency stop was pressed again; clear it once more if that is wanted")]
    PressedAgain,
}

/// What clearing does next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum ClearStep {
    /// Have the node deactivate.
    Deactivate,
    /// Have the node clean up: whoever stopped the machine may have changed it, so it is configured
    /// anew.
    CleanUp,
    /// It is over.
    Done(Result<(), NotCleared>),
}

/// Clears the presses up to one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Clearing {
    press: u64,
}

impl Clearing {
    /// None if nothing is pressed.
    pub(crate) fn begin(station: &Station) -> Option<Self> {
        let press = station.latch.newest();
        station.latch.is_set().then_some(Self { press })
    }

    #[cfg(test)]
    pub(super) const fn press(&self) -> u64 {
        self.press
    }

    /// What to do next, now that the node is in `phase`.
    pub(crate) fn step(&self, station: &Station, phase: NodePhase) -> ClearStep {
        let done = |why| ClearStep::Done(Err(why));
        let presence = station.presence();
        if phase == NodePhase::Between || presence == Presence::Opening {
            return done(NotCleared::UnderWay);
        }
        if presence == Presence::Running && !station.latch.was_seen(self.press) {
            return done(NotCleared::NotSeen);
        }
        match phase {
            NodePhase::Active => ClearStep::Deactivate,
            NodePhase::Inactive => ClearStep::CleanUp,
            // A thread that lives on beside a node without a rig is none that may be freed.
            _ if presence == Presence::Running => done(NotCleared::UnderWay),
            _ => {
                // Nothing drives a motor, and what is opened from here on reads the latch first.
                station.latch.note_seen(self.press);
                if station.latch.clear(self.press) {
                    ClearStep::Done(Ok(()))
                } else {
                    done(NotCleared::PressedAgain)
                }
            }
        }
    }
}
