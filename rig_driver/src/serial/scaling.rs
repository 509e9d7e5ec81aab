//! From the device's counts to SI units, and back for the voltage.

use rig_protocol::{Hello, Measurement as Counts, State};

use crate::Measurement;

/// Cycles over which the encoder gives the velocity of a rig without a tachometer.
const DIFFERENCE: usize = 10;

/// Scales measurements and unwraps what wraps around.
#[derive(Debug, Clone)]
pub(super) struct Scaling {
    hello: Hello,
    /// The device's measurement before, of the same session.
    before: Option<Counts>,
    /// Nothing was scaled since the clock began.
    fresh: bool,
    cycle: u64,
    elapsed_us: u64,
    encoder: i64,
    /// Time [us] and encoder count of the last measurements, the present one at `cycle % DIFFERENCE` of this session.
    earlier: [Option<(u64, i64)>; DIFFERENCE],
    place: usize,
}

impl Scaling {
    pub(super) const fn new(hello: Hello) -> Self {
        Self {
            hello,
            before: None,
            fresh: true,
            cycle: 0,
            elapsed_us: 0,
            encoder: 0,
            earlier: [None; DIFFERENCE],
            place: 0,
        }
    }

    pub(super) const fn hello(&self) -> &Hello {
        &self.hello
    }

    /// Period of the device's cycle [s].
    pub(super) fn period(&self) -> f64 {
        f64::from(self.hello.period_us) * 1e-6
    }

    /// A new session: cycles and time go on one period after the last measurement, since nobody knows how long the line
    /// was gone; the encoder counts as the device says.
    pub(super) const fn rejoin(&mut self, hello: Hello) {
        self.hello = hello;
        self.before = None;
        self.earlier = [None; DIFFERENCE];
    }

    /// The next measurement is cycle 0 at time 0.
    pub(super) const fn restart_clock(&mut self) {
        *self = Self::new(self.hello);
    }

    /// `volts` as counts within the limit, and whether they were cut.
    pub(super) fn counts(&self, volts: f64) -> (i16, bool) {
        let counts = (volts / f64::from(self.hello.volts_per_count)).round();
        let limit = f64::from(self.hello.voltage_limit);
        // Within an i16 after the cut: the limit is one.
        (counts.clamp(-limit, limit) as i16, counts.abs() > limit)
    }

    /// The device's measurement in SI units; `asked` is the voltage that the controller asked for [V].
    pub(super) fn scaled(&mut self, now: &Counts, asked: f64, cut: bool) -> Measurement {
        let period_us = u64::from(self.hello.period_us);
        match (&self.before, self.fresh) {
            (Some(before), _) => {
                self.cycle += u64::from(now.cycle.wrapping_sub(before.cycle));
                self.elapsed_us += now.time_us.saturating_sub(before.time_us);
                self.encoder += i64::from(now.readings.encoder.wrapping_sub(before.readings.encoder));
            }
            (None, true) => self.encoder = now.readings.encoder.into(),
            (None, false) => {
                self.cycle += 1;
                self.elapsed_us += period_us;
                self.encoder = now.readings.encoder.into();
            }
        }
        self.before = Some(*now);
        self.fresh = false;
        let channels = self.hello.channels;
        let step = std::f64::consts::TAU / f64::from(self.hello.counts_per_turn);
        let difference = self.difference() * step;
        let of = |reading: i32, scale: f32| f64::from(reading) * f64::from(scale);
        let readings = &now.readings;
        Measurement {
            cycle: self.cycle,
            time: self.elapsed_us as f64 / 1e6,
            encoder_counts: self.encoder,
            encoder_position: self.encoder as f64 * step,
            tachometer_velocity: if channels.tachometer {
                of(readings.tachometer, self.hello.tachometer_per_count)
            } else {
                difference
            },
            potentiometer_position: of(readings.potentiometer, self.hello.potentiometer_per_count),
            torque: of(readings.torque, self.hello.torque_per_count),
            motor_current: channels.current.then(|| of(readings.current, self.hello.current_per_count)),
            voltage_asked: asked,
            voltage_applied: f64::from(now.voltage_applied) * f64::from(self.hello.volts_per_count),
            saturated: now.saturated || cut,
            watchdog_expired: now.expired,
            fault: matches!(now.state, State::Fault | State::EmergencyStopped),
        }
    }

    /// Velocity from the encoder over the last ten cycles [count/s].
    fn difference(&mut self) -> f64 {
        let now = (self.elapsed_us, self.encoder);
        self.place = (self.place + 1) % DIFFERENCE;
        let oldest = self.earlier.get_mut(self.place).and_then(|place| place.replace(now));
        // Until the ring has gone round, its first entry serves.
        match oldest.or_else(|| self.earlier.iter().flatten().min_by_key(|(time, _)| *time).copied()) {
            Some((time, count)) if time < now.0 => (now.1 - count) as f64 / ((now.0 - time) as f64 * 1e-6),
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use rig_protocol::{Cause, Channels, Name, Readings};

    use super::*;

    fn hello(channels: Channels) -> Hello {
        Hello {
            session: None,
            name: Name::default(),
            firmware: [0; 3],
            channels,
            period_us: 1000,
            counts_per_turn: 4000,
            volts_per_count: 0.01,
            voltage_limit: 600,
            tachometer_per_count: -0.5,
            potentiometer_per_count: 0.25,
            torque_per_count: 0.125,
            current_per_count: 2.0,
            validity_limit_us: 20_000,
            host_timeout_us: 250_000,
        }
    }

    fn counts(cycle: u32, encoder: i32) -> Counts {
        Counts {
            cycle,
            time_us: u64::from(cycle) * 1000 + 77,
            readings: Readings { encoder, tachometer: 3, potentiometer: 4, torque: -8, current: 5 },
            voltage_asked: 0,
            voltage_applied: -250,
            command_sequence: 0,
            commands_refused: 0,
            state: State::Active,
            cause: Cause::None,
            saturated: false,
            expired: false,
        }
    }

    const ALL: Channels = Channels { tachometer: true, potentiometer: true, torque: true, current: true };

    #[test]
    fn counts_become_si_units_and_time_begins_at_zero() {
        let mut scaling = Scaling::new(hello(ALL));
        let first = scaling.scaled(&counts(500, 1000), 1.0, false);
        assert_eq!((first.cycle, first.time, first.encoder_counts), (0, 0.0, 1000));
        assert!((first.encoder_position - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert_eq!((first.tachometer_velocity, first.torque), (-1.5, -1.0));
        assert_eq!((first.potentiometer_position, first.motor_current), (1.0, Some(10.0)));
        assert!((first.voltage_applied + 2.5).abs() < 1e-6);
        let later = scaling.scaled(&counts(503, 1000), 1.0, false);
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
        let after = scaling.scaled(&wrapped, 0.0, false);
        assert_eq!((after.cycle, after.encoder_counts), (1, i64::from(i32::MAX) + 1));
    }

    #[test]
    fn a_new_session_continues_the_time_and_takes_the_devices_encoder() {
        let mut scaling = Scaling::new(hello(ALL));
        scaling.scaled(&counts(500, 1000), 0.0, false);
        scaling.scaled(&counts(600, 1500), 0.0, false);
        scaling.rejoin(hello(ALL));
        let after = scaling.scaled(&counts(3, 7), 0.0, false);
        assert_eq!((after.cycle, after.time, after.encoder_counts), (101, 0.101, 7));
        scaling.restart_clock();
        let after = scaling.scaled(&counts(9, 7), 0.0, false);
        assert_eq!((after.cycle, after.time), (0, 0.0));
    }

    /// 2 counts a cycle of 1 ms are 2000 counts/s, pi rad/s at 4000 counts a turn.
    #[test]
    fn without_a_tachometer_the_encoder_gives_the_velocity() {
        let mut scaling = Scaling::new(Hello { tachometer_per_count: 0.0, ..hello(Channels::default()) });
        let first = scaling.scaled(&counts(0, 0), 0.0, false);
        assert_eq!((first.tachometer_velocity, first.motor_current), (0.0, None));
        for cycle in 1..40u16 {
            let seen = scaling.scaled(&counts(cycle.into(), 2 * i32::from(cycle)), 0.0, false);
            assert!((seen.tachometer_velocity - std::f64::consts::PI).abs() < 1e-9, "cycle {cycle}");
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
