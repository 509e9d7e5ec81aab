//! References over time.

use controller::Reference;
use serde::{Deserialize, Serialize};

/// A reference as a function of time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Waveform {
    /// A constant velocity [rad/s] from the first instant.
    ConstantVelocity {
        /// Velocity [rad/s].
        velocity: f64,
    },
    /// A velocity that jumps from zero at a time.
    StepVelocity {
        /// Velocity afterwards [rad/s].
        velocity: f64,
        /// When it jumps \[s\].
        at: f64,
    },
    /// A position that jumps from zero at a time.
    StepPosition {
        /// Position afterwards \[rad\].
        position: f64,
        /// When it jumps \[s\].
        at: f64,
    },
    /// Velocity `amplitude sin(w t)` [rad/s].
    SineVelocity {
        /// Amplitude [rad/s].
        amplitude: f64,
        /// Angular frequency w [rad/s].
        angular_frequency: f64,
    },
    /// A smooth move from zero, without a jump of the acceleration: `position (10 s^3 - 15 s^4 + 6
    /// s^5)` with `s` from 0 to 1 over its duration (Flash and Hogan 1985, eq. 2).
    MovePosition {
        /// Position afterwards \[rad\].
        position: f64,
        /// When it begins \[s\].
        at: f64,
        /// How long it takes \[s\], above zero.
        duration: f64,
    },
    /// Position `amplitude sin(w t)` \[rad\].
    SinePosition {
        /// Amplitude \[rad\].
        amplitude: f64,
        /// Angular frequency w [rad/s].
        angular_frequency: f64,
    },
}

impl Waveform {
    /// The reference at time `t` \[s\].
    #[inline]
    #[must_use]
    pub fn at(&self, t: f64) -> Reference {
        match *self {
            Self::ConstantVelocity { velocity } => {
                Reference { position: velocity * t, velocity, acceleration: 0.0 }
            }
            Self::StepVelocity { velocity, at } => {
                let velocity = if t < at { 0.0 } else { velocity };
                Reference { position: velocity * (t - at), velocity, acceleration: 0.0 }
            }
            Self::StepPosition { position, at } => {
                let position = if t < at { 0.0 } else { position };
                Reference { position, velocity: 0.0, acceleration: 0.0 }
            }
            Self::SineVelocity { amplitude, angular_frequency: w } => {
                let (sin, cos) = (w * t).sin_cos();
                Reference {
                    position: amplitude / w * (1.0 - cos),
                    velocity: amplitude * sin,
                    acceleration: amplitude * w * cos,
                }
            }
            Self::MovePosition { position, at, duration } => {
                let s = ((t - at) / duration).clamp(0.0, 1.0);
                let rest = 1.0 - s;
                Reference {
                    position: position * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s),
                    velocity: position / duration * 30.0 * s * s * rest * rest,
                    acceleration: position / (duration * duration)
                        * 60.0
                        * s
                        * rest
                        * (1.0 - 2.0 * s),
                }
            }
            Self::SinePosition { amplitude, angular_frequency: w } => {
                let (sin, cos) = (w * t).sin_cos();
                Reference {
                    position: amplitude * sin,
                    velocity: amplitude * w * cos,
                    acceleration: -amplitude * w * w * sin,
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_move_begins_at_zero_and_ends_where_it_should() {
        let wave = Waveform::MovePosition { position: 0.7, at: 0.5, duration: 2.0 };
        assert_eq!(wave.at(0.2), Reference { position: 0.0, velocity: 0.0, acceleration: 0.0 });
        let end = wave.at(2.5);
        assert!((end.position - 0.7).abs() < 1e-12 && end.velocity == 0.0);
        // Its highest speed is 15/8 of the mean one, in the middle.
        assert!((wave.at(1.5).velocity - 0.7 / 2.0 * 1.875).abs() < 1e-12);
    }

    /// Velocity and acceleration are the derivatives of position and velocity.
    #[test]
    fn derivatives_are_consistent() {
        let h = 1e-5;
        for wave in [
            Waveform::ConstantVelocity { velocity: 1.2 },
            Waveform::StepVelocity { velocity: 1.2, at: 0.5 },
            Waveform::StepPosition { position: 1.2, at: 0.5 },
            Waveform::SineVelocity { amplitude: 0.3, angular_frequency: 0.107 },
            Waveform::MovePosition { position: 0.7, at: 0.5, duration: 2.0 },
            Waveform::SinePosition { amplitude: 1.0, angular_frequency: 0.546 },
        ] {
            for t in [0.1, 1.0, 7.7] {
                let (before, now, after) = (wave.at(t - h), wave.at(t), wave.at(t + h));
                assert!(
                    ((after.position - before.position) / (2.0 * h) - now.velocity).abs() < 1e-8
                );
                assert!(
                    ((after.velocity - before.velocity) / (2.0 * h) - now.acceleration).abs()
                        < 1e-8
                );
            }
        }
    }
}
