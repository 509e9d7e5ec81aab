//! Feedback of an estimated acceleration: `u = -K_a a`, with `a = s / (T_f s + 1) w` of the
//! measured velocity.
//!
//! On the drive `T w' + w = K (u - r F)` an exact acceleration gives
//! `(T + K K_a) w' + w = K (u' - r F)`: the shaft moves as if its inertia were larger by the factor
//! `1 + K K_a / T`, against friction as well. Alone that makes the loop slower. It allows the gains
//! of the velocity loop to grow by the same factor at the same poles, and friction then leaves an
//! error that is smaller by that factor. The filter sets the limit: its lag takes phase, and noise
//! of the velocity reaches the voltage with the gain `K_a / T_f`.

use ::parameters::{ValueRange, parameters};
use serde::{Deserialize, Serialize};

use crate::ControllerError;
use crate::design::LinearDrive;
use crate::error::{non_negative, positive};

parameters! {
    /// Acceleration feedback.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct AccelerationFeedback {
        gain: f64, "Gain K_a of the acceleration feedback", unit("V s^2/rad"), more("0 for none"),
            range(ValueRange::NON_NEGATIVE);
        filter: f64, "Time constant T_f of its derivative's filter", unit("s"),
            range(ValueRange::POSITIVE);
    }
}

impl AccelerationFeedback {
    /// The gain with which `drive` moves as if it had `factor` times its inertia,
    /// `K_a = (factor - 1) T / K`.
    #[must_use]
    pub fn for_inertia(drive: &LinearDrive, factor: f64, filter: f64) -> Self {
        Self { gain: (factor - 1.0) * drive.time_constant / drive.gain, filter }
    }

    /// The drive as the outer loop sees it at frequencies well below `1 / T_f`: its time constant
    /// is `T + K K_a`.
    #[must_use]
    pub fn apparent(&self, drive: &LinearDrive) -> LinearDrive {
        LinearDrive { time_constant: drive.time_constant + drive.gain * self.gain, ..*drive }
    }
}

/// The estimator of the acceleration, running at a fixed period (bilinear rule).
#[derive(Debug, Clone)]
pub struct AccelerationEstimator {
    feedback: AccelerationFeedback,
    decay: f64,
    gain: f64,
    acceleration: f64,
    velocity: Option<f64>,
}

impl AccelerationEstimator {
    /// An estimator that starts with no acceleration, called every `dt` \[s\].
    ///
    /// # Errors
    /// [`ControllerError::OutOfRange`] names gain or filter.
    pub fn new(feedback: AccelerationFeedback, dt: f64) -> Result<Self, ControllerError> {
        non_negative("acceleration gain", feedback.gain)?;
        positive("acceleration filter", feedback.filter)?;
        // Below half a period the bilinear rule would ring.
        let filter = feedback.filter.max(0.5 * dt);
        let denominator = 2.0 * filter + dt;
        Ok(Self {
            feedback,
            decay: (2.0 * filter - dt) / denominator,
            gain: 2.0 / denominator,
            acceleration: 0.0,
            velocity: None,
        })
    }

    /// The acceleration at the measured `velocity` \[rad/s^2\].
    #[inline]
    #[must_use]
    pub fn acceleration(&self, velocity: f64) -> f64 {
        self.decay * self.acceleration + self.gain * (velocity - self.velocity.unwrap_or(velocity))
    }

    /// Voltage for the measured `velocity` \[V\].
    #[inline]
    #[must_use]
    pub fn output(&self, velocity: f64) -> f64 {
        -self.feedback.gain * self.acceleration(velocity)
    }

    /// Takes the velocity in.
    #[inline]
    pub fn update(&mut self, velocity: f64) {
        self.acceleration = self.acceleration(velocity);
        self.velocity = Some(velocity);
    }

    /// Goes on from where `other` is.
    pub(crate) fn take_over(&mut self, other: &Self) {
        (self.acceleration, self.velocity) = (other.acceleration, other.velocity);
    }

    /// Back to the start.
    pub fn reset(&mut self) {
        (self.acceleration, self.velocity) = (0.0, None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_of_velocity_is_its_slope() {
        let mut estimator =
            AccelerationEstimator::new(AccelerationFeedback { gain: 0.01, filter: 0.005 }, 1e-3)
                .unwrap();
        for k in 0..200 {
            estimator.update(0.007 * f64::from(k));
        }
        assert!((estimator.output(1.4) + 0.07).abs() < 1e-12);
    }

    /// With a fast filter the drive's step response is that of a drive with three times the
    /// inertia.
    #[test]
    fn the_apparent_inertia_grows_as_stated() {
        let (drive, dt) = (LinearDrive::THESIS, 1e-5);
        let feedback = AccelerationFeedback::for_inertia(&drive, 3.0, 1e-4);
        let apparent = feedback.apparent(&drive);
        assert!((apparent.time_constant - 3.0 * drive.time_constant).abs() < 1e-15);
        let mut estimator = AccelerationEstimator::new(feedback, dt).unwrap();
        let decay = (-dt / drive.time_constant).exp();
        let mut w = 0.0;
        for k in 0..30_000 {
            let t = f64::from(k) * dt;
            let expected = drive.gain * (1.0 - (-t / apparent.time_constant).exp());
            // The filter's lag shows as its time constant, at most 2e-4 s of the steepest slope.
            assert!(
                (w - expected).abs() < 2e-4 * drive.gain / apparent.time_constant,
                "{t}: {w} {expected}"
            );
            let u = 1.0 + estimator.output(w);
            estimator.update(w);
            w = drive.gain * u + (w - drive.gain * u) * decay;
        }
    }
}
