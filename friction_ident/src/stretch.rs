//! Stretches of a recording: evenly sampled motion and friction, and what each is good for.

use serde::Serialize;

use crate::IdentError;
use crate::place::Place;
use crate::statistics::Sample;
use crate::steady_point::SteadyPoint;

/// An evenly sampled piece of a recording of friction.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretch {
    /// Sampling period \[s\].
    pub time_step: f64,
    /// Velocity \[m/s or rad/s\] at each sample.
    pub velocity: Vec<f64>,
    /// Position \[m or rad\] at each sample, where it was measured.
    pub position: Option<Vec<f64>>,
    /// Friction \[N or N m\] at each sample; positive opposes positive velocity.
    pub friction: Vec<f64>,
    /// Standard deviation of one sample of the friction, where it is known; only ratios between
    /// stretches count.
    pub deviation: Option<f64>,
    /// What the contact did before the first sample.
    pub before: Before,
}

/// What a contact did before a recording began.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Before {
    /// It rested, unloaded.
    #[default]
    Rested,
    /// It slid for long at the velocity of the first sample.
    Slid,
}

/// What a stretch shows of friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StretchKind {
    /// Sliding at a constant velocity: the static characteristic.
    Steady,
    /// Motion within the bristles' reach: stiffness and hysteresis.
    PreSliding,
    /// Sliding one way at a changing velocity: frictional lag.
    Lag,
    /// Anything else, reversals above all: everything together.
    Mixed,
}

impl StretchKind {
    /// All four, in the order of the figures: an array, because their errors stand in arrays.
    pub const ALL: [Self; 4] = [Self::Steady, Self::PreSliding, Self::Lag, Self::Mixed];

    /// In words.
    pub const fn describe(self) -> &'static str {
        match self {
            Self::Steady => "constant velocity",
            Self::PreSliding => "pre-sliding",
            Self::Lag => "varying velocity one way",
            Self::Mixed => "mixed motion",
        }
    }
}

impl Stretch {
    /// A stretch that slid before if it moves one way throughout, and rested if not.
    ///
    /// # Errors
    /// As for [`check`](Self::check).
    pub fn new(
        time_step: f64,
        velocity: Vec<f64>,
        position: Option<Vec<f64>>,
        friction: Vec<f64>,
    ) -> Result<Self, IdentError> {
        let mut stretch = Self {
            time_step,
            velocity,
            position,
            friction,
            deviation: None,
            before: Before::Rested,
        };
        stretch.check()?;
        if matches!(stretch.kind(None), StretchKind::Steady | StretchKind::Lag) {
            stretch.before = Before::Slid;
        }
        Ok(stretch)
    }

    /// Checks lengths and values.
    ///
    /// # Errors
    /// [`IdentError`] for channels of different length, values that are not finite, a sampling
    /// period that is not above zero, and fewer than two samples.
    pub fn check(&self) -> Result<(), IdentError> {
        if !(self.time_step > 0.0 && self.time_step.is_finite()) {
            return Err(IdentError::TimeStep(self.time_step));
        }
        let n = self.friction.len();
        if n < 2 {
            return Err(IdentError::TooFewSamples {
                what: "a stretch of a recording",
                needed: 2,
                found: n,
                lower: None,
            });
        }
        let channels = [
            ("the velocity", Some(&self.velocity)),
            ("the position", self.position.as_ref()),
            ("the friction", Some(&self.friction)),
        ];
        for (channel, values) in
            channels.into_iter().filter_map(|(name, values)| values.map(|values| (name, values)))
        {
            if values.len() != n {
                return Err(IdentError::UnequalLengths {
                    channel,
                    found: values.len(),
                    expected: n,
                });
            }
            if let Some(index) = values.iter().position(|value| !crate::finite::usable(*value)) {
                return Err(IdentError::NotFinite { channel, index, value: values[index] });
            }
        }
        Ok(())
    }

    /// Where a sample was measured, where that is known.
    pub fn place(&self, sample: usize) -> Option<Place> {
        self.position.as_ref()?.get(sample).copied().map(Place::at)
    }

    /// Samples.
    pub fn len(&self) -> usize {
        self.friction.len()
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.friction.is_empty()
    }

    /// Mean velocity from sample `k` to the next: the position's difference where there is one.
    pub(crate) fn between(&self, k: usize) -> f64 {
        match &self.position {
            Some(position) => (position[k + 1] - position[k]) / self.time_step,
            None => 0.5 * (self.velocity[k] + self.velocity[k + 1]),
        }
    }

    /// What it shows. `reach` is how far the bristles bend at most \[m or rad\], if that is known:
    /// motion that never leaves a range of twice that is pre-sliding.
    pub fn kind(&self, reach: Option<f64>) -> StretchKind {
        let position = self.travel();
        let range = extent(&position);
        if reach.is_some_and(|reach| range <= 2.0 * reach) {
            return StretchKind::PreSliding;
        }
        let sample = Sample::of(self.velocity.iter().copied());
        let (mean, deviation) = (sample.mean, sample.own_deviation());
        // The motion itself, smoothed over a fiftieth of the stretch: sensor noise is no reversal.
        let window = (self.len() / 50).clamp(1, 50);
        let smooth: Vec<f64> = (0..self.len() - window)
            .map(|k| (position[k + window] - position[k]) / (window as f64 * self.time_step))
            .collect();
        if smooth.is_empty() {
            return StretchKind::Mixed;
        }
        let (slowest, fastest) = smooth
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)));
        let one_way = slowest > 0.0 || fastest < 0.0;
        if one_way && (fastest - slowest) < 0.05 * mean.abs() + deviation.min(0.2 * mean.abs()) {
            StretchKind::Steady
        } else if one_way
            && slowest.abs().min(fastest.abs()) > 1e-3 * slowest.abs().max(fastest.abs())
        {
            StretchKind::Lag
        } else {
            StretchKind::Mixed
        }
    }

    /// From one end of the travel to the other \[m or rad\].
    #[must_use]
    pub fn range(&self) -> f64 {
        extent(&self.travel())
    }

    /// The steady point that a stretch at constant velocity is worth: means, and the standard error
    /// of the mean friction.
    pub fn steady_point(&self) -> SteadyPoint {
        let n = self.len() as f64;
        let torque = self.friction.iter().sum::<f64>() / n;
        let squares: f64 = self.friction.iter().map(|f| (f - torque).powi(2)).sum();
        let travel = self.travel();
        let duration = self.time_step * (n - 1.0);
        let velocity = (travel[travel.len() - 1] - travel[0]) / duration;
        let deviation = (squares / (n - 1.0) / n).sqrt();
        SteadyPoint {
            velocity,
            torque,
            deviation: (deviation > 1e-12 * torque.abs()).then_some(deviation),
            place: self.position.as_deref().and_then(Place::mean),
        }
    }

    /// The position, integrated from the velocity where there is none.
    pub fn travel(&self) -> Vec<f64> {
        if let Some(position) = &self.position {
            return position.clone();
        }
        let mut travel = Vec::with_capacity(self.len());
        let mut at = 0.0;
        for (k, velocity) in self.velocity.iter().enumerate() {
            if k > 0 {
                at += 0.5 * self.time_step * (self.velocity[k - 1] + velocity);
            }
            travel.push(at);
        }
        travel
    }
}

fn extent(values: &[f64]) -> f64 {
    let (low, high) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)));
    high - low
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stretch(velocity: impl Fn(f64) -> f64) -> Stretch {
        let velocity: Vec<f64> = (0..5000).map(|k| velocity(f64::from(k) * 1e-3)).collect();
        let friction = vec![0.1; velocity.len()];
        Stretch::new(1e-3, velocity, None, friction).unwrap()
    }

    #[test]
    fn each_motion_is_recognised() {
        let noise = |t: f64| 0.01 * (1e5 * t).sin();
        assert_eq!(stretch(|t| 0.05 + noise(t)).kind(Some(0.006)), StretchKind::Steady);
        assert_eq!(
            stretch(|t| 1.0 - 0.95 * (5.0 * t).cos() + noise(t)).kind(Some(0.006)),
            StretchKind::Lag
        );
        assert_eq!(stretch(|t| (5.0 * t).sin() + noise(t)).kind(Some(0.006)), StretchKind::Mixed);
        assert_eq!(stretch(|t| (5.0 * t).sin()).before, Before::Rested);
        assert_eq!(stretch(|_| 0.05).before, Before::Slid);
        assert_eq!(stretch(|t| 0.01 * (5.0 * t).sin()).kind(Some(0.006)), StretchKind::PreSliding);
    }

    #[test]
    fn a_constant_velocity_is_worth_a_point() {
        let point = stretch(|_| 0.25).steady_point();
        assert!((point.velocity - 0.25).abs() < 1e-12 && (point.torque - 0.1).abs() < 1e-12);
        assert_eq!(point.deviation, None);
    }
}
