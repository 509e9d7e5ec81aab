//! Which cycles are shown: a simulated rig may be far quicker than time.

use std::time::{Duration, Instant};

/// Cycles that are shown within a second.
const CYCLES: u32 = 2000;

/// Which cycles are shown.
#[derive(Default)]
pub(super) struct Pace {
    began: Option<Instant>,
    shown: u32,
    stamp_ns: u64,
    shows: bool,
}

impl Pace {
    /// Whether messages of that time are: all of a cycle or none.
    pub(super) fn shows(&mut self, stamp_ns: u64) -> bool {
        if stamp_ns == self.stamp_ns {
            return self.shows;
        }
        self.stamp_ns = stamp_ns;
        if self.began.is_none_or(|began| began.elapsed() >= Duration::from_secs(1)) {
            (self.began, self.shown) = (Some(Instant::now()), 0);
        }
        self.shows = self.shown < CYCLES;
        self.shown += u32::from(self.shows);
        self.shows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cycle_is_shown_whole_or_not_at_all() {
        let mut pace = Pace::default();
        for stamp in 0..u64::from(CYCLES) + 100 {
            let shown = pace.shows(stamp + 1);
            assert_eq!(shown, pace.shows(stamp + 1));
            if pace.began.is_some_and(|began| began.elapsed() < Duration::from_millis(900)) {
                assert_eq!(shown, stamp < u64::from(CYCLES));
            }
        }
    }
}
