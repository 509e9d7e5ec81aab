//! Whether the shaft stands still where the motor has zero volts.

use super::{Fault, Standstill, sensors::Finding};
use crate::Measurement;

/// Voltage that counts as zero \[V\]: no motor of this kind turns its gear with it.
const ZERO: f64 = 0.02;
/// Windows over which the speed is averaged \[s\].
const WINDOW: f64 = 0.1;
/// What coasts loses more than this part of its speed from one window to the next.
const LOST: f64 = 0.1;

/// Watches the shaft while the motor has zero volts.
///
/// It is armed while the motor may move, and after that until the shaft has come to rest once: then
/// a hand may turn it.
#[derive(Debug, Clone, Copy)]
pub(super) struct StandstillMonitor {
    limits: Option<Standstill>,
    armed: bool,
    /// How long the motor has had zero volts \[s\].
    zero_for: f64,
    /// Length of the present window \[s\], integral of the tachometer over it \[rad\], encoder at
    /// its beginning \[rad\].
    window: Option<(f64, f64, f64)>,
    /// Speed in the window before, where it was too fast [rad/s].
    before: Option<f64>,
}

impl StandstillMonitor {
    pub(super) const fn new(limits: Option<Standstill>) -> Self {
        Self { limits, armed: false, zero_for: 0.0, window: None, before: None }
    }

    /// Takes a cycle that began `gap` \[s\] after the one before, with `volts` on the motor since
    /// then; `moves` says whether the motor may move, `late` that the gap was too long to say
    /// anything.
    pub(super) fn check(
        &mut self,
        gap: f64,
        volts: f64,
        seen: &Measurement,
        moves: bool,
        late: bool,
    ) -> Option<Finding> {
        let Standstill { after, velocity } = self.limits?;
        let driven = volts.abs() > ZERO;
        self.armed |= moves || driven;
        let measured = seen.tachometer_velocity.is_finite() && seen.encoder_position.is_finite();
        if driven || late || !self.armed || !measured || gap.is_nan() {
            self.zero_for = if driven { 0.0 } else { self.zero_for };
            (self.window, self.before) = (None, None);
            return None;
        }
        self.zero_for += gap;
        if self.zero_for < after {
            return None;
        }
        let (length, turned, from) = self.window.unwrap_or((0.0, 0.0, seen.encoder_position));
        if self.window.is_none() {
            self.window = Some((0.0, 0.0, seen.encoder_position));
            return None;
        }
        let (length, turned) = (length + gap, turned + gap * seen.tachometer_velocity);
        if length < WINDOW {
            self.window = Some((length, turned, from));
            return None;
        }
        self.window = Some((0.0, 0.0, seen.encoder_position));
        let speed = (turned / length).abs().max(((seen.encoder_position - from) / length).abs());
        if speed <= velocity {
            self.before = None;
            // It has come to rest.
            self.armed = moves;
            return None;
        }
        let before = self.before.replace(speed)?;
        (speed > (1.0 - LOST) * before).then_some((Fault::MotionAtZero, speed, velocity))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const LIMITS: Standstill = Standstill { after: 0.5, velocity: 0.5 };

    /// A shaft that turns with `speed` at each time [s], with `volts` and leave to move; when a
    /// fault is found.
    fn found(seconds: f64, run: impl Fn(f64) -> (f64, f64, bool)) -> Option<f64> {
        let mut monitor = StandstillMonitor::new(Some(LIMITS));
        let (mut position, mut time) = (0.0, 0.0);
        while time < seconds {
            time += 1e-3;
            let (speed, volts, moves) = run(time);
            position += 1e-3 * speed;
            let seen = Measurement {
                tachometer_velocity: speed,
                encoder_position: position,
                ..Measurement::default()
            };
            if let Some((fault, value, limit)) = monitor.check(1e-3, volts, &seen, moves, false) {
                assert_eq!((fault, limit), (Fault::MotionAtZero, 0.5));
                assert!((value - speed.abs()).abs() < 0.1 * value, "{value} for {speed} rad/s");
                return Some(time);
            }
        }
        None
    }

    #[test]
    fn a_motor_that_goes_on_at_zero_volts_is_found_in_three_quarters_of_a_second() {
        // A driver stage that keeps the voltage of before; in either direction, while active and
        // after it was stopped.
        for (speed, moves) in [(3.0, true), (-3.0, true), (0.6, false), (9.0, false)] {
            let time =
                found(5.0, |time| (speed, if time < 1.0 { 2.0 } else { 0.0 }, time < 1.0 || moves));
            assert!(
                time.is_some_and(|time| (1.65..1.75).contains(&time)),
                "{speed} rad/s: {time:?}"
            );
        }
        // One that starts by itself while the motor may move.
        assert!(found(9.0, |time| (if time < 4.0 { 0.0 } else { 2.0 }, 0.0, true)).is_some());
    }

    #[test]
    fn a_hand_may_turn_a_shaft_that_was_stopped_and_came_to_rest() {
        let run = |time: f64| match time {
            ..1.0 => (3.0, 2.0, true),
            ..2.5 => (0.0, 0.0, false),
            _ => (4.0, 0.0, false),
        };
        assert_eq!(found(9.0, run), None);
        assert_eq!(found(9.0, |_| (4.0, 0.0, false)), None, "never activated");
        // While it may move, nobody turns it.
        assert!(found(9.0, |time| (run(time).0, run(time).1, true)).is_some());
    }

    #[test]
    fn it_can_be_switched_off() {
        let mut monitor = StandstillMonitor::new(None);
        let seen = Measurement { tachometer_velocity: 9.0, ..Measurement::default() };
        assert!((0..10_000).all(|_| monitor.check(1e-3, 0.0, &seen, true, false).is_none()));
    }

    proptest! {
        /// What coasts is no alarm, however it was driven before: by friction alone, by the motor's
        /// own braking, or by both, down to rest.
        #[test]
        fn what_coasts_raises_no_alarm(speed in -10.0..10.0f64, constant in 0.02..0.9f64, deceleration in 0.0..5.0f64) {
            let coast = |time: f64| {
                let slower = speed.abs() * (-(time - 1.0) / constant).exp() - deceleration * (time - 1.0);
                slower.max(0.0) * speed.signum()
            };
            let run = |moves: bool| move |time: f64| if time < 1.0 { (speed, 2.0, true) } else { (coast(time), 0.0, moves) };
            prop_assert_eq!(found(9.0, run(true)), None);
            prop_assert_eq!(found(9.0, run(false)), None);
        }

        /// Whatever is read, and whatever time passes, is judged without a panic.
        #[test]
        fn any_reading_is_judged(readings in proptest::collection::vec(any::<(f64, f64, f64, f64, bool, bool)>(), 1..100)) {
            let mut monitor = StandstillMonitor::new(Some(LIMITS));
            for (gap, volts, tachometer_velocity, encoder_position, moves, late) in readings {
                let seen = Measurement { tachometer_velocity, encoder_position, ..Measurement::default() };
                monitor.check(gap, volts, &seen, moves, late);
            }
        }
    }
}
