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

    /// Velocity and acceleration are the derivatives of position and velocity.
    #[test]
    fn derivatives_are_consistent() {
        let h = 1e-5;
        for wave in [
            Waveform::ConstantVelocity { velocity: 1.2 },
            Waveform::StepVelocity { velocity: 1.2, at: 0.5 },
            Waveform::StepPosition { position: 1.2, at: 0.5 },
            Waveform::SineVelocity { amplitude: 0.3, angular_frequency: 0.107 },
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
