//! From the device's counts to SI units, and back for the voltage.

use rig_protocol::{Hello, Measurement as Counts, State};

use super::clock::{DeviceClock, Jump};
use crate::Measurement;

/// Cycles over which the encoder gives the velocity of a rig without a tachometer.
const DIFFERENCE: usize = 10;

/// Scales measurements and unwraps what wraps around.
#[derive(Debug, Clone)]
pub(super) struct Scaling {
    hello: Hello,
    clock: DeviceClock,
    /// The encoder's count of the measurement before, of the same session.
    before: Option<i32>,
    encoder: i64,
    /// Time \[us\] and encoder count of the last measurements, the present one at
    /// `cycle % DIFFERENCE` of this session.
    earlier: [Option<(u64, i64)>; DIFFERENCE],
    place: usize,
}

impl Scaling {
    pub(super) fn new(hello: Hello) -> Self {
        Self {
            hello,
            clock: DeviceClock::new(hello.period_us),
            before: None,
            encoder: 0,
            earlier: [None; DIFFERENCE],
            place: 0,
        }
    }

    pub(super) const fn hello(&self) -> &Hello {
        &self.hello
    }

    /// Period of the device's cycle \[s\].
    pub(super) fn period(&self) -> f64 {
        // Divided, so that 100 us are the same number as 1e-4 s in a limit: 100 * 1e-6 is below it
        // by a bit.
        f64::from(self.hello.period_us) / 1e6
    }

    /// A new session: cycles and time go on one period after the last measurement, since nobody
    /// knows how long the line was gone; the encoder counts as the device says.
    pub(super) fn rejoin(&mut self, hello: Hello) {
        self.hello = hello;
        self.clock.rejoin(hello.period_us);
        self.before = None;
        self.earlier = [None; DIFFERENCE];
    }

    /// The next measurement is cycle 0 at time 0.
    pub(super) fn restart_clock(&mut self) {
        *self = Self::new(self.hello);
    }

    /// `volts` as counts within the limit, and whether they were cut.
    pub(super) fn counts(&self, volts: f64) -> (i16, bool) {
        let counts = (volts / f64::from(self.hello.volts_per_count)).round();
        let limit = f64::from(self.hello.voltage_limit);
        // Within an i16 after the cut: the limit is one.
        (counts.clamp(-limit, limit) as i16, counts.abs() > limit)
    }

    /// The device's measurement in SI units, and whether its clock contradicts its cycles; `asked`
    /// is the voltage that the controller asked for \[V\].
    pub(super) fn scaled(
        &mut self,
        now: &Counts,
        asked: f64,
        cut: bool,
    ) -> (Measurement, Option<Jump>) {
        let jump = self.clock.advance(now);
        self.encoder = match self.before.replace(now.readings.encoder) {
            Some(before) => self.encoder + i64::from(now.readings.encoder.wrapping_sub(before)),
            None => now.readings.encoder.into(),
        };
        let channels = self.hello.channels;
        let step = std::f64::consts::TAU / f64::from(self.hello.counts_per_turn);
        let difference = self.difference() * step;
        let of = |reading: i32, scale: f32| f64::from(reading) * f64::from(scale);
        let readings = &now.readings;
        let measurement = Measurement {
            cycle: self.clock.cycle(),
            time: self.clock.elapsed_us() as f64 / 1e6,
            encoder_counts: self.encoder,
            encoder_position: self.encoder as f64 * step,
            tachometer_velocity: if channels.tachometer {
                of(readings.tachometer, self.hello.tachometer_per_count)
            } else {
                difference
            },
            potentiometer_position: of(readings.potentiometer, self.hello.potentiometer_per_count),
            torque: of(readings.torque, self.hello.torque_per_count),
            motor_current: channels
                .current
                .then(|| of(readings.current, self.hello.current_per_count)),
            voltage_asked: asked,
            voltage_applied: f64::from(now.voltage_applied) * f64::from(self.hello.volts_per_count),
            saturated: now.saturated || cut,
            watchdog_expired: now.expired,
            fault: matches!(now.state, State::Fault | State::EmergencyStopped),
        };
        (measurement, jump)
    }

    /// Velocity from the encoder over the last ten cycles [count/s].
    fn difference(&mut self) -> f64 {
        let now = (self.clock.elapsed_us(), self.encoder);
        self.place = (self.place + 1) % DIFFERENCE;
        let oldest = self.earlier.get_mut(self.place).and_then(|place| place.replace(now));
        // Until the ring has gone round, its first entry serves.
        match oldest
            .or_else(|| self.earlier.iter().flatten().min_by_key(|(time, _)| *time).copied())
        {
            Some((time, count)) if time < now.0 => {
                (now.1 - count) as f64 / ((now.0 - time) as f64 * 1e-6)
            }
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use rig_protocol::{Channels, Readings};

    use super::*;
    use crate::serial::test_messages::{self, measured};

    fn hello(channels: Channels) -> Hello {
        Hello { channels, ..test_messages::hello() }
    }

    fn counts(cycle: u32, encoder: i32) -> Counts {
        let time_us = u64::from(cycle) * 1000 + 77;
        let readings = Readings { encoder, ..measured().readings };
        Counts { cycle, time_us, readings, voltage_applied: -250, ..measured() }
    }

    const ALL: Channels =
        Channels { tachometer: true, potentiometer: true, torque: true, current: true };

    #[test]
    fn counts_become_si_units_and_time_begins_at_zero() {
        let mut scaling = Scaling::new(hello(ALL));
        let first = scaling.scaled(&counts(500, 1000), 1.0, false).0;
        assert_eq!((first.cycle, first.time, first.encoder_counts), (0, 0.0, 1000));
        assert!((first.encoder_position - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert_eq!((first.tachometer_velocity, first.torque), (-1.5, -1.0));
        assert_eq!((first.potentiometer_position, first.motor_current), (1.0, Some(10.0)));
        assert!((first.voltage_applied + 2.5).abs() < 1e-6);
        let later = scaling.scaled(&counts(503, 1000), 1.0, false).0;
        assert_eq!((later.cycle, later.time), (3, 0.003));
    }

    #[test]
    fn cycle_and_encoder_go_on_where_their_counters_wrap() {
        let mut scaling = Scaling::new(hello(ALL));
        let mut last = counts(u32::MAX, i32::MAX);
        last.time_us = 0;
        scaling.scaled(&last, 0.0, false);
        let mut wrapped = counts(0, i32::MIN);
        wrapped.time_us = 1000;
        let after = scaling.scaled(&wrapped, 0.0, false).0;
        assert_eq!((after.cycle, after.encoder_counts), (1, i64::from(i32::MAX) + 1));
    }

    #[test]
    fn a_new_session_continues_the_time_and_takes_the_devices_encoder() {
        let mut scaling = Scaling::new(hello(ALL));
        scaling.scaled(&counts(500, 1000), 0.0, false);
        scaling.scaled(&counts(600, 1500), 0.0, false);
        scaling.rejoin(hello(ALL));
        let after = scaling.scaled(&counts(3, 7), 0.0, false).0;
        assert_eq!((after.cycle, after.time, after.encoder_counts), (101, 0.101, 7));
        scaling.restart_clock();
        let after = scaling.scaled(&counts(9, 7), 0.0, false).0;
        assert_eq!((after.cycle, after.time), (0, 0.0));
    }

    /// 2 counts a cycle of 1 ms are 2000 counts/s, pi rad/s at 4000 counts a turn.
    #[test]
    fn without_a_tachometer_the_encoder_gives_the_velocity() {
        let mut scaling =
            Scaling::new(Hello { tachometer_per_count: 0.0, ..hello(Channels::default()) });
        let first = scaling.scaled(&counts(0, 0), 0.0, false).0;
        assert_eq!((first.tachometer_velocity, first.motor_current), (0.0, None));
        for cycle in 1..40u16 {
            let seen = scaling.scaled(&counts(cycle.into(), 2 * i32::from(cycle)), 0.0, false).0;
            assert!(
                (seen.tachometer_velocity - std::f64::consts::PI).abs() < 1e-9,
                "cycle {cycle}"
            );
        }
    }

    /// Every period that a device may have lies within the ranges that others hold it to, the ends
    /// included.
    #[test]
    fn a_period_of_100_us_is_100_us() {
        for (period_us, seconds) in [(100, 1e-4), (300, 3e-4), (1000, 1e-3), (10_000, 0.01)] {
            assert_eq!(Scaling::new(Hello { period_us, ..hello(ALL) }).period(), seconds);
        }
        for period_us in 100..=10_000 {
            let period = Scaling::new(Hello { period_us, ..hello(ALL) }).period();
            assert!((1e-4..=0.01).contains(&period), "{period_us} us are {period} s");
        }
    }

    #[test]
    fn voltages_are_rounded_to_counts_and_cut_at_the_limit() {
        let scaling = Scaling::new(hello(ALL));
        assert_eq!(scaling.counts(1.234), (123, false));
        assert_eq!(scaling.counts(-6.0), (-600, false));
        assert_eq!(scaling.counts(-6.1), (-600, true));
        assert_eq!(scaling.counts(1e300), (600, true));
    }
}
