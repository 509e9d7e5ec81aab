//! Motion that the tachometer shows and the encoder does not: a ramp that waits for the encoder would
//! go on for ever.

use std::collections::VecDeque;

use friction_ident::statistics::Sample;
use rig_driver::Measurement;

use super::RigSetupError;

/// Time over which the tachometer is averaged \[s\].
const WINDOW: f64 = 0.05;
/// How far the mean has to be from that at rest: in standard deviations of a reading, and [rad/s].
const CLEAR: f64 = 6.0;
const LEAST: f64 = 0.05;
/// Angle that such motion comes to before it counts \[rad\].
const ANGLE: f64 = 0.3;
/// Counts of the encoder that are none.
const NOISE: i64 = 2;

/// A watch over one ramp.
#[derive(Debug, Clone)]
pub(super) struct Unseen {
    zero: f64,
    noise: f64,
    window: usize,
    period: f64,
    latest: VecDeque<f64>,
    turned: f64,
    first: Option<i64>,
}

impl Unseen {
    /// Of a tachometer that showed that at `rest`.
    pub(super) fn of(rest: &[Measurement], period: f64) -> Self {
        let seen = Sample::of(rest.iter().map(|seen| seen.tachometer_velocity));
        let mean = seen.uncertain_mean();
        let noise = mean
            .as_ref()
            .map_or(f64::INFINITY, |mean| mean.standard_error * (rest.len() as f64).sqrt());
        Self {
            zero: mean.map_or(0.0, |mean| mean.value),
            noise,
            window: ((WINDOW / period) as usize).max(2),
            period,
            latest: VecDeque::new(),
            turned: 0.0,
            first: None,
        }
    }

    /// Takes in what is seen under `volts`.
    ///
    /// # Errors
    /// [`RigSetupError::EncoderStands`] where the shaft turned by the tachometer alone.
    pub(super) fn watch(&mut self, seen: &Measurement, volts: f64) -> Result<(), RigSetupError> {
        let first = *self.first.get_or_insert(seen.encoder_counts);
        if (seen.encoder_counts - first).abs() > NOISE {
            (self.first, self.turned) = (Some(seen.encoder_counts), 0.0);
        }
        self.latest.push_back(seen.tachometer_velocity - self.zero);
        if self.latest.len() <= self.window {
            return Ok(());
        }
        self.latest.pop_front();
        let velocity = self.latest.iter().sum::<f64>() / self.latest.len() as f64;
        // The mean of a window scatters less than a reading does.
        if velocity.abs() > (CLEAR * self.noise).max(LEAST) {
            self.turned += velocity.abs() * self.period;
        }
        if self.turned > ANGLE {
            return Err(RigSetupError::EncoderStands { volts: volts.abs(), velocity });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(counts: i64, velocity: f64) -> Measurement {
        Measurement {
            encoder_counts: counts,
            tachometer_velocity: velocity,
            ..Measurement::default()
        }
    }

    fn watched(counts: impl Fn(i64) -> i64, velocity: f64) -> Result<(), RigSetupError> {
        let noise = |k: i64| 0.01 * (2.4 * k as f64).sin();
        let rest: Vec<Measurement> = (0..400).map(|k| seen(0, 0.05 + noise(k))).collect();
        let mut unseen = Unseen::of(&rest, 1e-3);
        (0..2000).try_for_each(|k| unseen.watch(&seen(counts(k), 0.05 + velocity + noise(k)), 1.5))
    }

    #[test]
    fn a_shaft_that_turns_and_an_encoder_that_stands_are_told_and_nothing_else_is() {
        let said = watched(|_| 0, 1.0).unwrap_err().to_string();
        assert!(said.contains("1.50 V") && said.contains("plug"), "{said}");
        watched(|k| k / 4, 1.0).unwrap();
        watched(|_| 0, 0.0).unwrap();
    }
}
