//! What people ask of a rig, and what its control thread does about it: the node's logic without
//! ROS, clocks and threads.
//!
//! Everything that is shared is in [`Station`], and every access to it is one atomic, sequentially
//! consistent step. The transitions ([`Walk`]), the clearing of a stop ([`Clearing`]) and the
//! control thread's part of a cycle ([`Checked`]) are machines that take one step when they are
//! told to: the node steps them by clock and thread, and a test in every order there is.

mod clearing;
mod cycle;
mod desk;
#[cfg(test)]
mod interleavings;
mod permission;
mod transition;

use std::sync::atomic::{AtomicU8, Ordering::SeqCst};

pub(crate) use clearing::{ClearStep, Clearing, NodePhase, NotCleared};
#[cfg(test)]
pub(crate) use cycle::Checked;
pub(crate) use desk::Desk;
pub(crate) use permission::Permission;
#[cfg(test)]
pub(crate) use transition::Reason;
pub(crate) use transition::{Hands, Kind, Progress, Walk};

use crate::safety::StopLatch;

/// Whether there is a control thread.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[repr(u8)]
pub(crate) enum Presence {
    /// No rig, or none that anything drives any more.
    Absent,
    /// A rig is being opened; nothing drives it yet.
    Opening,
    /// A control thread drives it.
    Running,
}

/// What the emergency stop can say.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Stopped {
    /// The control thread has put the motor at zero volts.
    AtZeroVolts,
    /// Nothing drives a motor, and nothing will before the stop is cleared.
    NoRig,
    /// A rig is being opened; it will be closed again.
    Opening,
}

/// What node, services and control thread share. No locks: nobody waits for anybody here.
#[derive(Debug, Default)]
pub(crate) struct Station {
    /// The emergency stop.
    pub(crate) latch: StopLatch,
    /// Whether the motor may move as far as the node is concerned.
    pub(crate) permission: Permission,
    /// The request to the control thread that is under way.
    pub(crate) desk: Desk,
    presence: AtomicU8,
}

impl Station {
    /// A station under a stop that may have been pressed before.
    pub(crate) fn under(latch: StopLatch) -> Self {
        Self { latch, ..Self::default() }
    }

    pub(crate) fn presence(&self) -> Presence {
        match self.presence.load(SeqCst) {
            0 => Presence::Absent,
            1 => Presence::Opening,
            _ => Presence::Running,
        }
    }

    pub(crate) fn enter(&self, presence: Presence) {
        self.presence.store(presence as u8, SeqCst);
    }

    /// The answer to a press, once there is one.
    pub(crate) fn stopped(&self, press: u64) -> Option<Stopped> {
        // A thread that is there after this has read the latch, or will before it puts a voltage
        // out.
        match self.presence() {
            _ if self.latch.was_seen(press) => Some(Stopped::AtZeroVolts),
            Presence::Absent => Some(Stopped::NoRig),
            Presence::Opening => Some(Stopped::Opening),
            Presence::Running => None,
        }
    }
}
