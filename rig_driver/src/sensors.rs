//! Sensors as real ones are: noise, range and converter steps.

use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};

/// A sensor's parameter that cannot be.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "sensor {sensor}: {field} must be {expected}, but is {value}; change it in the rig's parameters"
)]
pub struct SensorError {
    /// The sensor.
    pub sensor: &'static str,
    /// The field.
    pub field: &'static str,
    /// What came.
    pub value: f64,
    /// What was expected.
    pub expected: &'static str,
}

/// An analogue channel: the value plus noise, cut to the range, rounded to the converter's step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Channel {
    /// Largest magnitude that can be read, in the channel's unit.
    pub range: f64,
    /// Converter step in the channel's unit; zero for none.
    pub resolution: f64,
    /// Standard deviation of white noise before the converter, in the channel's unit.
    pub noise: f64,
}

impl Channel {
    /// Standard deviation of one reading: the noise, and the converter's rounding as even noise,
    /// step / sqrt(12).
    #[must_use]
    pub fn deviation(&self) -> f64 {
        (self.noise.powi(2) + self.resolution.powi(2) / 12.0).sqrt()
    }

    /// What the converter reads of `value`.
    #[inline]
    pub fn read(&self, value: f64, noise: &mut Pcg64Mcg) -> f64 {
        let draw: f64 = StandardNormal.sample(noise);
        let noisy = (value + self.noise * draw).clamp(-self.range, self.range);
        quantise(noisy, self.resolution)
    }

    fn check(&self, sensor: &'static str) -> Result<(), SensorError> {
        let error = |field, value, expected| Err(SensorError { sensor, field, value, expected });
        if self.range.is_nan() || self.range <= 0.0 {
            return error("range", self.range, "above zero");
        }
        for (field, value) in [("resolution", self.resolution), ("noise", self.noise)] {
            if !(value >= 0.0 && value.is_finite()) {
                return error(field, value, "a finite number, zero or more");
            }
        }
        Ok(())
    }
}

/// Rounds to a multiple of `step`; a step of zero leaves the value alone.
#[inline]
pub(crate) fn quantise(value: f64, step: f64) -> f64 {
    if step > 0.0 { (value / step).round() * step } else { value }
}

/// All sensors and the voltage output of a rig. Load side.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sensors {
    /// Encoder counts a turn; 0 for an ideal encoder.
    pub encoder_counts_per_turn: u32,
    /// Velocity [rad/s].
    pub tachometer: Channel,
    /// Position \[rad\].
    pub potentiometer: Channel,
    /// Torque [N m].
    pub torque: Channel,
    /// Motor current \[A\], the mean over a cycle.
    pub current: Channel,
    /// Step of the voltage output \[V\]; zero for none.
    pub voltage_resolution: f64,
}

impl Default for Sensors {
    /// The thesis's test bed: 4096 counts, tachometer 1 rad/s per volt with 0.01 rad/s of noise,
    /// potentiometer of 352 degrees with 2 mV, torque sensor of 23 N m with 0.0061 N m; 12-bit
    /// converters of +-10 V (+-5 V for the potentiometer). The thesis has no current sensor: one of
    /// 1 V/A with 5 mA of noise is assumed, as servo amplifiers have it.
    fn default() -> Self {
        const STEPS: f64 = 4096.0;
        let half_turn = 176f64.to_radians();
        Self {
            encoder_counts_per_turn: 4096,
            tachometer: Channel { range: 10.0, resolution: 20.0 / STEPS, noise: 0.01 },
            potentiometer: Channel {
                range: half_turn,
                resolution: 2.0 * half_turn / STEPS,
                noise: 0.002 * half_turn / 5.0,
            },
            torque: Channel { range: 23.0, resolution: 46.0 / STEPS, noise: 0.0061 },
            current: Channel { range: 10.0, resolution: 20.0 / STEPS, noise: 0.005 },
            voltage_resolution: 20.0 / STEPS,
        }
    }
}

impl Sensors {
    /// Sensors without noise, steps or limits, for studies of the models alone.
    #[must_use]
    pub const fn ideal() -> Self {
        const IDEAL: Channel = Channel { range: f64::INFINITY, resolution: 0.0, noise: 0.0 };
        Self {
            encoder_counts_per_turn: 0,
            tachometer: IDEAL,
            potentiometer: IDEAL,
            torque: IDEAL,
            current: IDEAL,
            voltage_resolution: 0.0,
        }
    }

    /// Count and position \[rad\] that the encoder shows at `position`. An ideal encoder counts
    /// whole microradians.
    #[inline]
    #[must_use]
    pub fn encoder(&self, position: f64) -> (i64, f64) {
        if self.encoder_counts_per_turn == 0 {
            return ((position * 1e6).floor() as i64, position);
        }
        let step = std::f64::consts::TAU / f64::from(self.encoder_counts_per_turn);
        let counts = (position / step).floor();
        (counts as i64, counts * step)
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`SensorError`] names the sensor and the field.
    pub fn check(&self) -> Result<(), SensorError> {
        self.tachometer.check("tachometer")?;
        self.potentiometer.check("potentiometer")?;
        self.torque.check("torque")?;
        self.current.check("current")?;
        if !(self.voltage_resolution >= 0.0 && self.voltage_resolution.is_finite()) {
            return Err(SensorError {
                sensor: "voltage",
                field: "resolution",
                value: self.voltage_resolution,
                expected: "a finite number, zero or more",
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    #[test]
    fn torque_noise_and_steps_are_those_of_the_data_sheet() {
        let channel = Sensors::default().torque;
        assert!((channel.resolution - 0.01123).abs() < 1e-5);
        let mut noise = Pcg64Mcg::seed_from_u64(7);
        let n = 100_000;
        let readings: Vec<f64> = (0..n).map(|_| channel.read(0.1, &mut noise)).collect();
        let mean = readings.iter().sum::<f64>() / f64::from(n);
        let variance = readings.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / f64::from(n - 1);
        // Sheppard: a dithered converter adds step^2 / 12.
        let expected = 0.0061f64.powi(2) + channel.resolution.powi(2) / 12.0;
        assert!((mean - 0.1).abs() < 5.0 * (expected / f64::from(n)).sqrt() + 2e-5, "{mean}");
        assert!((variance / expected - 1.0).abs() < 0.02, "{variance} is not {expected}");
        for r in readings {
            let steps = r / channel.resolution;
            assert!((steps - steps.round()).abs() < 1e-9);
        }
    }

    #[test]
    fn the_encoder_counts_4096_a_turn_in_both_directions() {
        let sensors = Sensors::default();
        let step = std::f64::consts::TAU / 4096.0;
        assert_eq!(sensors.encoder(0.5 * step), (0, 0.0));
        assert_eq!(sensors.encoder(1.5 * step).0, 1);
        assert_eq!(sensors.encoder(-0.5 * step).0, -1);
    }
}
