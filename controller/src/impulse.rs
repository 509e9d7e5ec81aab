//! The knocker: short voltage pulses in the direction in which the controller is moving its output
//! (Haegglund, Journal of Process Control 12, 2002, "A friction compensator for pneumatic control
//! valves").
//!
//! Pulses of equal height, width and period are added to the command. At each onset the direction
//! is the sign of the change of the controller's output since the onset before: an integrator that
//! winds up against stiction is helped on its way before it has wound up.

use ::parameters::{ValueRange, parameters};
use serde::{Deserialize, Serialize};

use crate::ControllerError;
use crate::error::non_negative;

parameters! {
    /// A train of pulses: each is at least one control cycle wide and shorter than the time between
    /// two onsets.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct Impulse {
        height: f64, "Height of the knocker's pulses", unit("V"), more("0 for none"),
            range(ValueRange::NON_NEGATIVE);
        width: f64, "Width of a pulse", unit("s"), range(ValueRange::POSITIVE);
        period: f64, "Time between two onsets", unit("s"), range(ValueRange::POSITIVE);
    }
}

/// A knocker running at a fixed period.
#[derive(Debug, Clone)]
pub struct Knocker {
    height: f64,
    /// Width and period in cycles.
    width: u32,
    period: u32,
    /// Cycles since the last onset.
    age: u32,
    direction: f64,
    /// Controller's output at the last onset \[V\].
    output_before: f64,
}

impl Knocker {
    /// A knocker whose first pulse starts a period after the first cycle, called every `dt` \[s\].
    ///
    /// # Errors
    /// [`ControllerError::OutOfRange`] names what cannot be.
    pub fn new(impulse: Impulse, dt: f64) -> Result<Self, ControllerError> {
        non_negative("impulse height", impulse.height)?;
        let cycles = |name, seconds: f64, least: f64, expected: &'static str| {
            let cycles = (seconds / dt).round();
            if cycles >= least && cycles <= f64::from(u32::MAX / 2) {
                Ok(cycles as u32)
            } else {
                Err(ControllerError::OutOfRange { name, value: seconds, expected: expected.into() })
            }
        };
        let width =
            cycles("impulse width", impulse.width, 1.0, "at least one control cycle, in seconds")?;
        let longer = "longer than the pulse's width, in seconds";
        let period = cycles("impulse period", impulse.period, f64::from(width) + 1.0, longer)?;
        Ok(Self {
            height: impulse.height,
            width,
            period,
            age: 0,
            direction: 0.0,
            output_before: 0.0,
        })
    }

    /// Voltage of the present cycle \[V\], while the controller itself asks for `output` \[V\].
    #[inline]
    #[must_use]
    pub fn output(&self, output: f64) -> f64 {
        let (age, direction, _) = self.now(output);
        if age < self.width { self.height * direction } else { 0.0 }
    }

    /// On to the next cycle.
    #[inline]
    pub fn advance(&mut self, output: f64) {
        let (age, direction, before) = self.now(output);
        (self.age, self.direction, self.output_before) = (age + 1, direction, before);
    }

    #[inline]
    fn now(&self, output: f64) -> (u32, f64, f64) {
        if self.age < self.period {
            return (self.age, self.direction, self.output_before);
        }
        let change = output - self.output_before;
        let direction = if change == 0.0 { 0.0 } else { change.signum() };
        (0, direction, output)
    }

    /// Back to the start.
    pub fn reset(&mut self) {
        (self.age, self.direction, self.output_before) = (0, 0.0, 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const IMPULSE: Impulse = Impulse { height: 0.3, width: 0.002, period: 0.01 };

    fn knock(output: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut knocker = Knocker::new(IMPULSE, 1e-3).unwrap();
        (0..40)
            .map(|k| {
                let u = knocker.output(output(k));
                knocker.advance(output(k));
                u
            })
            .collect()
    }

    #[test]
    fn pulses_follow_the_direction_of_the_controller() {
        let rising = knock(|k| k as f64);
        assert_eq!(rising[9..13], [0.0, 0.3, 0.3, 0.0]);
        assert_eq!(rising.iter().filter(|u| **u != 0.0).count(), 6);
        let turning = knock(|k| -(k as f64 - 10.0).abs());
        // Rising until cycle 10, falling from there: the first pulse goes up, the later ones down.
        assert_eq!((turning[10], turning[20], turning[30]), (0.0, -0.3, -0.3));
    }

    #[test]
    fn a_controller_at_rest_is_left_alone() {
        assert!(knock(|_| 0.0).iter().all(|u| *u == 0.0));
    }

    #[test]
    fn pulses_that_touch_are_refused() {
        for (impulse, name) in [
            (Impulse { period: 0.002, ..IMPULSE }, "impulse period"),
            (Impulse { width: 1e-4, ..IMPULSE }, "impulse width"),
            (Impulse { height: f64::NAN, ..IMPULSE }, "impulse height"),
        ] {
            assert!(Knocker::new(impulse, 1e-3).unwrap_err().to_string().starts_with(name));
        }
    }
}
