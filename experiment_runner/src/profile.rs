//! What is driven over time, piece by piece: the form into which protocols are turned.

use controller::{ControlMode, Reference};
use serde::{Deserialize, Serialize};

/// Rest before the torque rises \[s\]: it gives the displacement's zero.
pub const REST: f64 = 0.2;

/// What a profile is a profile of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DrivenQuantity {
    /// Velocity [rad/s], followed by the velocity controller.
    Velocity,
    /// Position \[rad\], followed by the position controller.
    Position,
    /// Motor voltage \[V\], without a controller.
    Voltage,
    /// Motor torque at standstill [N m], without a controller: as much voltage as overcomes it.
    Torque,
}

/// One piece of a profile. Times count from its beginning.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Segment {
    /// A straight line.
    Line {
        /// Value at the beginning.
        from: f64,
        /// Value at the end.
        to: f64,
        /// Length \[s\].
        duration: f64,
    },
    /// `level + amplitude sin(phase + from t + (to - from) t^2 / (2 duration))`: a sine, or a
    /// chirp.
    Wave {
        /// Mean value.
        level: f64,
        /// Amplitude.
        amplitude: f64,
        /// Phase at the beginning \[rad\].
        phase: f64,
        /// Angular frequency at the beginning [rad/s].
        from: f64,
        /// Angular frequency at the end [rad/s].
        to: f64,
        /// Length \[s\].
        duration: f64,
    },
}

impl Segment {
    /// Zero for a moment.
    pub const REST: Self = Self::Line { from: 0.0, to: 0.0, duration: REST };

    /// Straight lines from `start` over all `turns` at one rate, `duration` \[s\] in all.
    #[must_use]
    pub fn path(start: f64, turns: &[f64], duration: f64) -> Vec<Self> {
        let starts = || std::iter::once(start).chain(turns.iter().copied());
        let length: f64 = starts().zip(turns).map(|(from, to)| (to - from).abs()).sum();
        let line = |(from, &to): (f64, &f64)| Self::Line {
            from,
            to,
            duration: duration * (to - from).abs() / length,
        };
        if length > 0.0 { starts().zip(turns).map(line).collect() } else { Vec::new() }
    }

    /// Length \[s\].
    #[must_use]
    pub const fn duration(&self) -> f64 {
        match *self {
            Self::Line { duration, .. } | Self::Wave { duration, .. } => duration,
        }
    }

    /// Value and rate at time `t` \[s\].
    #[must_use]
    pub fn at(&self, t: f64) -> (f64, f64) {
        match *self {
            Self::Line { from, to, duration } if duration > 0.0 => {
                let rate = (to - from) / duration;
                (from + rate * t, rate)
            }
            Self::Line { to, .. } => (to, 0.0),
            Self::Wave { level, amplitude, phase, from, to, duration } => {
                let sweep = if duration > 0.0 { (to - from) / duration } else { 0.0 };
                let angle = phase + t * (from + 0.5 * sweep * t);
                (level + amplitude * angle.sin(), amplitude * (from + sweep * t) * angle.cos())
            }
        }
    }
}

/// Segments one after the other.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Profile {
    segments: Vec<Segment>,
}

impl Profile {
    /// The segments in their order.
    #[must_use]
    pub const fn new(segments: Vec<Segment>) -> Self {
        Self { segments }
    }

    /// Length \[s\].
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.segments.iter().map(Segment::duration).sum()
    }

    /// Times at which the segments end \[s\].
    #[must_use]
    pub fn ends(&self) -> Vec<f64> {
        let mut time = 0.0;
        let mut end = |segment: &Segment| {
            time += segment.duration();
            time
        };
        self.segments.iter().map(&mut end).collect()
    }

    /// Value and rate at time `t` \[s\]; beyond the end the last value, at rest.
    #[must_use]
    pub fn at(&self, t: f64) -> (f64, f64) {
        let mut begin = 0.0;
        for segment in &self.segments {
            if t < begin + segment.duration() {
                return segment.at(t - begin);
            }
            begin += segment.duration();
        }
        self.segments.last().map_or((0.0, 0.0), |last| (last.at(last.duration()).0, 0.0))
    }
}

/// A profile of a quantity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Excitation {
    /// What is driven.
    pub quantity: DrivenQuantity,
    /// How.
    pub profile: Profile,
}

impl Excitation {
    /// What the controller regulates; without a controller, what the messages speak of.
    #[must_use]
    pub const fn mode(&self) -> ControlMode {
        match self.quantity {
            DrivenQuantity::Position => ControlMode::Position,
            _ => ControlMode::Velocity,
        }
    }

    /// The reference at time `t` \[s\]; without a controller it is zero. The position that belongs
    /// to a velocity is not worked out: the velocity controller does not use it.
    #[must_use]
    pub fn reference(&self, t: f64) -> Reference {
        let (value, rate) = self.profile.at(t);
        match self.quantity {
            DrivenQuantity::Velocity => {
                Reference { position: 0.0, velocity: value, acceleration: rate }
            }
            DrivenQuantity::Position => {
                Reference { position: value, velocity: rate, acceleration: 0.0 }
            }
            _ => Reference::default(),
        }
    }

    /// The voltage at time `t` \[s\] where there is no controller.
    #[must_use]
    pub fn open_loop(&self, t: f64, volts_per_newton_metre: f64) -> Option<f64> {
        match self.quantity {
            DrivenQuantity::Voltage => Some(self.profile.at(t).0),
            DrivenQuantity::Torque => Some(self.profile.at(t).0 * volts_per_newton_metre),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_is_the_derivative_of_the_value() {
        let profile = Profile::new(vec![
            Segment::Line { from: 0.0, to: 2.0, duration: 1.0 },
            Segment::Wave {
                level: 2.0,
                amplitude: 0.5,
                phase: 0.3,
                from: 1.0,
                to: 9.0,
                duration: 4.0,
            },
        ]);
        let h = 1e-6;
        for t in [0.4, 1.7, 3.0, 4.9] {
            let slope = (profile.at(t + h).0 - profile.at(t - h).0) / (2.0 * h);
            assert!((slope - profile.at(t).1).abs() < 1e-6, "{t}: {slope}");
        }
        assert_eq!((profile.duration(), profile.ends()), (5.0, vec![1.0, 5.0]));
    }

    #[test]
    fn a_path_passes_its_turns_at_one_rate_in_the_time_given() {
        let path = Profile::new(Segment::path(0.0, &[0.3, -0.1, 0.2], 2.0));
        assert!((path.duration() - 2.0).abs() < 1e-12);
        for (end, turn) in path.ends().into_iter().zip([0.3, -0.1, 0.2]) {
            assert!((path.at(end - 1e-9).0 - turn).abs() < 1e-8);
        }
        for t in [0.1, 0.8, 1.5] {
            assert!((path.at(t).1.abs() - 0.5).abs() < 1e-12);
        }
    }
}
