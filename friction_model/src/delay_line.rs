//! A pure delay of a sampled signal, in a fixed amount of memory.
//!
//! The signal is taken as straight between the values that are pushed. The line keeps it at
//! [`INTERVALS`] equal intervals over the delay, however long or short the steps are, and
//! interpolates between them. So a straight signal is delayed exactly, one that curves to second
//! order in the spacing, and a jump is smeared over one spacing and one step.

use crate::Real;

/// Intervals into which the delay is divided.
pub(crate) const INTERVALS: usize = 32;

/// Samples kept: both ends of every interval.
const LENGTH: usize = INTERVALS + 1;

/// A signal's recent past, up to the delay.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DelayLine<T: Real = f64> {
    delay: T,
    /// Time between samples; zero for no delay.
    spacing: T,
    /// A ring.
    samples: [T; LENGTH],
    newest: usize,
    /// Time since the newest sample, less than the spacing.
    since: T,
    /// The signal now.
    now: T,
}

impl<T: Real> DelayLine<T> {
    /// A line of `delay` \[s\], zero or more, in which the signal has always been `value`.
    pub(crate) fn new(delay: T, value: T) -> Self {
        let spacing = delay / T::of(INTERVALS as f64);
        Self { delay, spacing, samples: [value; LENGTH], newest: 0, since: T::ZERO, now: value }
    }

    /// The signal now.
    #[inline]
    pub(crate) const fn now(&self) -> T {
        self.now
    }

    /// `dt` \[s\] go by, in which the signal goes straight to `value`. With no time it jumps there.
    #[inline]
    pub(crate) fn push(&mut self, value: T, dt: T) {
        if self.spacing > T::ZERO && dt > T::ZERO {
            let end = self.since + dt;
            // Truncated; a number too large becomes the largest.
            let passed = (end / self.spacing).double() as usize;
            self.since = crate::arithmetic::between(
                T::ZERO,
                self.spacing,
                end - T::of(passed as f64) * self.spacing,
            );
            for later in (0..passed.min(LENGTH)).rev() {
                let ago = T::of(later as f64) * self.spacing + self.since;
                self.newest = (self.newest + 1) % LENGTH;
                self.samples[self.newest] = between(value, self.now, ago / dt);
            }
        }
        self.now = value;
    }

    /// The delayed signal at a moment `ahead` \[s\] of now, to which the signal goes straight to
    /// `value`.
    #[inline]
    pub(crate) fn delayed(&self, value: T, ahead: T) -> T {
        let ago = self.delay - ahead;
        if self.spacing == T::ZERO {
            value
        } else if ago < T::ZERO {
            between(value, self.now, self.delay / ahead)
        } else {
            self.past(ago)
        }
    }

    /// The signal `ago` \[s\] before now, from zero to the delay.
    #[inline]
    fn past(&self, ago: T) -> T {
        let newest = self.sample(0);
        if ago <= self.since {
            return if self.since > T::ZERO {
                between(self.now, newest, ago / self.since)
            } else {
                self.now
            };
        }
        let place = (ago - self.since) / self.spacing;
        let before = place.double() as usize;
        between(self.sample(before), self.sample(before + 1), place - T::of(before as f64))
    }

    /// The sample `k` before the newest; the oldest if that is further back.
    #[inline]
    fn sample(&self, k: usize) -> T {
        self.samples[(self.newest + LENGTH - k.min(INTERVALS)) % LENGTH]
    }
}

/// The value at `fraction` of the way from `a` to `b`, not beyond them.
#[inline]
fn between<T: Real>(a: T, b: T, fraction: T) -> T {
    a + (b - a) * crate::arithmetic::between(T::ZERO, T::ONE, fraction)
}

#[cfg(test)]
mod tests {
    use super::*;

    const DELAY: f64 = 0.0111;

    /// Steps much shorter than the spacing (0.35 ms), about as long, longer, as long as the delay,
    /// and longer than it.
    const STEPS: [f64; 7] = [1e-5, 3.3e-4, DELAY / 32.0, 1e-3, 0.01, DELAY, 0.025];

    #[test]
    fn a_straight_signal_is_delayed_exactly_at_any_step() {
        for dt in STEPS {
            let mut line = DelayLine::new(DELAY, 0.0);
            for k in 1..=(1.0 / dt) as u32 {
                let t = f64::from(k) * dt;
                line.push(t, dt);
                if t > DELAY {
                    assert!((line.delayed(t, 0.0) - (t - DELAY)).abs() < 1e-12, "dt {dt}, t {t}");
                    // Any moment of the step to come, too.
                    for ahead in [0.1 * dt, 0.5 * dt, dt] {
                        let then = t + ahead;
                        assert!(
                            (line.delayed(then, ahead) - (then - DELAY)).abs() < 1e-12,
                            "dt {dt}, t {t}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn a_curved_signal_is_delayed_to_second_order_with_steps_of_any_lengths() {
        let omega = 30.0;
        let mut line = DelayLine::new(DELAY, 0.0);
        let (mut t, mut worst) = (0.0f64, 0.0f64);
        for k in 0..200_000u32 {
            // From 10 us to 1 ms, in no order.
            let dt = 1e-5 * (1 + (k * 7919) % 100) as f64;
            t += dt;
            line.push((omega * t).sin(), dt);
            if t > DELAY {
                let error = line.delayed(0.0, 0.0) - (omega * (t - DELAY)).sin();
                worst = worst.max(error.abs());
            }
        }
        // Chords over a step, and over a spacing: omega^2 h^2 / 8 each.
        let spacing = DELAY / INTERVALS as f64;
        let bound = omega * omega / 8.0 * (1e-6 + spacing * spacing);
        assert!(worst <= bound && worst > 0.1 * bound, "{worst}, {bound}");
    }

    #[test]
    fn a_jump_arrives_after_the_delay() {
        let dt = 1e-4;
        let mut line = DelayLine::new(DELAY, 2.0);
        line.push(5.0, 0.0);
        assert_eq!(line.now(), 5.0);
        let spacing = DELAY / INTERVALS as f64;
        for k in 1..400 {
            line.push(5.0, dt);
            let t = f64::from(k) * dt;
            let value = line.delayed(5.0, 0.0);
            if t < DELAY - dt {
                assert_eq!(value, 2.0, "t {t}");
            } else if t > DELAY + dt + spacing {
                assert_eq!(value, 5.0, "t {t}");
            } else {
                assert!((2.0..=5.0).contains(&value), "t {t}");
            }
        }
    }

    #[test]
    fn without_delay_the_signal_passes() {
        for delay in [0.0, f64::from_bits(1)] {
            let mut line = DelayLine::new(delay, 0.0);
            for dt in [1e-6, 1e-3, 1e-2] {
                line.push(3.0, dt);
                assert_eq!((line.delayed(3.0, 0.0), line.delayed(4.0, 0.005)), (3.0, 4.0));
            }
        }
    }

    /// The time that a push takes does not grow with the number of spacings that it passes.
    #[test]
    fn a_step_of_a_million_delays_leaves_the_line_full_of_the_present() {
        let mut line = DelayLine::<f64>::new(1e-9, 1.0);
        line.push(3.0, 1e-3);
        assert!((line.delayed(3.0, 0.0) - 3.0).abs() < 1e-5);
        assert!((line.delayed(7.0, 1e-2) - 7.0).abs() < 1e-6);
        let mut line = DelayLine::new(1e-300, 1.0);
        line.push(3.0, 1e-2);
        assert_eq!(line.delayed(3.0, 0.0), 3.0);
    }
}
