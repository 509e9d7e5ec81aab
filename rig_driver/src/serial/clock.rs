//! The device's cycles and time, from counters that wrap to numbers that do not.

use rig_protocol::Measurement;

/// How far cycles and clock may contradict each other: so many periods, and this part of the time
/// that passed.
const PERIODS: u64 = 2;
const PART: u64 = 8;

/// Cycles and time since the clock began. Both only grow.
#[derive(Debug, Clone)]
pub(super) struct DeviceClock {
    period_us: u64,
    /// Cycle and time of the measurement before, of the same session.
    before: Option<(u32, u64)>,
    /// Nothing was heard since the clock began.
    fresh: bool,
    cycle: u64,
    elapsed_us: u64,
}

/// Cycles and clock contradict each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Jump {
    /// By how much \[us\].
    pub(super) by_us: u64,
    /// How much is allowed \[us\].
    pub(super) allowed_us: u64,
}

impl DeviceClock {
    pub(super) fn new(period_us: u32) -> Self {
        Self { period_us: period_us.into(), before: None, fresh: true, cycle: 0, elapsed_us: 0 }
    }

    /// A new session: cycles and time go on one period after the last measurement, since nobody
    /// knows how long the line was gone.
    pub(super) fn rejoin(&mut self, period_us: u32) {
        (self.period_us, self.before) = (period_us.into(), None);
    }

    pub(super) const fn cycle(&self) -> u64 {
        self.cycle
    }

    pub(super) const fn elapsed_us(&self) -> u64 {
        self.elapsed_us
    }

    /// Takes the next measurement. Says whether its clock contradicts its cycles; time goes on by
    /// the cycles then.
    ///
    /// A device's clock may have 32 bits, which wrap after 71.6 minutes, or 64: what fits the
    /// cycles is believed.
    pub(super) fn advance(&mut self, now: &Measurement) -> Option<Jump> {
        let Some((cycle, time_us)) = self.before.replace((now.cycle, now.time_us)) else {
            if !std::mem::take(&mut self.fresh) {
                self.go(1, self.period_us);
            }
            return None;
        };
        let cycles = u64::from(now.cycle.wrapping_sub(cycle));
        let expected = cycles * self.period_us;
        let allowed_us = PERIODS * self.period_us + expected / PART;
        let whole = now.time_us.wrapping_sub(time_us);
        let narrow = now.time_us <= u32::MAX.into() && time_us <= u32::MAX.into();
        let low = u64::from((now.time_us as u32).wrapping_sub(time_us as u32));
        let fits = |passed: &u64| passed.abs_diff(expected) <= allowed_us;
        match [Some(whole), narrow.then_some(low)].into_iter().flatten().find(fits) {
            Some(passed) => {
                self.go(cycles, passed);
                None
            }
            None => {
                self.go(cycles, expected);
                Some(Jump { by_us: whole.min(time_us.wrapping_sub(now.time_us)), allowed_us })
            }
        }
    }

    fn go(&mut self, cycles: u64, us: u64) {
        self.cycle = self.cycle.saturating_add(cycles);
        self.elapsed_us = self.elapsed_us.saturating_add(us);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::serial::test_messages::measured;

    fn at(cycle: u64, time_us: u64) -> Measurement {
        Measurement { cycle: cycle as u32, time_us, ..measured() }
    }

    /// Twenty hours at 1 kHz in steps of a minute: a clock of 32 bits wraps 16 times.
    #[test]
    fn a_clock_of_32_bits_goes_on_over_many_wraps() {
        for bits in [u64::from(u32::MAX), u64::MAX] {
            let mut clock = DeviceClock::new(1000);
            for minute in 0..1200u64 {
                let cycle = minute * 60_000;
                assert_eq!(
                    clock.advance(&at(cycle, (cycle * 1000 + 123) & bits)),
                    None,
                    "minute {minute}"
                );
                assert_eq!((clock.cycle(), clock.elapsed_us()), (cycle, cycle * 1000));
            }
        }
    }

    /// The cycle's number wraps after 49.7 days; a gap of any length before the next measurement
    /// changes nothing.
    #[test]
    fn the_cycles_number_goes_on_where_it_wraps() {
        let mut clock = DeviceClock::new(1000);
        let mut cycle = u64::from(u32::MAX) - 10;
        clock.advance(&at(cycle, cycle * 1000));
        let first = cycle;
        for gap in [1, 5, 100, 1, 1_000_000] {
            cycle += gap;
            assert_eq!(clock.advance(&at(cycle, cycle * 1000)), None);
            assert_eq!(
                (clock.cycle(), clock.elapsed_us()),
                (cycle - first, (cycle - first) * 1000)
            );
        }
    }

    #[test]
    fn a_clock_that_jumps_or_runs_backwards_is_told_and_time_goes_on_by_the_cycles() {
        for time_us in [0, 1, 50_000, 112_500, u64::from(u32::MAX), u64::MAX, u64::MAX / 2] {
            let mut clock = DeviceClock::new(1000);
            clock.advance(&at(100, 100_000));
            assert!(clock.advance(&at(101, time_us)).is_some(), "{time_us}");
            assert_eq!((clock.cycle(), clock.elapsed_us()), (1, 1000));
            // What comes after is held against the new time.
            assert_eq!(clock.advance(&at(102, time_us.wrapping_add(1000))), None, "{time_us}");
        }
    }

    proptest! {
        /// Whatever a device says, time and cycles grow and nothing overflows.
        #[test]
        fn time_never_runs_backwards(said in proptest::collection::vec(any::<(u32, u64)>(), 1..60)) {
            let mut clock = DeviceClock::new(10_000);
            for (place, (cycle, time_us)) in said.into_iter().enumerate() {
                let before = (clock.cycle(), clock.elapsed_us());
                if place % 7 == 6 {
                    clock.rejoin(100);
                }
                clock.advance(&Measurement { cycle, time_us, ..measured() });
                prop_assert!(clock.cycle() >= before.0 && clock.elapsed_us() >= before.1);
            }
        }

        /// Jitter of almost half a period each way raises no alarm, on any period.
        #[test]
        fn jitter_is_no_jump(period in 100..=10_000u32, steps in proptest::collection::vec((1..500u64, -0.45..0.45f64), 1..60)) {
            let mut clock = DeviceClock::new(period);
            let (mut cycle, begin) = (0u64, u64::from(u32::MAX) - 300_000);
            for (step, jitter) in steps {
                cycle += step;
                let time = (begin + cycle * u64::from(period)).wrapping_add_signed((jitter * f64::from(period)) as i64);
                prop_assert_eq!(clock.advance(&at(cycle, time & u64::from(u32::MAX))), None);
            }
        }
    }
}
