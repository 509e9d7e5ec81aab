//! The node's time: the system's, or that of `/clock` under `use_sim_time`.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    time::{SystemTime, UNIX_EPOCH},
};

/// Tells the time. Clones tell the same.
#[derive(Debug, Clone, Default)]
pub struct NodeClock(Arc<State>);

#[derive(Debug, Default)]
struct State {
    simulated: AtomicBool,
    /// Last time on `/clock` \[ns\].
    shown_ns: AtomicU64,
}

impl NodeClock {
    /// The time now, in nanoseconds since the epoch. Under `use_sim_time` it is the last on
    /// `/clock`, zero before the first.
    #[must_use]
    pub fn now_ns(&self) -> u64 {
        if self.is_simulated() {
            return self.0.shown_ns.load(Ordering::Relaxed);
        }
        SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos() as u64)
    }

    /// Whether `use_sim_time` is set.
    #[must_use]
    pub fn is_simulated(&self) -> bool {
        self.0.simulated.load(Ordering::Relaxed)
    }

    pub(crate) fn simulate(&self, simulated: bool) {
        self.0.simulated.store(simulated, Ordering::Relaxed);
    }

    pub(crate) fn show(&self, time_ns: u64) {
        self.0.shown_ns.store(time_ns, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn simulated_time_is_what_was_shown_last() {
        let clock = NodeClock::default();
        assert!(clock.now_ns() > 1_600_000_000_000_000_000);
        clock.simulate(true);
        assert_eq!(clock.now_ns(), 0);
        clock.show(7);
        assert_eq!(clock.clone().now_ns(), 7);
    }
}
