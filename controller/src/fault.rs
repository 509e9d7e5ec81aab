//! Measurements that cannot be acted on.
//!
//! A measurement is missing if something in it is not a finite number, or if it carries the same
//! cycle number as the one before. A missing measurement gives zero volts for its cycle and leaves
//! no trace in the controller. More of them in a row than are tolerated are a fault: zero volts
//! from there on, until somebody resets the controller.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Why the controller gives zero volts for good.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ControlFault {
    /// Too many measurements in a row were not finite numbers.
    NotFinite,
    /// Too many measurements in a row were the one before once more.
    Stale,
}

impl fmt::Display for ControlFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "the measurement or the friction estimate is not a finite number",
            Self::Stale => "the measurement no longer changes its cycle number",
        })
    }
}

/// Counts missing measurements.
#[derive(Debug, Clone)]
pub(crate) struct FaultLatch {
    tolerated: u32,
    missed: u32,
    cycle: Option<u64>,
    latched: Option<ControlFault>,
}

impl FaultLatch {
    pub(crate) const fn new(tolerated: u32) -> Self {
        Self { tolerated, missed: 0, cycle: None, latched: None }
    }

    /// The fault that holds the output at zero.
    #[inline]
    pub(crate) const fn latched(&self) -> Option<ControlFault> {
        self.latched
    }

    /// Whether `cycle` is that of the measurement before.
    #[inline]
    pub(crate) fn is_stale(&self, cycle: Option<u64>) -> bool {
        cycle.is_some() && cycle == self.cycle
    }

    /// A measurement that is missing for this reason.
    #[inline]
    pub(crate) fn missed(&mut self, cycle: Option<u64>, why: ControlFault) {
        self.cycle = cycle.or(self.cycle);
        self.missed = self.missed.saturating_add(1);
        if self.missed > self.tolerated {
            self.latched = Some(why);
        }
    }

    /// A measurement that was acted on.
    #[inline]
    pub(crate) fn seen(&mut self, cycle: Option<u64>) {
        (self.cycle, self.missed) = (cycle, 0);
    }

    pub(crate) const fn tolerate(&mut self, cycles: u32) {
        self.tolerated = cycles;
    }

    pub(crate) const fn reset(&mut self) {
        (self.missed, self.cycle, self.latched) = (0, None, None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_missing_measurements_in_a_row_are_a_fault() {
        let mut latch = FaultLatch::new(2);
        for cycle in 0..100 {
            latch.missed(Some(cycle), ControlFault::NotFinite);
            latch.missed(Some(cycle), ControlFault::Stale);
            assert_eq!(latch.latched(), None);
            latch.seen(Some(cycle));
        }
        for cycle in 100..103 {
            latch.missed(Some(cycle), ControlFault::NotFinite);
        }
        latch.seen(Some(104));
        assert_eq!(latch.latched(), Some(ControlFault::NotFinite));
        latch.reset();
        assert_eq!(latch.latched(), None);
    }

    #[test]
    fn a_source_without_cycle_numbers_is_never_stale() {
        let mut latch = FaultLatch::new(2);
        latch.seen(None);
        assert!(!latch.is_stale(None));
        latch.seen(Some(7));
        assert!(latch.is_stale(Some(7)) && !latch.is_stale(Some(8)));
    }
}
